"""This module stops a HAV for a step that might end in a collision.

All HAVs decide at once, from the positions of the others, without broadcast. docs/safety-filter.md
has the theorem and its proof. A HAV may move past another HAV if rule A or rule B allows it:

A. After its step, it is farther from the present position of the other HAV than either may move
   in the step.
B. The other HAV certainly stands, or yields by the right of way, and the sum of the gaps before
   and after the step exceeds the HAV's own movement.
"""

from hav_env.compiled import fixed, generic, kernel, rare_kernel
from hav_env.maths.elementary import sincos
from hav_env.safety.displacement import (
    bound_displacement,
    bound_moves,
    most_displacement,
    roughly_most,
)
from hav_env.safety.gaps import boxes_apart, gap_of_bodies
from hav_env.safety.trial_moves import LONGEST_MOVE, MAY_BE_NEAR, drives, swap_posture
from hav_env.world.arrays import HANDFUL, NEVER, SPEED, STEP, World
from hav_env.world.collision import reach, squared_distance, within
from hav_env.world.event_table import obstacle_hit_at
from hav_env.world.obstacles.collisions import gap_to_segment
from hav_env.world.place.segments import MOST_MOVED, NEXT_DUE, Obstacles, Plane, segment_of
from hav_env.world.sensing import neighbor_id, num_neighbors, waits

# no point of a HAV moves farther than so many steps of its truck; a HAV that might is stopped
FARTHEST_STEPS = 25.0
# far more than the rounding error of the sum of two gaps [m]
_SPARE_GAP = 1e-3


@kernel
def _find_suspects(task, world, agent, rows):
    """Write bounds on moves, and whether others may be near, in every lane of a block."""
    bound_moves(world.fleet.joints, world, agent, task.dt, rows)
    num_havs = world.state.x.shape[0]
    if num_havs > HANDFUL:
        for lane in range(world.lanes):
            near = may_come_near(task, world, agent, lane)
            rows[MAY_BE_NEAR, lane] = 1.0 if near else 0.0
        return
    for lane in range(world.lanes):
        step = task.dt * world.fleet.limit[agent, SPEED, lane]
        near = may_reach_obstacle(world.place, world, agent, lane, FARTHEST_STEPS * step)
        rows[MAY_BE_NEAR, lane] = 1.0 if near else 0.0
    for number in range(num_havs):
        other = fixed(number)
        if other != agent:
            for lane in range(world.lanes):  # whether they sense each other does not matter here
                near = _may_meet(task, world, agent, other, lane)
                rows[MAY_BE_NEAR, lane] = max(rows[MAY_BE_NEAR, lane], 1.0 if near else 0.0)


@kernel
def may_come_near(task, world: World, agent: int, lane: int) -> bool:
    """Return whether a HAV's step may reach a neighbour or an obstacle: a quick test."""
    for k in range(num_neighbors(world, agent, lane)):
        if _may_meet(task, world, agent, neighbor_id(world, agent, k, lane), lane):
            return True
    step = task.dt * world.fleet.limit[agent, SPEED, lane]
    return may_reach_obstacle(world.place, world, agent, lane, FARTHEST_STEPS * step)


@kernel
def _may_meet(task, world, agent, other, lane):
    """Return whether two HAVs are so near that a step of both may let them touch."""
    own, others = (
        world.fleet.limit[agent, SPEED, lane],
        world.fleet.limit[other, SPEED, lane],
    )
    reaches = reach(world.fleet, agent, lane) + reach(world.fleet, other, lane)
    limit = reaches + FARTHEST_STEPS * (task.dt * max(own, others))
    return within(squared_distance(world, agent, other, lane), limit)


@kernel
def may_go_too_far(task, world: World, agent: int, lane: int) -> bool:
    """Return whether a HAV's step may be too long for the quick test, or for its sensing range."""
    return _may_go_too_far(task, world, agent, lane, roughly_most(world, agent, lane, task.dt))


@kernel
def _may_go_too_far(task, world, agent, lane, rough):
    longest = FARTHEST_STEPS * task.dt * world.fleet.limit[agent, SPEED, lane]
    if rough <= longest and 2.0 * rough <= task.sensing_range:
        return False  # as the bound itself, which is not longer
    most = most_displacement(world, agent, lane, task.dt)
    return (most > longest) | (2.0 * most > task.sensing_range)


@rare_kernel
def keep_apart(safety, task, world, agent, speed, rows):
    """Stop one HAV for a step that might end in a collision, in every lane of a block.

    The loop is in a function of its own, because a call passes on every array of a world.

    Args:
        safety: Safety filter.
        task: Rules of the episode.
        world: Block of worlds, in which the HAV is at its position after the step.
        agent: Index of the HAV.
        speed: (N, W) commands [m/s]; row ``agent`` is overwritten where the HAV must stand.
        rows: Scratch, which keeps the HAV's position before the step.
    """
    _find_suspects(task, world, agent, rows)
    for lane in range(world.lanes):
        if drives(world, agent, lane):
            stands = _may_go_too_far(task, world, agent, lane, rows[LONGEST_MOVE, lane]) or (
                rows[MAY_BE_NEAR, lane] != 0.0
                and must_stand(safety, task, world, agent, lane, rows[LONGEST_MOVE, lane], rows)
            )
            speed[agent, lane] = 0.0 if stands else speed[agent, lane]


