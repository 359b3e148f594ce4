"""This module plans routes for a chain, with turns tighter than the chain can drive for good.

A HAV can drive a tight turn if the turn ends before a joint reaches its limit. Candidates are two
arcs of different radii with a straight between them, and three arcs of one radius. They lead to
poses well within the tolerance of the goal. The planner predicts the chain along the candidates
step by step, the shortest first. It takes the first candidate on which all joints keep their
limits, up to the goal and straight ahead behind it.
"""

import math

from hav_env.compiled import kernel, rare_kernel
from hav_env.guidance.feasible_chains import (
    AT_LAST,
    AT_LEFT,
    AT_LENGTHS,
    AT_NUMBERS,
    AT_RADII,
    AT_RIGHT,
    MOST_CANDIDATES,
    NUM_RADII,
    WIDEST_SHARE,
    bend_bound,
    measure_arcs_of,
    pull_chain,
    put_chain,
    step_length,
)
from hav_env.maths.arcs import circles_path, tangent_path
from hav_env.maths.dubins import shortest_path, turns
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import TWO_PI, clip
from hav_env.world.place.guidance import PLAN_CURVATURES, PLAN_LENGTHS, PLAN_SEGMENTS
from hav_env.world.sensing import drivable_radius, goal_pose, steering_direction

# aims: forward and left of the goal [distance tolerances], turned to the left [heading tolerances]
_AIM_AHEAD = -0.4
_AIM_ASIDE = (0.0, 0.45, -0.45)
_AIM_TURNED = (0.0, 0.6, -0.6)
_NUM_AIMS = 9
# of both tolerances: a HAV that follows a route hits the goal if the route misses it by less
_WELL_WITHIN = 0.8
_SIDE_PAIRS = 4  # left or right, then left or right
_TANGENTS = _SIDE_PAIRS * NUM_RADII * NUM_RADII
_OF_AIM = _TANGENTS + 2 * NUM_RADII
_LISTS = 4  # lists of candidates in one plan
_LONGEST_STEP = 0.5  # over the shortest trailer: there is no prediction with a longer step
_STRAIGHTENS = 400  # steps straight ahead behind a goal, at most
_SPREAD = 0.5  # of a right angle: a chain can straighten out if its units are turned by less


@rare_kernel
def plan_feasible(guidance, world, agent, lane):
    """Write the plan of a HAV: the shortest candidate that it can drive.

    Returns:
        Whether there is one. Otherwise the plan is the Dubins path that it can drive for good.
    """
    rows, plan = guidance.scratch, guidance.plan
    tightest = min(_tightest_arc(guidance, world, agent, lane), drivable_radius(world, agent, lane))
    measure_arcs_of(guidance, world, agent, lane, tightest)
    beyond = -1.0
    for _ in range(_LISTS):
        count = _list_shortest(guidance, world, agent, lane, beyond)
        for place in range(count):
            number = int(rows[AT_NUMBERS + place, lane])
            _write_plan(guidance, world, agent, lane, number)
            if _keeps_joints(guidance, world, agent, lane):
                return True
        if count < MOST_CANDIDATES:
            break
        beyond = rows[AT_LENGTHS + count - 1, lane]
    radius = WIDEST_SHARE * drivable_radius(world, agent, lane)
    word, first, second, third = shortest_path(*goal_pose(world, agent, lane), radius)
    one, two, three = turns(word)
    plan[agent, PLAN_CURVATURES, lane], plan[agent, PLAN_LENGTHS, lane] = one / radius, first
    plan[agent, PLAN_CURVATURES + 1, lane] = two / radius
    plan[agent, PLAN_LENGTHS + 1, lane] = second
    plan[agent, PLAN_CURVATURES + 2, lane] = three / radius
    plan[agent, PLAN_LENGTHS + 2, lane] = third
    return False


@kernel
def _tightest_arc(guidance, world, agent, lane):
    """Return the radius of the tightest arcs [m]; some steering is left to return to the route."""
    cosine, sine = steering_direction(world, agent, lane)
    return guidance.tightest * world.fleet.length[agent, 0, lane] * cosine / sine


