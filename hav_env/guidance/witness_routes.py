"""This module guides HAVs on the routes that a scenario keeps free for them, as in ``field-4``.

Such a route is the Dubins path from the start pose of a HAV, or from its previous goal, to the
current goal. Its turns are wider than the least circle that the HAV can drive for good.
"""

from typing import NamedTuple

from hav_env.compiled import kernel, rare_kernel
from hav_env.guidance.segments import (
    NEGLIGIBLE,
    begin_direct,
    end_of_segment,
    is_at_end,
    is_past,
    note_progress,
)
from hav_env.world.arrays import HEADING, PHASE, X, Y
from hav_env.world.place.guidance import (
    BENT,
    REST,
    ROUTE_KNOWN,
    OnWitnesses,
    begin_route,
    follow_route,
)
from hav_env.world.sensing import drivable_radius


class Witness(NamedTuple):
    """The route that a scenario such as ``Field`` keeps free for each HAV."""


_MOST_WAYS = 4  # segments that end in one step


@kernel
def _goal_of(world, agent, lane):
    goal = world.state.goal
    return goal[agent, X, lane], goal[agent, Y, lane], goal[agent, HEADING, lane]


@begin_route.register(OnWitnesses)
@rare_kernel
def begin_on_witness(guidance, world, agent, lane):
    """Begin the route from the start of a HAV, or from its previous goal."""
    state, goals = world.state, world.goals
    x, y, heading = state.x[agent, lane], state.y[agent, lane], state.heading[agent, 0, lane]
    before = int(state.goal[agent, PHASE, lane]) - 1
    if before >= 0:
        x, y = goals[agent, before, 0, lane], goals[agent, before, 1, lane]
        heading = goals[agent, before, 2, lane]
    radius = guidance.widening * drivable_radius(world, agent, lane)
    goal = _goal_of(world, agent, lane)
    begin_direct(guidance.route, agent, lane, (x, y, heading), goal, radius)
    _note(guidance.route, world, agent, lane)


@follow_route.register(OnWitnesses)
@kernel
def follow_on_witnesses(guidance, world, agent):
    """Update the progress of HAVs on their routes."""
    for lane in range(world.lanes):
        if not world.state.waiting[agent, lane]:
            _note(guidance.route, world, agent, lane)


@rare_kernel
def _note(route, world, agent, lane):
    """Update the progress of a HAV; behind the end of the route, it has no route."""
    if route[agent, ROUTE_KNOWN, lane] == 0.0:
        return
    state, goal = world.state, _goal_of(world, agent, lane)
    pose = state.x[agent, lane], state.y[agent, lane], state.heading[agent, 0, lane]
    note_progress(route, agent, lane, *pose)
    for _ in range(_MOST_WAYS):
        if not is_at_end(route, agent, lane) or route[agent, REST, lane] < NEGLIGIBLE:
            break
        there = end_of_segment(route, agent, lane)
        begin_direct(route, agent, lane, there, goal, route[agent, BENT, lane])
        note_progress(route, agent, lane, *pose)
    if is_past(route, agent, lane):
        route[agent, ROUTE_KNOWN, lane] = 0.0
