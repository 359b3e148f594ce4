"""This package holds Reserve, a policy that moves only within its reserved space."""

from baselines.policies.reserve.policy import Reserve

__all__ = ["Reserve"]
