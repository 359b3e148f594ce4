"""This module says whether a HAV keeps clear of others and of obstacles until it stands.

The plan of a HAV is a step with the command in question, and braking after it. The plan is clear of
another HAV if it stays farther from the present position of that HAV than the HAV may move until it
stands. docs/safety-filter.md has the theorem and its proof. All kernels work on blocks of one
world.
"""

from hav_env.compiled import generic, kernel, rare_kernel
from hav_env.maths.elementary import sincos
from hav_env.safety.displacement import bound_displacement
from hav_env.safety.gaps import boxes_apart, gap_of_bodies
from hav_env.safety.keeping_apart import has_right_of_way, may_reach_obstacle
from hav_env.safety.stopping.braking import brake_on_trial
from hav_env.safety.stopping.ways import own_way, way_of_other
from hav_env.safety.trial_moves import swap_posture
from hav_env.vehicles import actuators_of
from hav_env.world.collision import reach, squared_distance, within
from hav_env.world.obstacles.collisions import gap_to_segment
from hav_env.world.place.segments import MOST_MOVED, Obstacles, Plane, segment_of
from hav_env.world.sensing import neighbor_id, num_neighbors, waits

# far more than the rounding errors of a plan and of the sum of two gaps [m]
_SPARE_CLEARANCE = 1e-3


@kernel
def is_far_from_all(safety, task, actuators, world, agent):
    """Return whether a HAV's plan certainly is clear: a quick test, by distances of trucks.

    Args:
        safety: Safety filter.
        task: Rules of the episode.
        actuators: Limits of the rates.
        world: Block of one world.
        agent: Index of the HAV, at its position after the step in question.
    """
    whole = _way_of_plan(task, actuators, world, agent)
    if 2.0 * whole > task.sensing_range or may_reach_obstacle(world.place, world, agent, 0, whole):
        return False
    for k in range(num_neighbors(world, agent, 0)):
        other = neighbor_id(world, agent, k, 0)
        need = whole + _way_of_other(safety, task, actuators, world, agent, other)
        reaches = reach(world.fleet, agent, 0) + reach(world.fleet, other, 0)
        if within(squared_distance(world, agent, other, 0), reaches + need):
            return False
    return True


@kernel
def _way_of_plan(task, actuators, world, agent):
    """Return a bound [m] on the movement of any point of a HAV in its plan."""
    return own_way(actuators, task.dt, world, agent, world.state.speed[agent, 0]) + _SPARE_CLEARANCE


@kernel
def _way_of_other(safety, task, actuators, world, agent, other):
    """Return a bound [m] on the movement of any point of another HAV until it stands."""
    yields = waits(world, other, 0) or has_right_of_way(safety, world, agent, other, 0)
    return way_of_other(actuators, task.dt, world, other, 0, yields)


@rare_kernel
def plan_is_clear(safety, task, vehicle, world, agent, speed, steering, rows):
    """Return whether the plan of a HAV is clear of all others and of all obstacles.

    The HAV ends somewhere on its plan.

    Args:
        safety: Safety filter.
        task: Rules of the episode.
        vehicle: Vehicle model (kinematics).
        world: Block of one world.
        agent: Index of the HAV, at its position after the step in question.
        speed: (N, 1) commands [m/s]; the HAV's is overwritten.
        steering: (N, 1) commands [rad]; the HAV's is overwritten.
        rows: Scratch, which keeps the HAV's position before the step.
    """
    actuators, state = actuators_of(vehicle), world.state
    whole = _way_of_plan(task, actuators, world, agent)
    if 2.0 * whole > task.sensing_range:
        return False
    swap_posture(world, agent, rows, 0)
    before = _find_clearance(safety, task, actuators, world, agent, rows, whole, whole, True)
    swap_posture(world, agent, rows, 0)
    if before >= whole:
        return True
    for _ in range(safety.horizon):
        way = _way_in_step(task, world, agent) + _SPARE_CLEARANCE
        left = state.speed[agent, 0] - actuators.braking * task.dt
        rest = own_way(actuators, task.dt, world, agent, left) + _SPARE_CLEARANCE
        most = max(way, rest)
        after = _find_clearance(safety, task, actuators, world, agent, rows, most, whole, False)
        if not before + after > way:
            return False
        if after >= rest:
            return True
        before = after
        brake_on_trial(vehicle, task.dt, world, agent, speed, steering)
    return False


