"""This module states the rules of an episode: clock, goal tolerances, ends, sensing."""

import math
from typing import Literal, NamedTuple

from hav_env.compiled import kernel
from hav_env.models.checks import check_relations, check_value, require
from hav_env.models.quantities import (
    AngleTolerance,
    Distance,
    Duration,
    GoalSpeed,
    Share,
    Steps,
    Tolerance,
)

# what compiled code sees of a word: its place among those that are allowed
ALONE = IN_TURN = REMOVE = END = 1


class Task(NamedTuple):
    """The rules of an episode; the defaults are the paper's, section V."""

    dt: Duration = 0.2
    """Duration of a step [s]."""
    distance_tolerance: Tolerance = 0.5
    """A goal is hit when the truck's rear axle is less than this away, d_e^G [m], ..."""
    heading_tolerance: AngleTolerance = 0.1
    """... and its heading differs by less than this, d_h^G [rad]."""
    goal_speed: GoalSpeed = math.inf
    """A goal is hit only when the truck is at most this fast [m/s]. It matters to vehicles that
    brake at their goals (``Limited``): the slower they arrive, the less far they roll on."""
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
    order: Literal["at_once", "in_turn"] = "at_once"
    """Whether all HAVs decide on the state before the step and then move at once, or one after the
    other decides and moves: HAV 1 sees where HAV 0 has gone. The text is silent; the published
    first goals of pairs speak for in turn where circles are wide. Who is within sensing range is
    found once, before the step. Environments refuse in turn: they take all actions together."""
    on_goal: Literal["park", "remove"] = "park"
    """A HAV that has hit its last goal stays there, an obstacle to others, or leaves the world."""
    on_jackknife: Literal["record", "end"] = "record"
    """A jackknife is recorded and the episode goes on, or it ends the episode."""
    on_collision: Literal["record", "end"] = "record"
    """The same for an actual collision."""
    on_obstacle: Literal["record", "end"] = "record"
    """The same for a collision with an obstacle, where there are any."""
    continuous_collisions: bool = False
    """Look for actual collisions between steps too, where every axle goes straight from its place
    before the step to its place after it; among HAVs that sense each other. The paper's figures
    are those of the steps."""
    record_every: Steps = 1
    """Look for jackknifes, collisions and close misses after every so many steps only, as a program
    does that keeps every so many poses. The text is silent; such a program would miss short
    jackknifes and collisions. HAVs stop at their goals as they do otherwise. The largest
    articulation, and with it "folded through", is that of all steps."""
    potential_center: Share = 0.0
    """Where the circles of potential collisions lie: this share of the truck's length ahead of its
    rear axle. The text puts them round the rear axle (0). Round the truck's centre (0.5), with half
    of the truck in the distance, they hold the whole HAV, and the published collisions of pairs
    come near. Area and placement go by the text. Drawings show the text's circles."""
    potential_truck_share: Share = 0.0
    """Share of both trucks' lengths that the distance of a potential collision counts on top of the
    trailers. The text counts trailers alone (0); a truck may be longer than all of them, and the
    few published actual collisions read as if it counted. Area and placement go by the text."""


@kernel
def records(task, step):
    """Tell whether events are looked for after this step."""
    return task.record_every == 1 or step % task.record_every == 0


@check_relations.register
def _(task: Task) -> None:
    both = task.continuous_collisions and task.record_every > 1
    require(not both, "task", task, "record_every", "1 where continuous_collisions is on")


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


def check_at_once(task: Task) -> None:
    """Check that HAVs decide at once, as they must where their commands come from outside.

    Raises:
        ValueError: when they decide in turn.
    """
    if task.order in ("in_turn", IN_TURN):
        raise ValueError(
            "task order is 'in_turn', but must be 'at_once' where all HAVs decide on one state:"
            " policies without such a demand run in turn in rollout, evaluate and watch"
        )


def check_task(task: Task) -> None:
    """Check the rules of an episode.

    Raises:
        TypeError: when this is no task, or a field has a value of another kind.
        ValueError: naming the field, its value and what is allowed.
    """
    check_value("task", Task, task)
