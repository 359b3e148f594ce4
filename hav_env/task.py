"""The rules of an episode: its clock, what counts as reaching a goal, how far a HAV senses."""

import math
from typing import NamedTuple


class Task(NamedTuple):
    """The rules of an episode; the defaults are the paper's, section V."""

    dt: float = 0.2
    """Duration of a step [s]."""
    distance_tolerance: float = 0.5
    """A goal is hit when the truck's rear axle is less than this away, d_e^G [m], ..."""
    heading_tolerance: float = 0.1
    """... and its heading differs by less than this, d_h^G [rad]."""
    max_steps: int = 20_000
    """An episode ends after this many steps, if not all last goals were hit before."""
    sensing_range: float = 30.0
    """A HAV senses another when the gap between their reaches is at most this [m]. The paper needs
    the collision distance only (0); more serves policies that look ahead."""


def check_task(task: Task) -> None:
    """Check the rules of an episode.

    Raises:
        ValueError: naming the field, its value and what is allowed.
    """
    for field in ("dt", "distance_tolerance", "heading_tolerance"):
        value = getattr(task, field)
        if not (math.isfinite(value) and value > 0):
            raise ValueError(f"task {field} is {value}, but must be finite and above 0")
    if not isinstance(task.max_steps, int) or task.max_steps < 1:
        raise ValueError(f"task max_steps is {task.max_steps}, but must be a whole number >= 1")
    if not (math.isfinite(task.sensing_range) and task.sensing_range >= 0):
        raise ValueError(
            f"task sensing_range is {task.sensing_range}, but must be finite and at least 0"
        )
