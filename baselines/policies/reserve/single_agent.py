"""This module plans the path of a lone HAV: the shortest of many tight ones without a jackknife.

A HAV may turn more tightly than it could without end, if the turn ends before a joint folds.
Candidates are two arcs of different radii with a straight between them, and three arcs. They lead
to poses throughout the tolerance of the goal. The HAV predicts them step by step, the shortest
first. It takes the first one on which every articulation stays allowed, up to the goal and on the
straight line behind it.
"""

import math

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import sizes
from baselines.policies.reserve.memory.shortlist import insert
from baselines.policies.reserve.perception.own_state import sense_itself, sense_joints, sensed_goal
from baselines.policies.reserve.prediction.motion import (
    advance_chain,
    command,
    follow,
    sense_chain,
    turn_to,
)
from baselines.policies.reserve.prediction.paths import (
    append,
    circles_path,
    heading_at,
    tangent_path,
    total_length,
)
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import TWO_PI, wrap

# Aims: forward and left of the goal [distance tolerances], turn to the left [heading tolerances].
_AIM_FORWARD = (-0.5, -0.2, -0.2, -0.5, -0.2, -0.2, -0.5, -0.2, -0.2)
_AIM_LEFT = (0.0, 0.7, -0.7, 0.0, 0.7, -0.7, 0.0, 0.7, -0.7)
_AIM_HEADING = (0.0, 0.0, 0.0, 0.9, 0.9, 0.9, -0.9, -0.9, -0.9)
AIMS = len(_AIM_HEADING)
SURELY = 1.0 - 1e-9  # of the tolerances of a goal: what is within is hit, despite rounding
_SIDE_PAIRS = 4  # left or right, then left or right
_TANGENTS = _SIDE_PAIRS * sizes.TURN_RADII * sizes.TURN_RADII  # two arcs and a straight
PER_AIM = _TANGENTS + 2 * sizes.TURN_RADII  # candidates of an aim: those, and three arcs

_TRUCK_FACTOR = 1.0 + 1e-6  # of the truck's tightest radius: steering can follow despite rounding
_TRAILER_FACTOR = 1.001  # of the least radius of the trailers: they can follow without end
_ROUGH_STEPS = 2.0  # steps at a time while arcs are measured: the path is predicted exactly later
_LAST_TURN_FACTOR = 1.1  # of the longest turn from a straight chain: it may be bent the other way
_STRAIGHT_FOOTPRINTS = 2.0  # straight ahead behind a goal, until the HAV is nearly straight
_PAUSE_TRUCKS = 0.5  # truck lengths straight ahead after a failed plan: the next one then differs


@rare_kernel
def act_alone(policy, rows, world, agent, lane):
    """Follow the path, or plan one. Drive straight on while no path is found.

    Returns:
        Speed [m/s] and steering [rad].
    """
    if (
        sense_itself(policy, rows, world, agent, lane)
        and rows[m.CURRENT_PATH + m.NUM_SEGMENTS] > 0.0
    ):
        rows[m.DRIVEN] -= rows[m.OWN_STEP]  # the HAV has stood instead
    if rows[m.PLANNED_GOALS_LEFT] != rows[m.OWN_GOALS_LEFT] or rows[m.DRIVEN] > total_length(
        rows, m.CURRENT_PATH
    ):
        rows[m.PLANNED_GOALS_LEFT], rows[m.CURRENT_PATH + m.NUM_SEGMENTS], rows[m.PAUSE] = (
            rows[m.OWN_GOALS_LEFT],
            0.0,
            0.0,
        )
    if rows[m.CURRENT_PATH + m.NUM_SEGMENTS] == 0.0:
        rows[m.PAUSE] -= 1.0
        if rows[m.PAUSE] < 0.0:
            sense_joints(rows, world, agent, lane)
            if plan_alone(policy, rows):
                rows[m.PLANNED_GOAL_HEADING], rows[m.DRIVEN] = rows[m.OWN_GOAL + 2], 0.0
    if rows[m.CURRENT_PATH + m.NUM_SEGMENTS] == 0.0:
        if rows[m.PAUSE] < 0.0:
            rows[m.PAUSE] = _PAUSE_TRUCKS * rows[m.OWN_LENGTHS] / rows[m.OWN_STEP]
        return command(policy, rows, 0.0, rows[m.OWN_STEP])
    turn, distance = follow(rows)
    rows[m.DRIVEN] += distance
    return command(policy, rows, turn, distance)


