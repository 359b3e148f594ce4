"""Reserve, a policy that commits only to what it has predicted to end well."""

from baselines.reserve.policy import Reserve

__all__ = ["Reserve"]