@kernel
def must_stand(safety, task, world, agent, lane, longest, rows):
    """Return whether a HAV must stand for the step of its trial.

    Args:
        safety: Safety filter.
        task: Rules of the episode.
        world: Block of worlds, in which the HAV is at its position after the step.
        agent: Index of the HAV.
        lane: Index of the world.
        longest: Distance [m] that no point of the HAV exceeds in a step, whatever its command.
        rows: Scratch, which keeps the HAV's position before the step.
    """
    for k in range(num_neighbors(world, agent, lane)):
        other = neighbor_id(world, agent, k, lane)
        if not _is_clear(task, world, agent, other, lane, longest) and not _keeps_from(
            safety, task, world, agent, other, lane, rows
        ):
            return True
    return not keeps_from_obstacles(world.place, task, world, agent, lane, rows)


@kernel
def _way_of(task, world, agent, lane):
    """Return a bound [m] on the movement of any point of a HAV in its trial step."""
    state = world.state
    sine, cosine = sincos(state.steering[agent, lane])
    tangent, step = sine / cosine, task.dt * state.speed[agent, lane]
    return bound_displacement(world, agent, lane, step, tangent * tangent)


@kernel
def _is_clear(task, world, agent, other, lane, longest):
    """Return whether rule A certainly holds: a quick test, with bounds on the two movements."""
    reaches = reach(world.fleet, agent, lane) + reach(world.fleet, other, lane)
    need = max(longest, roughly_most(world, other, lane, task.dt)) + _SPARE_GAP
    if not within(squared_distance(world, agent, other, lane), reaches + need):
        return True
    return boxes_apart(world.fleet.bodies, world, agent, other, lane, need)


@rare_kernel
def _keeps_from(safety, task, world, agent, other, lane, rows):
    """Return whether rule A or B lets a HAV move past another HAV."""
    way, bodies = _way_of(task, world, agent, lane), world.fleet.bodies
    reaches = reach(world.fleet, agent, lane) + reach(world.fleet, other, lane)
    need = max(way, most_displacement(world, other, lane, task.dt)) + _SPARE_GAP
    if not within(squared_distance(world, agent, other, lane), reaches + need):
        return True
    after = gap_of_bodies(bodies, world, agent, other, lane, need)
    if after >= need:
        return True
    swap_posture(world, agent, rows, lane)
    before = gap_of_bodies(bodies, world, agent, other, lane, need + way)
    swap_posture(world, agent, rows, lane)
    yields = waits(world, other, lane) or has_right_of_way(safety, world, agent, other, lane)
    # HAVs that touch have already collided: nothing is left to prevent
    return before <= 0.0 or (yields and before + after > way + _SPARE_GAP)


@kernel
def has_right_of_way(safety, world, agent, other, lane):
    """Return whether a HAV has the right of way, which alternates every ``safety.turn`` steps.

    Exactly one of the two has it: both read the same clock and the same two indices.
    """
    lower_first = (world.state.clock[STEP, lane] // safety.turn) % 2 == 0
    return lower_first == (agent < other)


@generic
def may_reach_obstacle(place, world, agent, lane, distance):
    """Return whether an obstacle may be within a distance [m] of a HAV: a quick test."""


@may_reach_obstacle.register(Plane)
def _reach_nothing(place, world, agent, lane, distance):
    return False


@may_reach_obstacle.register(Obstacles)
def _reach_what_is_due(place, world, agent, lane, distance):
    driven = place.driven
    near = driven[agent, MOST_MOVED, lane] + distance >= driven[agent, NEXT_DUE, lane]
    # the simulator tests obstacles only until the first collision, so nothing is due afterwards
    return near | (obstacle_hit_at(place, world, agent, lane) > NEVER)


@generic
def keeps_from_obstacles(place, task, world, agent, lane, rows):
    """Return whether a HAV touches no obstacle at any moment of its trial step.

    It touches none if the sum of the gaps before and after exceeds the movement of all its points.
    """


@keeps_from_obstacles.register(Plane)
def _keeps_from_nothing(place, task, world, agent, lane, rows):
    return True


@keeps_from_obstacles.register(Obstacles)
def _keeps_from_segments(place, task, world, agent, lane, rows):
    driven, due = place.driven[agent, MOST_MOVED, lane], place.due[world.first + lane, agent]
    limit = _way_of(task, world, agent, lane) + _SPARE_GAP
    for number in range(place.count[lane]):
        least = due[number] - driven  # the gap before the step is at least that
        if least > limit:
            continue
        segment = segment_of(place, number, lane)
        after = max(gap_to_segment(world, agent, segment, lane), 0.0)
        if least + after > limit:
            continue
        swap_posture(world, agent, rows, lane)
        before = gap_to_segment(world, agent, segment, lane)
        swap_posture(world, agent, rows, lane)
        if before > 0.0 and before + after <= limit:
            return False
    return True
