"""This module states the rules of an episode: clock, goal tolerances, ends, sensing."""

from typing import Literal, NamedTuple

from hav_env.models.checks import check_value
from hav_env.models.quantities import AngleTolerance, Distance, Duration, Steps, Tolerance

# what compiled code sees of a word: its place among those that are allowed
ALONE = REMOVE = END = 1


class Task(NamedTuple):
    """The rules of an episode; the defaults are the paper's, section V."""

    dt: Duration = 0.2
    """Duration of a step [s]."""
    distance_tolerance: Tolerance = 0.5
    """A goal is hit when the truck's rear axle is less than this away, d_e^G [m], ..."""
    heading_tolerance: AngleTolerance = 0.1
    """... and its heading differs by less than this, d_h^G [rad]."""
    max_steps: Steps = 20_000
    """An episode ends after this many steps, if not all last goals were hit before."""
    sensing_range: Distance = 30.0
    """A HAV senses another when the gap between their reaches is at most this [m]. The paper needs
    the collision distance only (0); more serves policies that look ahead."""
    next_goal: Literal["together", "alone"] = "together"
    """When a HAV gets its next goal: together with all others, once every HAV has hit its goal; or
    alone, as soon as it has hit its own. The text says together: "Once every HAV has reached its
    first goal, all [...] are assigned their second goal". The published second goals of pairs
    speak for alone (docs/reproduction.md)."""
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
        TypeError: when this is no task, there is no such rule, or a value is of another kind.
        ValueError: when a value is not allowed.
    """
    check_value("task", Task, task)
    unknown = sorted(set(rules) - set(Task._fields))
    if unknown:
        raise TypeError(f"unknown argument {unknown[0]!r}; rules are: {', '.join(Task._fields)}")
    task = task._replace(**rules)
    check_task(task)
    return task


def check_task(task: Task) -> None:
    """Check the rules of an episode.

    Raises:
        TypeError: when this is no task, or a field has a value of another kind.
        ValueError: naming the field, its value and what is allowed.
    """
    check_value("task", Task, task)
