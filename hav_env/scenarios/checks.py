"""What scenarios demand of their parameters, said in the same words."""

import math
from typing import Any

LEAST_GAP = 1e-3
"""The least gap between footprints [m]: more than rounding adds up to along a row of HAVs."""


def require(allowed: bool, kind: str, model: Any, field: str, rule: str) -> None:
    """Raise ValueError, naming the field, its value and the rule, unless the value is allowed.

    Args:
        allowed: whether it is.
        kind: what the model is, for the message.
        model: a NamedTuple; field: one of its fields.
        rule: what the value must be.
    """
    if not allowed:
        raise ValueError(f"{kind} {field} is {getattr(model, field)}, but must be {rule}")


def require_finite(kind: str, model: Any) -> None:
    """Raise ValueError unless all fields of a model that are numbers are finite."""
    for field, value in model._asdict().items():
        if not isinstance(value, tuple):  # a model in a model is checked as such
            require(math.isfinite(value), kind, model, field, "finite")


def require_gap(scenario: Any) -> None:
    """Raise ValueError unless the gap of a scenario keeps footprints apart."""
    require(scenario.gap >= LEAST_GAP, "scenario", scenario, "gap", f"at least {LEAST_GAP:g} m")
