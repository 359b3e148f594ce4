"""This module has goal attraction along several courses, and tries courses by simulation.

Goal attraction is the paper's, Algorithm (goal_attraction). A course states the distance of its
approach point from the goal, and the radius of its Dubins paths. Some pairs of pose and course end
in a limit cycle. A HAV therefore follows a course that leads to its goal in a trial simulation.
"""

from baselines.policies.context.memory import TRIED
from baselines.policies.context.outlook import is_free
from baselines.policies.context.slots import widest_steering
from baselines.policies.dubins_pursuit import first_side
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.dubins import shortest_path_towards
from hav_env.safety.straightening import bends_too_far
from hav_env.safety.trial_moves import drive_on_trial
from hav_env.world.chain import front_axle
from hav_env.world.sensing import (
    goal_direction,
    goal_pose,
    limits,
    num_neighbors,
    stable_radius,
    unit_length,
)

COURSES = 9
_STRAIGHT_BELOW = 1e-3  # [m]
_LOOK_EVERY = 8  # steps of a trial between tests of the distance to others


@kernel
def attraction(policy, course, world, agent):
    """Return the side to which goal attraction steers on a course: 1.0 left, 0.0 straight."""
    forward, left, heading = goal_pose(world, agent, 0)
    cosine, sine = goal_direction(world, agent, 0)
    truck = unit_length(world, agent, 0, 0)
    before = truck * (1.0 + policy.spread * (course % 3))
    near = before + (policy.close_factor - 1.0) * truck
    close = forward * forward + left * left < near * near
    wide = stable_radius(world, agent, 0) * (1.0 + policy.wider * (course // 3 % 3))
    radius = truck if close else wide
    before = 0.0 if close else before
    word, first, second, third = shortest_path_towards(
        forward - before * cosine, left - before * sine, heading, cosine, sine, radius
    )
    return first_side(_STRAIGHT_BELOW, word, first, second, third)


@kernel
def course_of(mine):
    """Return the course that the HAV is on."""
    return int(mine[TRIED, 0]) % COURSES


@rare_kernel
def arrives(policy, course, world, agent, horizon, keep, speed, steering):
    """Return whether a course leads to the goal in so many steps; the HAV ends on its way.

    Args:
        policy: The parameters.
        course: Index of the course.
        world: A block of one world.
        agent: Index of the HAV.
        horizon: Largest number of steps.
        keep: Distance of its front from others [m], negative to ignore them.
        speed: (N, 1) commands [m/s]; the HAV's is overwritten.
        steering: (N, 1) commands [rad]; the HAV's is overwritten.
    """
    speed[agent, 0], _, _ = limits(world, agent, 0)
    steepest = widest_steering(policy, world, agent)
    others = keep >= 0.0 and num_neighbors(world, agent, 0) > 0
    for step in range(horizon):
        steering[agent, 0] = steepest * attraction(policy, course, world, agent)
        drive_on_trial(policy.vehicle, policy.dt, world, agent, speed, steering)
        if _hits(policy, world, agent):
            return True
        if bends_too_far(world, agent, 0):
            return False
        if others and step % _LOOK_EVERY == 0:
            x, y = front_axle(world, agent, 0)
            if not is_free(policy, world, agent, x, y, keep):
                return False
    return False


@kernel
def _hits(policy, world, agent):
    """Return whether the HAV is at its goal."""
    forward, left, heading = goal_pose(world, agent, 0)
    near = policy.distance_tolerance
    aligned = abs(heading) < policy.heading_tolerance
    return forward * forward + left * left < near * near and aligned
