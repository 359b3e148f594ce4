"""Reserve, a policy that commits only to what it has predicted to end well."""

from baselines.policies.reserve.policy import Reserve

__all__ = ["Reserve"]
