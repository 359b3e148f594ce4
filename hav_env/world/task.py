"""This module states the rules of an episode: clock, goal tolerances, ends, sensing."""

import math
from collections.abc import Iterable
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
from hav_env.models.text import suggest

# compiled code sees the index of a word among the allowed ones
ALONE = IN_TURN = REMOVE = END = 1


class Task(NamedTuple):
    """The rules of an episode; the defaults are the paper's, section V."""

    dt: Duration = 0.2
    """Duration of a step [s]."""
    distance_tolerance: Tolerance = 0.5
    """Distance tolerance of goals d_e^G [m]: a hit needs the truck's rear axle nearer than that."""
    heading_tolerance: AngleTolerance = 0.1
    """Heading tolerance of goals d_h^G [rad]: a hit also needs a heading difference below that."""
    goal_speed: GoalSpeed = math.inf
    """Largest speed of the truck at which a goal is hit [m/s]. It matters for vehicles that brake
    at their goals (``Limited``): the slower they arrive, the less they roll on.
    """
    max_steps: Steps = 20_000
    """Number of steps after which an episode ends, if not all last goals were hit before."""
    sensing_range: Distance = 30.0
    """Largest gap between the reaches of two HAVs at which they sense each other [m]. The paper
    needs the collision distance only (0); a larger value serves policies that look ahead.
    """
    next_goal: Literal["together", "alone"] = "together"
    """When a HAV gets its next goal. ``together``: once every HAV has hit its goal. ``alone``: as
    soon as it has hit its own. The text states ``together``: "Once every HAV has reached its first
    goal, all [...] are assigned their second goal". The published second goals of pairs support
    ``alone`` (docs/reproduction.md).
    """
    order: Literal["at_once", "in_turn"] = "at_once"
    """Order of decisions. ``at_once``: all HAVs decide on the state before the step and then move.
    ``in_turn``: they decide and move one after another, so HAV 1 senses HAV 0 after its move. The
    text does not state it; the published first goals of pairs support ``in_turn`` with wide
    circles. The neighbours in sensing range are found once, before the step. Environments reject
    ``in_turn``, because they take all actions together.
    """
    on_goal: Literal["park", "remove"] = "park"
    """Rule for a HAV that has hit its last goal. ``park``: it stays there, an obstacle to others.
    ``remove``: it leaves the world.
    """
    on_jackknife: Literal["record", "end"] = "record"
    """Rule for a jackknife. ``record``: the episode continues. ``end``: the episode ends."""
    on_collision: Literal["record", "end"] = "record"
    """Rule for an actual collision: the same."""
    on_obstacle: Literal["record", "end"] = "record"
    """Rule for a collision with an obstacle: the same."""
    continuous_collisions: bool = False
    """Whether to look for actual collisions between steps too, among HAVs that sense each other,
    and for collisions with obstacles.
    Every axle then moves straight from its position before the step to its position after it. The
    paper's figures use the steps only.
    """
    record_every: Steps = 1
    """Period [steps] of the search for jackknifes, collisions and close misses, as in a program
    that keeps every so many poses. The text does not state it; such a program would miss short
    jackknifes and collisions. The period does not affect stops at goals. The largest articulation,
    and with it "folded through", covers all steps.
    """
    potential_center: Share = 0.0
    """Centre of the circles of potential collisions, as a share of the truck's length ahead of its
    rear axle. The text uses the rear axle (0). The alternative is the truck's centre (0.5), with
    half of the truck in the distance. The circles then cover the whole HAV, and the results are
    near the published collisions of pairs. Area and placement follow the text. Drawings show the
    text's circles.
    """
    potential_truck_share: Share = 0.0
    """Share of both trucks' lengths that the distance of a potential collision adds to the
    trailers' lengths. The text counts trailers alone (0). A truck may be longer than all of them,
    and the low number of published actual collisions suggests that the truck counted. Area and
    placement follow the text.
    """


@kernel
def records(task, step):
    """Return whether kernels look for events after this step."""
    return task.record_every == 1 or step % task.record_every == 0


@check_relations.register
def _(task: Task) -> None:
    both = task.continuous_collisions and task.record_every > 1
    require(not both, "task", task, "record_every", "1 where continuous_collisions is on")


def set_rules(task: Task, others: Iterable[str] = (), /, **rules) -> Task:
    """Return the task with other rules, checked: ``set_rules(Task(), on_goal="remove")``.

    Args:
        task: The task.
        others: Names of other arguments that a user may have meant, for the message.
        rules: Rules to replace.

    Raises:
        TypeError: If this is not a task, a rule does not exist, or a value has another type.
        ValueError: If a value is not allowed.
    """
    check_value("task", Task, task)
    unknown = sorted(set(rules) - set(Task._fields))
    if unknown:
        near = suggest(unknown[0], [*others, *Task._fields])
        told = f"unknown argument {unknown[0]!r}{near}"
        raise TypeError(f"{told}; rules are: {', '.join(Task._fields)}")
    task = task._replace(**rules)
    check_task(task)
    return task


def check_at_once(task: Task) -> None:
    """Check that HAVs decide at once, as required if their commands come from outside.

    Raises:
        ValueError: If they decide in turn.
    """
    if task.order in ("in_turn", IN_TURN):
        raise ValueError(
            "task order is 'in_turn', but must be 'at_once' where all HAVs decide on one state:"
            " policies without such a demand run in turn in rollout, evaluate and watch"
        )


def check_task(task: Task) -> None:
    """Check the rules of an episode.

    Raises:
        TypeError: If this is not a task, or a field has a value of another type.
        ValueError: If a field is invalid; the message names it, its value and the rule.
    """
    check_value("task", Task, task)
