"""The rules of an episode: its clock, what counts as reaching a goal, what ends it, sensing."""

import math
from typing import Literal, NamedTuple, get_args

# what compiled code sees of a word: its place among those that are allowed
REMOVE = END = 1


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
    on_goal: Literal["park", "remove"] = "park"
    """A HAV that has hit its last goal stays there, an obstacle to others, or leaves the world."""
    on_jackknife: Literal["record", "end"] = "record"
    """A jackknife is recorded and the episode goes on, or it ends the episode."""
    on_collision: Literal["record", "end"] = "record"
    """The same for an actual collision."""
    continuous_collisions: bool = False
    """Look for actual collisions between steps too, where every axle goes straight from its place
    before the step to its place after it; among HAVs that sense each other. The paper's figures
    are those of the steps."""


def set_rules(task: Task, **rules) -> Task:
    """Return the task with other rules, checked: ``set_rules(Task(), on_goal="remove")``.

    Raises:
        TypeError: when this is no task or there is no such rule.
        ValueError: when a value is not allowed.
    """
    if not isinstance(task, Task):
        raise TypeError(f"task is {task!r}, but must be a Task")
    unknown = sorted(set(rules) - set(Task._fields))
    if unknown:
        raise TypeError(f"unknown argument {unknown[0]!r}; rules are: {', '.join(Task._fields)}")
    task = task._replace(**rules)
    check_task(task)
    return task


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
    for field in ("on_goal", "on_jackknife", "on_collision"):
        value, allowed = getattr(task, field), get_args(Task.__annotations__[field])
        if value not in allowed:
            raise ValueError(f"task {field} is {value!r}, but must be {' or '.join(allowed)}")
    if not isinstance(task.continuous_collisions, bool):
        raise TypeError(
            f"task continuous_collisions is {task.continuous_collisions!r}, but must be a bool"
        )
