"""This module guides HAVs on routes that their chains can drive, planned by ``feasible_plans``.

A HAV plans when it gets a goal, and again when it has left its route.
"""

from typing import Annotated, NamedTuple

from hav_env.compiled import kernel, rare_kernel
from hav_env.guidance.feasible_chains import step_length
from hav_env.guidance.feasible_plans import plan_feasible, turned_after
from hav_env.guidance.segments import (
    NEGLIGIBLE,
    begin_segment,
    end_of_segment,
    is_at_end,
    is_past,
    note_progress,
)
from hav_env.maths.geometry import clip, wrap
from hav_env.models.annotations import Range
from hav_env.world.place.guidance import (
    BENT,
    FROM_HEADING,
    PLAN_CURVATURES,
    PLAN_HELD_CURVATURE,
    PLAN_LENGTHS,
    PLAN_SEGMENTS,
    PLAN_UNDER_WAY,
    REST,
    ROUTE_CURVATURE,
    ROUTE_DIRECT,
    ROUTE_DRIVEN,
    OnFeasible,
    begin_route,
    follow_route,
)


class Feasible(NamedTuple):
    """The shortest of many tight routes that the HAV's own chain can drive; it ignores walls."""

    tightest: Annotated[float, Range(1.0, 10.0)] = 1.05
    """Radius of the tightest turns over the least radius that the truck's wheels allow. The rest of
    the steering range brings the truck back to its route."""
    margin: Annotated[float, Range(0.0, 1.5, "rad")] = 0.05
    """Margin between all joints and their limits along a route [rad]."""


# distance ahead over which a held action stays on the route [m]; distance within which the truck
# returns to the route [m]; the steepest angle of the return [rad]
_HELD_METRES, _BACK_WITHIN, _STEEPEST_BACK = 1.0, 3.0, 0.5
_STRAYED, _TURNED_ASIDE = 1.0, 0.8  # [m], [rad] off the route: beyond them the HAV plans anew


@rare_kernel
def _begin_planned(guidance, agent, lane, pose, segment):
    """Begin the first segment of a plan, from ``segment`` on, that is not negligible."""
    plan, route = guidance.plan, guidance.route
    last = PLAN_SEGMENTS - 1
    while segment < last and plan[agent, PLAN_LENGTHS + segment, lane] < NEGLIGIBLE:
        segment += 1
    rest = 0.0
    for later in range(segment + 1, PLAN_SEGMENTS):
        rest += plan[agent, PLAN_LENGTHS + later, lane]
    curvature = plan[agent, PLAN_CURVATURES + segment, lane]
    side = 1.0 if curvature > 0.0 else -1.0
    side = side if curvature != 0.0 else 0.0
    begin_segment(route, agent, lane, pose, side, plan[agent, PLAN_LENGTHS + segment, lane], rest)
    route[agent, BENT, lane] = side / curvature if curvature != 0.0 else 1.0
    plan[agent, PLAN_UNDER_WAY, lane] = segment


@kernel
def _pose_of(world, agent, lane):
    state = world.state
    return state.x[agent, lane], state.y[agent, lane], state.heading[agent, 0, lane]


@begin_route.register(OnFeasible)
@rare_kernel
def begin_feasible(guidance, world, agent, lane):
    """Plan a route from the current pose of a HAV, and begin the route."""
    found = plan_feasible(guidance, world, agent, lane)
    guidance.route[agent, ROUTE_DIRECT, lane] = 0.0 if found else 1.0
    pose = _pose_of(world, agent, lane)
    _begin_planned(guidance, agent, lane, pose, 0)
    _note_and_steer(guidance, world, agent, lane, pose)


@follow_route.register(OnFeasible)
@kernel
def follow_feasible(guidance, world, agent):
    """Update the progress of HAVs; plan anew for those that left the route or missed the goal."""
    for lane in range(world.lanes):
        if not world.state.waiting[agent, lane]:
            _follow_plan(guidance, world, agent, lane)


@rare_kernel
def _follow_plan(guidance, world, agent, lane):
    route, pose = guidance.route, _pose_of(world, agent, lane)
    off, turned = _note_and_steer(guidance, world, agent, lane, pose)
    for _ in range(PLAN_SEGMENTS):
        if not is_at_end(route, agent, lane) or route[agent, REST, lane] < NEGLIGIBLE:
            break
        there = end_of_segment(route, agent, lane)
        segment = int(guidance.plan[agent, PLAN_UNDER_WAY, lane]) + 1
        _begin_planned(guidance, agent, lane, there, segment)
        off, turned = _note_and_steer(guidance, world, agent, lane, pose)
    strayed = (abs(off) > _STRAYED) | (abs(turned) > _TURNED_ASIDE)
    if strayed | is_past(route, agent, lane):
        begin_feasible(guidance, world, agent, lane)


@rare_kernel
def _note_and_steer(guidance, world, agent, lane, pose):
    """Update the progress of a truck, and the curvatures that lead to the headings ahead of it.

    A step turns the truck first and then moves it. So the truck aims at the heading of the route
    half a step ahead.

    Returns:
        The truck's distance to the left of the route [m], and its turn to the left of it [rad].
    """
    route, plan = guidance.route, guidance.plan
    distance = step_length(guidance, world, agent, lane)
    off, turned = note_progress(route, agent, lane, *pose)
    driven = route[agent, ROUTE_DRIVEN, lane]
    segment = int(plan[agent, PLAN_UNDER_WAY, lane])
    back = clip(-off / _BACK_WITHIN, -_STEEPEST_BACK, _STEEPEST_BACK)
    wanted = route[agent, FROM_HEADING, lane] + back - pose[2]
    soon = turned_after(plan, agent, lane, segment, driven + 0.5 * distance)
    route[agent, ROUTE_CURVATURE, lane] = wrap(wanted + soon) / distance
    later = turned_after(plan, agent, lane, segment, driven + _HELD_METRES)
    plan[agent, PLAN_HELD_CURVATURE, lane] = wrap(wanted + later) / _HELD_METRES
    return off, turned
