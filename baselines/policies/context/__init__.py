"""This package has context steering: interest and danger over slots, masked by a filter."""

from baselines.policies.context.parameters import Context
from baselines.policies.context.policy import steer_by_context

__all__ = ["Context", "steer_by_context"]
