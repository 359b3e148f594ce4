"""This package holds Reserve, a policy that moves only within what it has reserved."""

from baselines.policies.reserve.policy import Reserve

__all__ = ["Reserve"]