@kernel
def _aim_at(guidance, world, agent, lane, aim):
    """Return a pose within the tolerance of the goal, in the truck's frame."""
    x, y, heading = goal_pose(world, agent, lane)
    sine, cosine = sincos(heading)
    ahead = _AIM_AHEAD * guidance.distance_tolerance
    aside = _AIM_ASIDE[aim % 3] * guidance.distance_tolerance
    turned = heading + _AIM_TURNED[aim // 3] * guidance.heading_tolerance
    return x + ahead * cosine - aside * sine, y + ahead * sine + aside * cosine, turned


@rare_kernel
def _list_shortest(guidance, world, agent, lane, beyond):
    """List the shortest candidates longer than ``beyond`` [m]; return their number."""
    rows, count = guidance.scratch, 0
    for aim in range(_NUM_AIMS):
        x, y, heading = _aim_at(guidance, world, agent, lane, aim)
        sine, cosine = sincos(heading)
        for choice in range(_TANGENTS):
            pair, sides = choice // _SIDE_PAIRS, choice % _SIDE_PAIRS
            one, last = pair // NUM_RADII, pair % NUM_RADII
            first_side, last_side = 1.0 if sides < 2 else -1.0, 1.0 if sides % 2 == 0 else -1.0
            first_radius, radius = rows[AT_RADII + one, lane], rows[AT_RADII + last, lane]
            a, b, c = tangent_path(
                *(first_side, last_side, x, y, heading, cosine, sine, first_radius, radius)
            )
            longest = rows[(AT_LEFT if sides < 2 else AT_RIGHT) + one, lane]
            fits = (a <= longest * first_radius) & (c <= rows[AT_LAST + last, lane] * radius)
            total = a + b + c
            if fits & (total > beyond):
                count = _list_candidate(rows, lane, count, total, aim * _OF_AIM + choice)
        for choice in range(2 * NUM_RADII):
            radius = rows[AT_RADII + choice // 2, lane]
            a, b, c = circles_path(1.0 if choice % 2 == 0 else -1.0, x, y, heading, radius)
            total = a + b + c
            if beyond < total < math.inf:
                number = aim * _OF_AIM + _TANGENTS + choice
                count = _list_candidate(rows, lane, count, total, number)
    return count


@kernel
def _list_candidate(rows, lane, count, total, number):
    """Insert a candidate into the sorted list; a full list drops its longest candidate."""
    place = count
    if count == MOST_CANDIDATES:
        if total >= rows[AT_LENGTHS + MOST_CANDIDATES - 1, lane]:
            return count
        place, count = MOST_CANDIDATES - 1, MOST_CANDIDATES - 1
    while place > 0 and rows[AT_LENGTHS + place - 1, lane] > total:
        rows[AT_LENGTHS + place, lane] = rows[AT_LENGTHS + place - 1, lane]
        rows[AT_NUMBERS + place, lane] = rows[AT_NUMBERS + place - 1, lane]
        place -= 1
    rows[AT_LENGTHS + place, lane], rows[AT_NUMBERS + place, lane] = total, number
    return count + 1


@rare_kernel
def _write_plan(guidance, world, agent, lane, number):
    """Write a candidate into the plan of a HAV."""
    rows, plan = guidance.scratch, guidance.plan
    aim, choice = number // _OF_AIM, number % _OF_AIM
    x, y, heading = _aim_at(guidance, world, agent, lane, aim)
    if choice < _TANGENTS:
        sine, cosine = sincos(heading)
        pair, sides = choice // _SIDE_PAIRS, choice % _SIDE_PAIRS
        first_radius = rows[AT_RADII + pair // NUM_RADII, lane]
        last_radius = rows[AT_RADII + pair % NUM_RADII, lane]
        first_side = 1.0 if sides < 2 else -1.0
        last_side = 1.0 if sides % 2 == 0 else -1.0
        a, b, c = tangent_path(
            *(first_side, last_side, x, y, heading, cosine, sine, first_radius, last_radius)
        )
        bends = first_side / first_radius, 0.0, last_side / last_radius
    else:
        radius = rows[AT_RADII + (choice - _TANGENTS) // 2, lane]
        side = 1.0 if choice % 2 == 0 else -1.0
        a, b, c = circles_path(side, x, y, heading, radius)
        bends = side / radius, -side / radius, side / radius
    plan[agent, PLAN_LENGTHS, lane], plan[agent, PLAN_CURVATURES, lane] = a, bends[0]
    plan[agent, PLAN_LENGTHS + 1, lane], plan[agent, PLAN_CURVATURES + 1, lane] = b, bends[1]
    plan[agent, PLAN_LENGTHS + 2, lane], plan[agent, PLAN_CURVATURES + 2, lane] = c, bends[2]


@rare_kernel
def turned_after(plan, agent, lane, first, distance):
    """Return the turn [rad] along a plan over a distance [m] from the start of a segment on."""
    turned = 0.0
    for segment in range(first, PLAN_SEGMENTS):
        along = min(distance, plan[agent, PLAN_LENGTHS + segment, lane])
        turned += along * plan[agent, PLAN_CURVATURES + segment, lane]
        distance -= along
    return turned


@rare_kernel
def _keeps_joints(guidance, world, agent, lane):
    """Return whether the chain can drive the plan to the goal, and straight on behind it."""
    plan, fleet = guidance.plan, world.fleet
    distance = step_length(guidance, world, agent, lane)
    for unit in range(1, fleet.num_trailers[agent, lane] + 1):
        if distance > _LONGEST_STEP * fleet.length[agent, unit, lane]:
            return False
    cosine, sine = steering_direction(world, agent, lane)
    most = distance * sine / (cosine * fleet.length[agent, 0, lane])
    bound = bend_bound(guidance, world, agent, lane)
    goal_x, goal_y, goal_heading = goal_pose(world, agent, lane)
    near = _WELL_WITHIN * guidance.distance_tolerance
    aligned = _WELL_WITHIN * guidance.heading_tolerance
    total = 0.0
    for segment in range(PLAN_SEGMENTS):
        total += plan[agent, PLAN_LENGTHS + segment, lane]
    put_chain(guidance, world, agent, lane, False)
    x, y, heading, driven = 0.0, 0.0, 0.0, 0.0
    hits = False
    while not hits:
        if driven > total:
            return False
        wanted = turned_after(plan, agent, lane, 0, driven + 0.5 * distance)
        turn = clip(wanted - heading, -most, most)
        least, _ = pull_chain(guidance, world, agent, lane, turn, distance)
        if least < bound:
            return False
        heading += turn
        sine, cosine = sincos(heading)
        x, y, driven = x + distance * cosine, y + distance * sine, driven + distance
        dx, dy = goal_x - x, goal_y - y
        off = heading - goal_heading
        off -= TWO_PI * math.floor(off / TWO_PI + 0.5)
        hits = (dx * dx + dy * dy < near * near) & (abs(off) < aligned)
    _, enough = sincos(_SPREAD * 0.25 * TWO_PI)
    for _ in range(_STRAIGHTENS):
        least, spread = pull_chain(guidance, world, agent, lane, 0.0, distance)
        if least < bound:
            return False
        if spread > enough:
            return True
    return False
