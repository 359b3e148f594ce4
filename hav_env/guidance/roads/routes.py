"""This module guides HAVs on road networks: from the nearest pose, edge by edge, to the goal.

A HAV that is at none of the poses first drives a Dubins path to one of them. It begins anew if it
is too far off its route, or has driven past the goal.
"""

import math

from hav_env.compiled import kernel, rare_kernel
from hav_env.guidance.roads.model import NO_EDGE
from hav_env.guidance.segments import (
    NEGLIGIBLE,
    begin_direct,
    begin_segment,
    end_of_segment,
    is_at_end,
    is_past,
    note_progress,
)
from hav_env.guidance.walls import path_keeps_clear
from hav_env.maths.dubins import shortest_path
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import into_frame, wrap
from hav_env.world.arrays import HEADING, X, Y
from hav_env.world.place.guidance import (
    BENT,
    NO_TABLE,
    REST,
    ROAD_EDGE,
    ROAD_GOAL,
    ROAD_NETWORK,
    ROAD_SEGMENT,
    ROAD_TO,
    ROUTE_DIRECT,
    ROUTE_KNOWN,
    OnRoads,
    begin_route,
    follow_route,
)
from hav_env.world.sensing import drivable_radius

_ROUNDED = 1e-5  # share of a radius
_AT_POSE, _AS_TURNED = 1.5, 0.35  # [m], [rad]: a HAV that near a pose is there
_MOST_OFF, _MOST_ASKEW = 3.0, 1.3  # [m], [rad] off the route: beyond, a new route begins
_MOST_ENDS = 8  # segments that may end in one step
_DEFAULT_TURNS = 1.0  # [m], radius that a straight segment keeps


@begin_route.register(OnRoads)
@rare_kernel
def begin_on_road(guidance, world, agent, lane):
    """Find the network of a HAV and the pose of its goal; begin a route."""
    roads, goal, under_way = guidance.roads, world.state.goal, guidance.under_way
    radius = drivable_radius(world, agent, lane)
    under_way[agent, ROAD_NETWORK, lane] = under_way[agent, ROAD_GOAL, lane] = NO_TABLE
    least = _ROUNDED * radius
    for k in range(roads.radius.shape[0]):
        off = abs(roads.radius[k] - radius)
        if off <= least:  # radii of two networks may differ by less
            least = off
            under_way[agent, ROAD_NETWORK, lane] = k
    for p in range(roads.pose.shape[0]):
        same = roads.pose[p, 0] == goal[agent, X, lane] and roads.pose[p, 1] == goal[agent, Y, lane]
        if same and roads.pose[p, 2] == goal[agent, HEADING, lane]:
            under_way[agent, ROAD_GOAL, lane] = p
    _begin_here(guidance, world, agent, lane)


@rare_kernel
def _begin_here(guidance, world, agent, lane):
    """Begin the route at the pose where a HAV is, or on the way to the best pose, if there is."""
    roads, route, under_way = guidance.roads, guidance.route, guidance.under_way
    route[agent, ROUTE_KNOWN, lane] = 0.0
    k, goal = under_way[agent, ROAD_NETWORK, lane], under_way[agent, ROAD_GOAL, lane]
    if min(k, goal) == NO_TABLE:
        return
    pose = _pose_of(world, agent, lane)
    least, here = math.inf, NO_TABLE
    for p in range(roads.pose.shape[0]):
        dx, dy = roads.pose[p, 0] - pose[0], roads.pose[p, 1] - pose[1]
        away = math.sqrt(dx * dx + dy * dy)
        there = away < min(least, _AT_POSE) and abs(wrap(roads.pose[p, 2] - pose[2])) < _AS_TURNED
        if there and p != goal and roads.left[k, p, goal] < math.inf:
            least, here = away, p
    if here != NO_TABLE:
        _begin_edge(guidance, agent, lane, here)
    else:
        _begin_way(guidance, world, agent, lane, pose)
    if route[agent, ROUTE_KNOWN, lane] != 0.0:
        note_progress(route, agent, lane, *pose)


@kernel
def _pose_of(world, agent, lane):
    state = world.state
    return state.x[agent, lane], state.y[agent, lane], state.heading[agent, 0, lane]


@kernel
def _pose_at(roads, p):
    return roads.pose[p, 0], roads.pose[p, 1], roads.pose[p, 2]


@kernel
def _begin_edge(guidance, agent, lane, p):
    """Begin the first edge of the shortest path from a pose to the goal."""
    roads, under_way = guidance.roads, guidance.under_way
    k, goal = under_way[agent, ROAD_NETWORK, lane], under_way[agent, ROAD_GOAL, lane]
    under_way[agent, ROAD_EDGE, lane] = roads.edge[k, p, goal]
    _begin_part(guidance, agent, lane, 0, _pose_at(roads, p))