@rare_kernel
def plan_alone(policy, rows):
    """Write a path to the goal, and return whether one was found."""
    _measure_longest_turns(policy, rows)
    beyond = -1.0
    for _ in range(policy.shortlists):
        count = _list_shortest(policy, rows, beyond)
        for k in range(count):
            beyond = rows[m.LISTED_LENGTHS + k]
            _write_candidate(policy, rows, int(rows[m.LISTED_NUMBERS + k]))
            if survives(policy, rows):
                return True
        if count < sizes.SHORTLIST_SIZE:
            break
    rows[m.CURRENT_PATH + m.NUM_SEGMENTS] = 0.0
    return False


@kernel
def _radius(rows, number):
    """Return the radius [m] of a number, from the truck's tightest to one for the trailers.

    The curvatures are evenly spaced.
    """
    tightest = rows[m.OWN_TRUCK_RADIUS] * _TRUCK_FACTOR
    widest = max(_TRAILER_FACTOR * rows[m.OWN_TRAILER_RADIUS], tightest)
    share = number / (sizes.TURN_RADII - 1.0)
    return 1.0 / ((1.0 - share) / tightest + share / widest)


@rare_kernel
def _measure_longest_turns(policy, rows):
    """Measure the longest arc of each radius: from here, and from a straight chain."""
    for number in range(sizes.TURN_RADII):
        radius = _radius(rows, number)
        rows[m.FIRST_TURNS_LEFT + number] = _longest_turn(policy, rows, 1.0, radius, True)
        rows[m.FIRST_TURNS_RIGHT + number] = _longest_turn(policy, rows, -1.0, radius, True)
        rows[m.LAST_TURNS + number] = _longest_turn(policy, rows, 1.0, radius, False)


@rare_kernel
def _longest_turn(policy, rows, side, radius, bent):
    """Return the longest turn [rad] in which every articulation stays allowed.

    Args:
        policy: The Reserve.
        rows: The HAV's memory.
        side: Side of the turn, 1.0 left, -1.0 right.
        radius: Radius of the turn [m].
        bent: Whether the turn begins with the chain as it is now, not with a straight one.
    """
    sense_chain(rows)
    if not bent:
        _straighten(rows)
    bound = rows[m.OWN_LEAST_COSINE]
    step = _ROUGH_STEPS * rows[m.OWN_STEP]
    turned, x, y = 0.0, 0.0, 0.0
    while turned < TWO_PI:
        x, y, least = advance_chain(rows, x, y, side * step / radius, step)
        if least < bound:
            break
        turned += step / radius
    return turned


@kernel
def _straighten(rows):
    """Make the predicted chain straight."""
    for unit in range(sizes.MAX_UNITS):
        rows[m.PREDICTED_CHAIN + 2 * unit], rows[m.PREDICTED_CHAIN + 2 * unit + 1] = 1.0, 0.0


