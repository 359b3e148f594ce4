"""This package has the safety filter: it changes commands that lead to jackknifes or collisions.

docs/safety-filter.md has the theorems, their proofs and their scope.
"""

from hav_env.safety.filters import (
    SAFETY,
    SafetyFilter,
    Unfiltered,
    check_safety,
    make_safety,
)
from hav_env.safety.keeping import filter_command, filter_commands, keep_safe, scratch_rows

__all__ = [
    "SAFETY",
    "SafetyFilter",
    "Unfiltered",
    "check_safety",
    "filter_command",
    "filter_commands",
    "keep_safe",
    "make_safety",
    "scratch_rows",
]