@kernel
def _begin_part(guidance, agent, lane, number, pose):
    """Begin a segment of the edge under way, in a pose."""
    roads, route, under_way = guidance.roads, guidance.route, guidance.under_way
    k, goal = under_way[agent, ROAD_NETWORK, lane], under_way[agent, ROAD_GOAL, lane]
    edge = under_way[agent, ROAD_EDGE, lane]
    under_way[agent, ROAD_SEGMENT, lane] = number
    curvature, length, behind = roads.segment[edge, number]
    side = 0.0 if curvature == 0.0 else math.copysign(1.0, curvature)
    rest = behind + roads.left[k, roads.end[edge], goal]
    begin_segment(route, agent, lane, pose, side, length, rest)
    radius = _DEFAULT_TURNS if curvature == 0.0 else 1.0 / abs(curvature)
    route[agent, BENT, lane], route[agent, ROUTE_DIRECT, lane] = radius, 0.0


@rare_kernel
def _begin_way(guidance, world, agent, lane, pose):
    """Begin the Dubins path to the pose with the shortest whole way; if possible, a clear one."""
    roads, under_way = guidance.roads, guidance.under_way
    k, goal = under_way[agent, ROAD_NETWORK, lane], under_way[agent, ROAD_GOAL, lane]
    radius = roads.widening * drivable_radius(world, agent, lane)
    sine, cosine = sincos(pose[2])
    least, clear, best = math.inf, False, NO_TABLE
    for p in range(roads.pose.shape[0]):
        there = _pose_at(roads, p)
        forward, left = into_frame(there[0] - pose[0], there[1] - pose[1], cosine, sine)
        path = shortest_path(forward, left, there[2] - pose[2], radius)
        whole = path[1] + path[2] + path[3] + roads.left[k, p, goal]
        if whole == math.inf or (clear and whole >= least):
            continue
        keeps = path_keeps_clear(
            roads.walls, roads.clearance, pose[0], pose[1], cosine, sine, radius, *path
        )
        if (keeps and not clear) or (keeps == clear and whole < least):
            least, clear, best = whole, keeps, p
    if best != NO_TABLE:
        under_way[agent, ROAD_EDGE, lane] = NO_EDGE
        under_way[agent, ROAD_TO, lane] = best
        _begin_direct_to(guidance, agent, lane, pose, radius)


@kernel
def _begin_direct_to(guidance, agent, lane, pose, radius):
    """Begin the first segment of the Dubins path to the pose of the network."""
    roads, route, under_way = guidance.roads, guidance.route, guidance.under_way
    k, goal = under_way[agent, ROAD_NETWORK, lane], under_way[agent, ROAD_GOAL, lane]
    p = under_way[agent, ROAD_TO, lane]
    begin_direct(route, agent, lane, pose, _pose_at(roads, p), radius)
    route[agent, REST, lane] += roads.left[k, p, goal]


@follow_route.register(OnRoads)
@kernel
def follow_on_roads(guidance, world, agent):
    """Update the progress of HAVs; begin new routes for those that left theirs."""
    for lane in range(world.lanes):
        if not world.state.waiting[agent, lane]:
            _follow(guidance, world, agent, lane)


@rare_kernel
def _follow(guidance, world, agent, lane):
    route, under_way = guidance.route, guidance.under_way
    if under_way[agent, ROAD_GOAL, lane] == NO_TABLE:
        return
    if route[agent, ROUTE_KNOWN, lane] == 0.0:
        _begin_here(guidance, world, agent, lane)
        return
    pose = _pose_of(world, agent, lane)
    off, turned = note_progress(route, agent, lane, *pose)
    for _ in range(_MOST_ENDS):
        if not is_at_end(route, agent, lane) or route[agent, REST, lane] < NEGLIGIBLE:
            break
        _begin_next(guidance, agent, lane)
        off, turned = note_progress(route, agent, lane, *pose)
    lost = abs(off) > _MOST_OFF or abs(turned) > _MOST_ASKEW
    if lost or is_past(route, agent, lane):
        _begin_here(guidance, world, agent, lane)


@rare_kernel
def _begin_next(guidance, agent, lane):
    """Begin the segment behind the one that has ended."""
    roads, route, under_way = guidance.roads, guidance.route, guidance.under_way
    edge, there = under_way[agent, ROAD_EDGE, lane], end_of_segment(route, agent, lane)
    if edge == NO_EDGE:
        k, goal = under_way[agent, ROAD_NETWORK, lane], under_way[agent, ROAD_GOAL, lane]
        p = under_way[agent, ROAD_TO, lane]
        if route[agent, REST, lane] > roads.left[k, p, goal] + NEGLIGIBLE:
            _begin_direct_to(guidance, agent, lane, there, route[agent, BENT, lane])
        else:
            _begin_edge(guidance, agent, lane, p)
    elif under_way[agent, ROAD_SEGMENT, lane] + 1 < roads.parts[edge]:
        _begin_part(guidance, agent, lane, under_way[agent, ROAD_SEGMENT, lane] + 1, there)
    else:
        _begin_edge(guidance, agent, lane, roads.end[edge])
