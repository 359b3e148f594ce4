"""This module predicts whether all joints of a HAV keep their limit on a path or a circle.

Articulations are small if they are at most those of a circle that is hardly tighter than the HAV's.
On paths as wide as the HAV's circle they stay small. These therefore need no prediction.
docs/safety.md has the proof.
"""

import math

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import sizes
from baselines.policies.reserve.perception.own_state import SURELY, hits_goal, sensed_goal
from baselines.policies.reserve.prediction.motion import advance_chain, sense_chain, turn_to
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import TWO_PI, into_frame, point_segment_squared, wrap

_BOX_ROOM = 1.01  # radius of the circle over that of the limit values: the chain closes in on them
_STRAIGHT = 1.0 - 1e-6  # cosine of an articulation that is straight but for 1.4 mrad
_NEAR_END = 2.0  # [m] before the end of a straight, from where every step of it is predicted
_ROUGHLY = 1e-5  # [m], [rad] beyond a goal's tolerances: not hit, despite rounding
_SAME_PLACE = 1e-6  # [m] along a path: far more than the rounding of the distance driven
_LOOK_EVERY = 8  # steps from one comparison with the limit values to the next


@rare_kernel
def are_joints_small(rows):
    """Return whether the predicted chain keeps its joints on every path as wide as the circle."""
    radius = rows[m.OWN_CIRCLE_RADIUS] / _BOX_ROOM
    squared = radius * radius
    ahead = m.PREDICTED_CHAIN
    for unit in range(1, int(rows[m.OWN_TRAILERS]) + 1):
        at, length = m.PREDICTED_CHAIN + 2 * unit, rows[m.OWN_LENGTHS + unit]
        straightness, bend = into_frame(rows[at], rows[at + 1], rows[ahead], rows[ahead + 1])
        if straightness <= 0.0 or bend * bend * squared > length * length:
            return False
        squared -= length * length
        ahead = at
    return True


@kernel
def need_no_prediction(rows):
    """Return whether the predicted chain keeps its joints on wide paths, or has no tight ones."""
    return rows[m.OWN_TIGHT] == 0.0 or are_joints_small(rows)


@rare_kernel
def circle_keeps_joints(rows, side, shift):
    """Return whether the predicted chain can drive straight on and round the circle; keep it.

    Args:
        rows: The HAV's memory.
        side: Side of the circle, 1.0 left, -1.0 right.
        shift: Straight distance before the circle [m].
    """
    if need_no_prediction(rows):
        return True
    for row in range(2 * sizes.MAX_UNITS):
        rows[m.SAVED_CHAIN + row] = rows[m.PREDICTED_CHAIN + row]
    radius, distance = rows[m.OWN_CIRCLE_RADIUS], rows[m.OWN_STEP]
    driven, turned, kept, number = 0.0, 0.0, True, 0
    while kept and driven < shift + TWO_PI * radius:
        wanted = side * max(driven + 0.5 * distance - shift, 0.0) / radius
        turn = turn_to(rows, wanted, turned, distance)
        _, _, least = advance_chain(rows, 0.0, 0.0, turn, distance)
        turned, driven, number = turned + turn, driven + distance, number + 1
        kept = least >= rows[m.OWN_LEAST_COSINE]
        if number % _LOOK_EVERY == 0 and are_joints_small(rows):
            break
    for row in range(2 * sizes.MAX_UNITS):
        rows[m.PREDICTED_CHAIN + row] = rows[m.SAVED_CHAIN + row]
    return kept


@rare_kernel
def path_keeps_joints(policy, rows, path, to_goal):
    """Return whether the own chain can drive along a path, and then round a circle.

    Args:
        policy: The Reserve.
        rows: The HAV's memory.
        path: First row of the path.
        to_goal: Whether the path must hit the goal. Behind the last goal the joints do not matter.
    """
    if to_goal and not _may_hit(policy, rows, path):
        return False
    goal_x, goal_y, goal_heading = sensed_goal(rows)
    sense_chain(rows)
    distance, bound = rows[m.OWN_STEP], rows[m.OWN_LEAST_COSINE]
    near = policy.distance_tolerance
    x, y, driven, heading, begin, ahead = 0.0, 0.0, 0.5 * distance, 0.0, 0.0, 0.0
    hit = False
    for segment in range(int(rows[path + m.NUM_SEGMENTS])):
        curvature, end = rows[path + m.CURVATURES + segment], rows[path + m.LENGTHS + segment]
        end += begin
        while driven <= end and not hit:
            turn = turn_to(rows, ahead + curvature * (driven - begin), heading, distance)
            x, y, least = advance_chain(rows, x, y, turn, distance)
            heading, driven = heading + turn, driven + distance
            if least < bound:
                return False
            dx, dy = goal_x - x, goal_y - y
            if to_goal and abs(dx) < near and abs(dy) < near:
                hit = hits_goal(policy, dx, dy, goal_heading - heading, SURELY)
            if curvature == 0.0 and least >= _STRAIGHT and driven < end - _NEAR_END:
                skipped = distance * math.floor((end - _NEAR_END - driven) / distance)
                driven += skipped
                x += skipped * rows[m.PREDICTED_CHAIN]
                y += skipped * rows[m.PREDICTED_CHAIN + 1]
        ahead, begin = ahead + curvature * (end - begin), end
    if to_goal and (not hit or rows[m.OWN_GOALS_LEFT] == 1.0):
        return hit
    return circle_keeps_joints(rows, 1.0, 0.0) or circle_keeps_joints(rows, -1.0, 0.0)


@rare_kernel
def _may_hit(policy, rows, path):
    """Return whether the truck may hit the goal on a path. The trailers do not matter.

    The truck drives as in ``path_keeps_joints``, but skips straights, except near the goal. Its
    poses therefore differ by rounding: by far less than ``_ROUGHLY``, which the tolerances exceed.
    """
    goal_x, goal_y, goal_heading = sensed_goal(rows)
    distance, near = rows[m.OWN_STEP], policy.distance_tolerance + _ROUGHLY
    aligned = policy.heading_tolerance + _ROUGHLY
    x, y, driven, heading, begin, ahead = 0.0, 0.0, 0.5 * distance, 0.0, 0.0, 0.0
    for segment in range(int(rows[path + m.NUM_SEGMENTS])):
        curvature, end = rows[path + m.CURVATURES + segment], rows[path + m.LENGTHS + segment]
        end += begin
        # rounding may add a step at the end, where the next segment wants the same heading
        while driven <= end + _SAME_PLACE:
            turn = turn_to(rows, ahead + curvature * (driven - begin), heading, distance)
            heading, driven = heading + turn, driven + distance
            sine, cosine = sincos(heading)
            x, y = x + distance * cosine, y + distance * sine
            dx, dy = goal_x - x, goal_y - y
            if dx * dx + dy * dy < near * near and abs(wrap(goal_heading - heading)) < aligned:
                return True
            if curvature == 0.0 and turn == 0.0 and driven < end - _NEAR_END:
                skipped = distance * math.floor((end - _NEAR_END - driven) / distance)
                then_x, then_y = x + skipped * cosine, y + skipped * sine
                if point_segment_squared(goal_x, goal_y, x, y, then_x, then_y) > near * near:
                    driven, x, y = driven + skipped, then_x, then_y
        ahead, begin = ahead + curvature * (end - begin), end
    return False


@rare_kernel
def keeps_joints_when_wide(rows):
    """Return whether the own chain, as it is now, keeps its joints on wide paths."""
    sense_chain(rows)
    return need_no_prediction(rows)