@kernel
def _way_in_step(task, world, agent):
    """Return a bound [m] on the movement of any point of a HAV in its latest step."""
    sine, cosine = sincos(world.state.steering[agent, 0])
    tangent, step = sine / cosine, task.dt * world.state.speed[agent, 0]
    return bound_displacement(world, agent, 0, step, tangent * tangent)


@kernel
def _find_clearance(safety, task, actuators, world, agent, rows, most, whole, begins):
    """Return how far a HAV may move at least until it may touch another one or an obstacle [m].

    Args:
        safety: Safety filter.
        task: Rules of the episode.
        actuators: Limits of the rates.
        world: Block of one world.
        agent: Index of the HAV, somewhere on its plan.
        rows: Scratch, which keeps the HAV's other position.
        most: Largest clearance of interest [m], which is returned where there is more.
        whole: Bound on the movement of any point in the whole plan [m].
        begins: Whether this is the present position.
    """
    least = most
    for k in range(num_neighbors(world, agent, 0)):
        other = neighbor_id(world, agent, k, 0)
        least = _clearance_beside(safety, task, actuators, world, agent, other, rows, least, begins)
    return _clearance_to_obstacles(world.place, world, agent, rows, least, whole, begins)


@kernel
def _clearance_beside(safety, task, actuators, world, agent, other, rows, least, begins):
    """Return the clearance beside another HAV, or ``least`` where it is larger [m]."""
    theirs = _way_of_other(safety, task, actuators, world, agent, other)
    reaches = reach(world.fleet, agent, 0) + reach(world.fleet, other, 0)
    bodies, need = world.fleet.bodies, theirs + least
    if not within(squared_distance(world, agent, other, 0), reaches + need):
        return least
    if boxes_apart(bodies, world, agent, other, 0, need):
        return least
    gap = gap_of_bodies(bodies, world, agent, other, 0, need)
    # HAVs that touch have already collided: nothing is left to prevent
    if gap >= need or _touches(world, agent, other, rows, begins):
        return least
    return gap - theirs


@kernel
def _touches(world, agent, other, rows, begins):
    """Return whether two HAVs touch at present."""
    if not begins:
        swap_posture(world, agent, rows, 0)
    gap = gap_of_bodies(world.fleet.bodies, world, agent, other, 0, _SPARE_CLEARANCE)
    if not begins:
        swap_posture(world, agent, rows, 0)
    return gap <= 0.0


@generic
def _clearance_to_obstacles(place, world, agent, rows, least, whole, begins):
    """Return the gap to the nearest obstacle, or ``least`` where it is larger [m]."""


@_clearance_to_obstacles.register(Plane)
def _clearance_on_plane(place, world, agent, rows, least, whole, begins):
    return least


@_clearance_to_obstacles.register(Obstacles)
def _clearance_to_segments(place, world, agent, rows, least, whole, begins):
    if not may_reach_obstacle(place, world, agent, 0, whole):
        return least
    driven, due = place.driven[agent, MOST_MOVED, 0], place.due[world.first, agent]
    for number in range(place.count[0]):
        # the present gap is at least the distance until the segment is due
        if due[number] - driven <= whole:
            segment = segment_of(place, number, 0)
            gap = max(gap_to_segment(world, agent, segment, 0), 0.0)
            if gap < least and not _touches_segment(world, agent, segment, rows, begins):
                least = gap
    return least


@kernel
def _touches_segment(world, agent, segment, rows, begins):
    """Return whether a HAV touches a segment at present."""
    if not begins:
        swap_posture(world, agent, rows, 0)
    gap = gap_to_segment(world, agent, segment, 0)
    if not begins:
        swap_posture(world, agent, rows, 0)
    return gap <= 0.0
