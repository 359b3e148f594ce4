"""This module detects collisions of HAVs with obstacles, and their times.

A segment is tested exactly when a HAV may have reached it, and not earlier. The exact test finds
the gap between a segment and the bodies of a HAV. From then on, the simulator sums upper bounds on
the movement of the HAV's points. The segment is due again when the sum exceeds the gap.

The bound for a step is measured, not derived from a model of the kinematics. A body is rigid and
moves by an affine map. Its points on the line between two ends move no farther than the farther of
both ends. A point at distance e beyond that line moves at most e times the length of the difference
of both directions farther. The rule therefore holds for every vehicle and integrator. If
collisions between steps count, axles move straight in a step. No point then moves farther than by
the bound, at any time of the step.
"""

import math

from hav_env.compiled import fixed, generic, kernel, rare_kernel
from hav_env.compiled.precision import either
from hav_env.maths.elementary import sqrt
from hav_env.maths.geometry import clip, into_frame
from hav_env.maths.rectangles import rectangle_gap
from hav_env.world.arrays import NEVER, OBSTACLE, STEP, WHEN, WHERE
from hav_env.world.bodies import reach_of
from hav_env.world.chain import ends_behind, front_axle
from hav_env.world.continuous_collision import passes_segment
from hav_env.world.place.segments import (
    BEFORE_X,
    BEFORE_Y,
    BODY_MARGIN,
    FARTHEST,
    MOST_MOVED,
    MOST_TURNED,
    NEXT_DUE,
    WENT_X,
    WENT_Y,
    Obstacles,
    Plane,
    segment_of,
)
from hav_env.world.rectangle_bodies import body_of, margin_of
from hav_env.world.task import records
from hav_env.world.units.joints import unit_spans

# in each precision: more than the rounding error of gaps at the largest coordinates [m], and more
# than that of a sum of a few numbers as a share of it
_ROUNDING = 1e-6, 1e-3
_OF_SUM = 1e-15, 1e-6
_FAR = 0.5  # share of the reach: from this distance on, the distance to the truck suffices


@generic
def note_posture(place, world, agent):
    """Record the posture of a HAV before it moves, in every lane of a block."""


@note_posture.register(Plane)
def _note_nothing(place, world, agent):
    pass


@note_posture.register(Obstacles)
def _note_directions(place, world, agent):
    state = world.state
    for lane in range(world.lanes):
        place.moved[BEFORE_X, lane] = state.x[agent, lane]
        place.moved[BEFORE_Y, lane] = state.y[agent, lane]
    for number in range(world.units):
        unit = fixed(number)
        for lane in range(world.lanes):
            place.cosine[unit, lane] = state.cosine[agent, unit, lane]
            place.sine[unit, lane] = state.sine[agent, unit, lane]


@generic
def record_obstacle_collisions(place, task, world, agent):
    """Record the first collision of a HAV with a segment, in every lane, after its move.

    Call ``note_posture`` before the move and ``add_motion`` after it.

    Returns:
        Number of HAVs that collided for the first time.
    """


@record_obstacle_collisions.register(Plane)
def _record_nothing(place, task, world, agent):
    return 0


@record_obstacle_collisions.register(Obstacles)
def _record_those_due(place, task, world, agent):
    due = 0
    for lane in range(world.lanes):
        due += place.driven[agent, MOST_MOVED, lane] >= place.driven[agent, NEXT_DUE, lane]
    return _test_lanes(place, task, world, agent) if due > 0 else 0


@generic
def begin_among_obstacles(place, task, world, agent):
    """Begin an episode of a HAV in every lane: all segments are due, and are tested."""


@begin_among_obstacles.register(Plane)
def _begin_in_plane(place, task, world, agent):
    pass


@begin_among_obstacles.register(Obstacles)
def _begin_anew(place, task, world, agent):
    for lane in range(world.lanes):
        place.driven[agent, MOST_MOVED, lane] = 0.0
        place.driven[agent, NEXT_DUE, lane] = 0.0
        find_margin(place, world, agent, lane)
        due = place.due[world.first + lane, agent]
        for number in range(due.shape[0]):
            due[number] = 0.0 if number < place.count[lane] else math.inf
    _test_lanes(place, task, world, agent)


@generic
def find_margin(place, world, agent, lane):
    """Find the largest distance that bodies of a HAV reach from the lines between their ends."""


@find_margin.register(Plane)
def _need_no_margin(place, world, agent, lane):
    pass


@find_margin.register(Obstacles)
def _find_margin_of_all(place, world, agent, lane):
    fleet, most = world.fleet, 0.0
    for unit in range(fleet.num_trailers[agent, lane] + 1):
        most = max(most, margin_of(fleet.bodies, agent, unit, lane))
    place.driven[agent, BODY_MARGIN, lane] = most


@generic
def add_motion(place, world, agent):
    """Sum the upper bounds on the movement of a HAV's points; see the module's docstring."""


@add_motion.register(Plane)
def _add_nothing(place, world, agent):
    pass


