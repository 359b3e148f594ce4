"""This module declares the guidance of a batch, the part of its worlds that knows ways to goals.

The type of ``world.guidance`` selects code. ``Dubins`` is the paper's: it is empty, holds no arrays
and costs nothing. Others keep a route for each HAV. It leads to the goal under way, segment after
segment. ``hav_env.guidance`` has their kernels. N HAVs of a world, W worlds.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from hav_env.compiled import generic, lanes_from
from hav_env.world.units.parts import Array, part_from


class Dubins(NamedTuple):
    """The shortest Dubins path from where a HAV stands to its goal. It knows no walls."""


class OnLattices(NamedTuple):
    """Routes on lattices, which all worlds share."""

    lattices: Any  # ``hav_env.guidance.tables.Lattices``, read only
    table: Array  # (N, W) int16 which of them leads to the goal under way, NO_TABLE if none
    route: Array  # (N, 13, W) columns LEFT .. ROUTE_DIRECT


class OnRoads(NamedTuple):
    """Routes on road networks, which all worlds share."""

    roads: Any  # ``hav_env.guidance.roads.RoadNetworks``, read only
    under_way: Array  # (N, 5, W) int32 columns ROAD_NETWORK .. ROAD_TO, NO_TABLE if none
    route: Array  # (N, 13, W) columns LEFT .. ROUTE_DIRECT


class OnWitnesses(NamedTuple):
    """Routes on the ways that a scenario keeps free: Dubins paths from goal to goal."""

    widening: float  # radius of their turns over the least that a HAV can drive for good
    route: Array  # (N, 13, W) columns LEFT .. ROUTE_DIRECT


class OnFeasible(NamedTuple):
    """Routes that the HAV's own chain can drive."""

    step: float  # duration of a step [s]
    distance_tolerance: float  # of goals [m]
    heading_tolerance: float  # of goals [rad]
    tightest: float  # radius of the tightest turns over the truck's own
    margin: float  # of joints to their limits [rad]
    route: Array  # (N, 13, W) columns LEFT .. ROUTE_DIRECT
    plan: Array  # (N, 8, W) columns PLAN_CURVATURES .. PLAN_HELD_CURVATURE
    scratch: Array  # (S, W) of planning


NO_TABLE = -1
# the way that is left [m]; the side of the segment under way, 1.0 left, -1.0 right, 0.0 straight;
# how much of it is left [m]; the curvature that keeps to the route, left positive [1/m]; whether
# there is a route: 1.0 or 0.0
LEFT, ROUTE_TURN, STAYS, ROUTE_CURVATURE, ROUTE_KNOWN = range(5)
# the pose in which the segment under way begins [m, m, rad], its length, how far it was driven, the
# length of all behind it, the radius of turns [m]; whether all from here on is a Dubins path
FROM_X, FROM_Y, FROM_HEADING, ROUTE_LENGTH, ROUTE_DRIVEN, REST, BENT, ROUTE_DIRECT = range(5, 13)
_ROUTE_COLUMNS = ROUTE_DIRECT + 1
# on roads: the network of the HAV's radius, the pose of its goal, the edge under way, the segment
# of that edge, the pose at the end of a way to the network
ROAD_NETWORK, ROAD_GOAL, ROAD_EDGE, ROAD_SEGMENT, ROAD_TO = range(5)
# of a plan: curvature of each segment, left positive [1/m]; their lengths [m]; which is under way;
# the curvature that keeps to the route if it is held for the next metre [1/m]
PLAN_SEGMENTS = 3
PLAN_CURVATURES, PLAN_LENGTHS, PLAN_UNDER_WAY = 0, PLAN_SEGMENTS, 2 * PLAN_SEGMENTS
PLAN_HELD_CURVATURE = PLAN_UNDER_WAY + 1


def allocate_guidance(guidance: Any, shape: tuple[int, int], zeros: Callable) -> Any:
    """Return the guidance of a batch, with arrays for its HAVs.

    Args:
        guidance: without them.
        shape: N and W.
        zeros: makes each array from its shape and kind of numbers.
    """
    if isinstance(guidance, Dubins):
        return guidance
    n, w = shape
    found = guidance._replace(route=zeros((n, _ROUTE_COLUMNS, w), np.float64))
    if isinstance(found, OnFeasible):
        plan = zeros((n, PLAN_HELD_CURVATURE + 1, w), np.float64)
        return found._replace(plan=plan, scratch=zeros((len(found.scratch), w), np.float64))
    if isinstance(found, OnRoads):
        return found._replace(under_way=zeros((n, ROAD_TO + 1, w), np.int32))
    return found._replace(table=zeros(shape, np.int16)) if "table" in found._fields else found


def of_each_world(guidance: Any) -> Any:
    """Return guidance without what all worlds share."""
    if isinstance(guidance, OnRoads):
        return guidance._replace(roads=())
    return guidance._replace(lattices=()) if isinstance(guidance, OnLattices) else guidance


@part_from.register(Dubins)
def _keep_dubins(part, first):
    return part


@part_from.register(OnLattices)
def _on_lattices_from(part, first):
    return OnLattices(part.lattices, lanes_from(part.table, first), lanes_from(part.route, first))


@part_from.register(OnRoads)
def _on_roads_from(part, first):
    return OnRoads(part.roads, lanes_from(part.under_way, first), lanes_from(part.route, first))


@part_from.register(OnWitnesses)
def _on_witnesses_from(part, first):
    return OnWitnesses(part.widening, lanes_from(part.route, first))


@part_from.register(OnFeasible)
def _on_feasible_from(part, first):
    return OnFeasible(
        part.step,
        part.distance_tolerance,
        part.heading_tolerance,
        part.tightest,
        part.margin,
        lanes_from(part.route, first),
        lanes_from(part.plan, first),
        lanes_from(part.scratch, first),
    )


@generic
def begin_route(guidance, world, agent, lane):
    """Find the route to the goal under way from where a HAV stands."""


@generic
def follow_route(guidance, world, agent):
    """Note how far HAVs have come on their routes in all lanes of a block of worlds."""


@generic
def route_of(guidance, agent, lane):
    """Return what the route of a HAV says.

    Returns:
        (known, side, stays, curvature, left): whether there is a route; the side of its segment
        under way, 1.0 left, -1.0 right, 0.0 straight; how much is left of it [m]; the curvature
        that keeps to the route, left positive [1/m]; the length of all that is left [m].
    """


@begin_route.register(Dubins)
def _begin_nothing(guidance, world, agent, lane):
    pass


@follow_route.register(Dubins)
def _follow_nothing(guidance, world, agent):
    pass


@route_of.register(Dubins)
def _no_route(guidance, agent, lane):
    return False, 0.0, 0.0, 0.0, 0.0


@route_of.register(OnLattices)
@route_of.register(OnRoads)
@route_of.register(OnWitnesses)
@route_of.register(OnFeasible)
def _read_route(guidance, agent, lane):
    route = guidance.route
    return (
        route[agent, ROUTE_KNOWN, lane] != 0.0,
        route[agent, ROUTE_TURN, lane],
        route[agent, STAYS, lane],
        route[agent, ROUTE_CURVATURE, lane],
        route[agent, LEFT, lane],
    )