@rare_kernel
def _list_shortest(policy, rows, beyond):
    """List the shortest candidates that are longer than ``beyond`` [m], and return their number."""
    count = 0
    for aim in range(AIMS):
        x, y, heading, cosine, sine = _aim(policy, rows, aim)
        for pair in range(sizes.TURN_RADII * sizes.TURN_RADII):
            first, last = pair // sizes.TURN_RADII, pair % sizes.TURN_RADII
            first_radius = _radius(rows, first)
            last_radius = _radius(rows, last)
            for sides in range(_SIDE_PAIRS):
                first_side = 1.0 if sides < 2 else -1.0
                last_side = 1.0 if sides % 2 == 0 else -1.0
                a, b, c = tangent_path(
                    first_side, last_side, x, y, heading, cosine, sine, first_radius, last_radius
                )
                total = a + b + c
                if total <= beyond or (
                    count == sizes.SHORTLIST_SIZE
                    and total >= rows[m.LISTED_LENGTHS + sizes.SHORTLIST_SIZE - 1]
                ):
                    continue
                most = rows[
                    (m.FIRST_TURNS_LEFT if first_side > 0.0 else m.FIRST_TURNS_RIGHT) + first
                ]
                if (
                    a > most * first_radius
                    or c > _LAST_TURN_FACTOR * rows[m.LAST_TURNS + last] * last_radius
                ):
                    continue
                number = aim * PER_AIM + pair * _SIDE_PAIRS + sides
                count = insert(rows, count, total, number)
        for circle in range(2 * sizes.TURN_RADII):
            a, b, c = circles_path(
                1.0 if circle % 2 == 0 else -1.0,
                *(x, y, heading),
                _radius(rows, circle // 2),
            )
            total = a + b + c
            if beyond < total < math.inf:
                count = insert(rows, count, total, aim * PER_AIM + _TANGENTS + circle)
    return count


@kernel
def _aim(policy, rows, aim):
    """Return a pose within the goal's tolerances: x, y [m], heading [rad], its cosine and sine."""
    x, y, heading = sensed_goal(rows)
    cosine, sine = rows[m.OWN_GOAL + 3], rows[m.OWN_GOAL + 4]
    forward = _AIM_FORWARD[aim] * policy.distance_tolerance
    left = _AIM_LEFT[aim] * policy.distance_tolerance
    x, y = x + forward * cosine - left * sine, y + forward * sine + left * cosine
    heading = heading + _AIM_HEADING[aim] * policy.heading_tolerance
    sine, cosine = sincos(heading)
    return x, y, heading, cosine, sine


@rare_kernel
def _write_candidate(policy, rows, number):
    """Write a candidate into ``CURRENT_PATH``."""
    aim, rest = number // PER_AIM, number % PER_AIM
    x, y, heading, cosine, sine = _aim(policy, rows, aim)
    rows[m.CURRENT_PATH + m.NUM_SEGMENTS] = 0.0
    if rest < _TANGENTS:
        pair, sides = rest // _SIDE_PAIRS, rest % _SIDE_PAIRS
        first_radius = _radius(rows, pair // sizes.TURN_RADII)
        last_radius = _radius(rows, pair % sizes.TURN_RADII)
        first_side = 1.0 if sides < 2 else -1.0
        last_side = 1.0 if sides % 2 == 0 else -1.0
        a, b, c = tangent_path(
            first_side, last_side, x, y, heading, cosine, sine, first_radius, last_radius
        )
        append(rows, m.CURRENT_PATH, first_side / first_radius, a)
        append(rows, m.CURRENT_PATH, 0.0, b)
        append(rows, m.CURRENT_PATH, last_side / last_radius, c)
    else:
        radius = _radius(rows, (rest - _TANGENTS) // 2)
        side = 1.0 if rest % 2 == 0 else -1.0
        a, b, c = circles_path(side, x, y, heading, radius)
        append(rows, m.CURRENT_PATH, side / radius, a)
        append(rows, m.CURRENT_PATH, -side / radius, b)
        append(rows, m.CURRENT_PATH, side / radius, c)


@rare_kernel
def survives(policy, rows):
    """Tell whether the path hits the goal while every articulation stays allowed.

    Behind a goal that is not the last one, every articulation must also stay allowed straight
    ahead, until the HAV is straight again.
    """
    goal_x, goal_y, goal_heading = sensed_goal(rows)
    bound = rows[m.OWN_LEAST_COSINE]
    distance = rows[m.OWN_STEP]
    sense_chain(rows)
    x, y, heading, driven, total = 0.0, 0.0, 0.0, 0.0, total_length(rows, m.CURRENT_PATH)
    hit = False
    while not hit:
        if driven > total:
            return False
        wanted = heading_at(rows, m.CURRENT_PATH, driven + 0.5 * distance)
        turn = turn_to(rows, wanted, heading, distance)
        x, y, least = advance_chain(rows, x, y, turn, distance)
        if least < bound:
            return False
        heading, driven = heading + turn, driven + distance
        hit = hits_goal(policy, goal_x - x, goal_y - y, goal_heading - heading, SURELY)
    if rows[m.OWN_GOALS_LEFT] == 1:
        return True
    driven = 0.0
    while driven < _STRAIGHT_FOOTPRINTS * rows[m.OWN_FOOTPRINT]:
        x, y, least = advance_chain(rows, x, y, 0.0, distance)
        if least < bound:
            return False
        driven += distance
    return True


@kernel
def hits_goal(policy, dx, dy, turn, share):
    """Tell whether a goal is hit, with the tolerances times ``share``.

    Args:
        policy: The Reserve, which has the tolerances.
        dx: Difference of the goal's x and the truck's [m].
        dy: Difference of the goal's y and the truck's [m].
        turn: Difference of the goal's heading and the truck's [rad].
        share: Factor of both tolerances.
    """
    near = policy.distance_tolerance * share
    aligned = abs(wrap(turn)) < policy.heading_tolerance * share
    return (dx * dx + dy * dy < near * near) & aligned