@add_motion.register(Obstacles)
def _add_most_of_all(place, world, agent):
    state, fleet, moved = world.state, world.fleet, place.moved
    for lane in range(world.lanes):
        wheelbase = fleet.length[agent, 0, lane]
        dx, dy = _turned(place, state, agent, 0, lane)
        went_x = state.x[agent, lane] - moved[BEFORE_X, lane] + wheelbase * dx
        went_y = state.y[agent, lane] - moved[BEFORE_Y, lane] + wheelbase * dy
        moved[WENT_X, lane], moved[WENT_Y, lane] = went_x, went_y
        moved[FARTHEST, lane] = went_x * went_x + went_y * went_y
        moved[MOST_TURNED, lane] = 0.0
    for number in range(world.units):
        unit = fixed(number)
        for lane in range(world.lanes):
            line, following = unit_spans(fleet.joints, fleet, agent, unit, lane)
            dx, dy = _turned(place, state, agent, unit, lane)
            went_x, went_y = moved[WENT_X, lane], moved[WENT_Y, lane]
            end_x, end_y = went_x - line * dx, went_y - line * dy
            moved[FARTHEST, lane] = max(moved[FARTHEST, lane], end_x * end_x + end_y * end_y)
            moved[WENT_X, lane], moved[WENT_Y, lane] = (
                went_x - following * dx,
                went_y - following * dy,
            )
            moved[MOST_TURNED, lane] = max(moved[MOST_TURNED, lane], dx * dx + dy * dy)
    for lane in range(world.lanes):
        swing = place.driven[agent, BODY_MARGIN, lane] * sqrt(moved[MOST_TURNED, lane])
        driven = place.driven[agent, MOST_MOVED, lane] + sqrt(moved[FARTHEST, lane]) + swing
        # rounded up, so that rounding errors of many steps do not add up
        place.driven[agent, MOST_MOVED, lane] = driven + either(driven, *_OF_SUM) * driven


@kernel
def _turned(place, state, agent, unit, lane):
    """Return the change of a unit's direction: the length of the difference of unit vectors."""
    return (
        state.cosine[agent, unit, lane] - place.cosine[unit, lane],
        state.sine[agent, unit, lane] - place.sine[unit, lane],
    )


@rare_kernel
def _test_lanes(place, task, world, agent):
    """Test the segments that are due, in every lane; return the number of HAVs that collided."""
    first, news = world.record.first, 0
    for lane in range(world.lanes):
        if not place.driven[agent, MOST_MOVED, lane] >= place.driven[agent, NEXT_DUE, lane]:
            continue
        if not records(task, world.state.clock[STEP, lane]):
            continue
        hit = _test_segments(place, task, world, agent, lane)
        if hit != NEVER:
            first[agent, OBSTACLE, WHEN, lane] = world.state.clock[STEP, lane]
            first[agent, OBSTACLE, WHERE, lane] = hit
            place.driven[agent, NEXT_DUE, lane] = math.inf  # only the first collision is recorded
            news += 1
    return news


@kernel
def _test_segments(place, task, world, agent, lane):
    """Test the segments that are due; return the first that a HAV collides with, or NEVER.

    If a scenario placed a HAV on a segment, the segment stays due until the first step.
    """
    begun = world.state.clock[STEP, lane] > 0
    driven, due = place.driven[agent, MOST_MOVED, lane], place.due[world.first + lane, agent]
    least = math.inf
    for number in range(place.count[lane]):
        if due[number] <= driven:
            segment = segment_of(place, number, lane)
            gap = gap_to_segment(world, agent, segment, lane)
            passed = task.continuous_collisions and passes_segment(world, agent, segment, lane)
            if (gap <= 0.0 or passed) and begun:
                return number
            safe = driven + max(gap, 0.0) - either(driven, *_ROUNDING)
            due[number] = safe - either(driven, *_OF_SUM) * abs(safe)
        least = min(least, due[number])
    place.driven[agent, NEXT_DUE, lane] = least
    return NEVER


@kernel
def gap_to_segment(world, agent, segment, lane):
    """Return a gap between a segment and the bodies of a HAV [m], at most their distance.

    It is above zero if and only if they have no point in common. The kernel skips bodies that
    cannot be nearer than another one: their distance is at least that of the middles minus half
    lengths and widths.
    """
    far = _distance(world.state.x[agent, lane], world.state.y[agent, lane], segment)
    reach = reach_of(world.fleet.bodies, world.fleet, agent, lane)
    if far > (1.0 + _FAR) * reach:
        return far - reach
    x, y = front_axle(world, agent, lane)
    least = math.inf
    for unit in range(world.fleet.num_trailers[agent, lane] + 1):
        body = body_of(world.fleet.bodies, world, agent, unit, lane, x, y)
        middle_x, middle_y, _, _, half, width = body
        if _distance(middle_x, middle_y, segment) - half - width < least:
            least = min(least, rectangle_gap(body, segment))
        _, _, x, y = ends_behind(world, agent, unit, lane, x, y)
    return least


@kernel
def _distance(x, y, segment):
    """Return the distance [m] of a position from a segment."""
    middle_x, middle_y, cosine, sine, half, _ = segment
    along, across = into_frame(x - middle_x, y - middle_y, cosine, sine)
    beyond = along - clip(along, -half, half)
    return sqrt(beyond * beyond + across * across)
