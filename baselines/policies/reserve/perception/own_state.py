"""This module writes the HAV's sensing of itself into its memory, once a step.

All other modules read the memory only. A decision therefore cannot depend on anything that the HAV
does not know. In addition, their functions compile faster without the forty arrays of a world as
arguments.
"""

import math

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.preconditions import CIRCLE_FACTOR
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import TWO_PI, wrap
from hav_env.world.sensing import (
    articulation_direction,
    episode_key,
    goal_direction,
    goal_pose,
    goals_left,
    limits,
    num_trailers,
    own_footprint,
    stable_radius,
    steering_direction,
    unit_length,
)

SURELY = 1.0 - 1e-9  # share of a goal's tolerances: poses within hit it, despite rounding
_EXTRA_BEND = 1.5  # of the square of a unit's turn: bends between steps; up to 0.97 were measured
_SWING = 1.5  # of step / shortest unit: share by which a trailer may move farther than its pull


@kernel
def sense_itself(policy, rows, world, agent, lane):
    """Write the quantities that change in each step, and in the first step also the constant ones.

    Returns:
        Whether the HAV has stood: its sensed goal is where it was in the step before.
    """
    if rows[m.OWN_STEP] == 0.0:
        _sense_body(policy, rows, world, agent, lane)
    x, y, heading = goal_pose(world, agent, lane)
    stood = (
        (x == rows[m.OWN_GOAL]) & (y == rows[m.OWN_GOAL + 1]) & (heading == rows[m.OWN_GOAL + 2])
    )
    rows[m.OWN_GOAL], rows[m.OWN_GOAL + 1], rows[m.OWN_GOAL + 2] = x, y, heading
    cosine, sine = goal_direction(world, agent, lane)
    rows[m.OWN_GOAL + 3], rows[m.OWN_GOAL + 4] = cosine, sine
    rows[m.OWN_GOALS_LEFT] = goals_left(world, agent, lane)
    seed, episode, step = episode_key(world, lane)
    rows[m.OWN_RANDOM_KEY], rows[m.OWN_RANDOM_KEY + 1], rows[m.OWN_RANDOM_KEY + 2] = (
        seed,
        episode,
        step,
    )
    return stood


@rare_kernel
def _sense_body(policy, rows, world, agent, lane):
    """Write lengths, limits and the radii that follow from them."""
    trailers = num_trailers(world, agent, lane)
    rows[m.OWN_NUMBER], rows[m.OWN_TRAILERS] = agent, trailers
    for unit in range(trailers + 1):
        rows[m.OWN_LENGTHS + unit] = unit_length(world, agent, unit, lane)
    truck = rows[m.OWN_LENGTHS]
    rows[m.OWN_FOOTPRINT] = own_footprint(world, agent, lane)
    rows[m.OWN_REACH] = max(rows[m.OWN_FOOTPRINT], truck)
    speed, _, articulation_max = limits(world, agent, lane)
    cosine, sine = steering_direction(world, agent, lane)
    rows[m.OWN_STEP], rows[m.OWN_STEERING_TANGENT] = speed * policy.dt, sine / cosine
    bound = articulation_max - policy.articulation_margin
    bend, rows[m.OWN_LEAST_COSINE] = sincos(bound)
    rows[m.OWN_FOLD_TURN] = TWO_PI - 2.0 * bound
    bend = bend if rows[m.OWN_LEAST_COSINE] > 0.0 else 1.0
    rows[m.OWN_TRUCK_RADIUS] = truck * cosine / sine
    # R_min of eq. (17) also counts the truck, on which trailers do not depend
    stable = stable_radius(world, agent, lane)
    rows[m.OWN_TRAILER_RADIUS] = math.sqrt(max(stable * stable - truck * truck, 0.0))
    circle = CIRCLE_FACTOR * max(rows[m.OWN_TRAILER_RADIUS], rows[m.OWN_TRUCK_RADIUS])
    squares = 0.0
    for unit in range(1, trailers + 1):  # on an endless circle each articulation has a limit value
        length = rows[m.OWN_LENGTHS + unit]
        circle = max(circle, math.sqrt(squares + length * length / (bend * bend)))
        squares += length * length
    rows[m.OWN_CIRCLE_RADIUS] = circle
    # steps are chords of the circle, and the truck heads along the last one
    sine, _ = sincos(0.5 * rows[m.OWN_STEP] / rows[m.OWN_CIRCLE_RADIUS])
    rear = 0.5 * rows[m.OWN_STEP] / sine
    rows[m.OWN_REAR_RADIUS] = rear
    rows[m.OWN_FRONT_RADIUS] = math.sqrt(rear * rear + truck * truck + 2.0 * rear * truck * sine)
    _sense_step(rows)


@rare_kernel
def _sense_step(rows):
    """Write the largest distance of a step, and the largest distance from its straight ways.

    Tight turns bend joints up to their limit at the steps, and by little more between them. The
    chain must not bend by more than 90 degrees then (docs/safety.md).
    """
    trailers, shortest = int(rows[m.OWN_TRAILERS]), rows[m.OWN_LENGTHS]
    for unit in range(1, trailers + 1):
        shortest = min(shortest, rows[m.OWN_LENGTHS + unit])
    rows[m.OWN_SAG] = sag(rows[m.OWN_STEP], rows[m.OWN_STEERING_TANGENT], shortest)
    quickest = max(1.0 / shortest, rows[m.OWN_STEERING_TANGENT] / rows[m.OWN_LENGTHS])
    bend = _EXTRA_BEND * (rows[m.OWN_STEP] * quickest) ** 2
    rows[m.OWN_TIGHT] = 1.0 if 0.5 * rows[m.OWN_FOLD_TURN] >= 0.5 * math.pi + bend else 0.0
    rows[m.OWN_STRIDE] = stride(rows[m.OWN_STEP], rows[m.OWN_STEERING_TANGENT], shortest, trailers)


@kernel
def sag(step, steepest, shortest):
    """Return the largest distance [m] of the axles of rolling wheels from straight lines in a step.

    The simulator turns the truck first and then moves it. Wheels do both at once. The equation and
    its proof are in docs/safety.md under "Between steps".

    Args:
        step: Distance that the truck's rear axle drives in a step [m].
        steepest: Tangent of the maximum steering angle.
        shortest: Length of the shortest unit [m].
    """
    turned = 0.5 * step * step / shortest * max(steepest + 0.25 * steepest * steepest, 1.0)
    return turned + max(step - shortest, 0.0)


@kernel
def stride(step, steepest, shortest, trailers):
    """Return the largest distance [m] that an axle moves in a step.

    It is that of the front axle or that of the last one.

    Args:
        step: Distance that the truck's rear axle drives in a step [m].
        steepest: Tangent of the maximum steering angle.
        shortest: Length of the shortest unit [m].
        trailers: Number of trailers.
    """
    front = math.sqrt(1.0 + steepest * steepest * (1.0 + step / shortest))
    return step * max(front, 1.0 + _SWING * trailers * step / shortest)


@rare_kernel
def sense_joints(rows, world, agent, lane):
    """Write cosine and sine of every articulation."""
    for joint in range(1, num_trailers(world, agent, lane) + 1):
        cosine, sine = articulation_direction(world, agent, joint, lane)
        rows[m.OWN_JOINTS + 2 * joint - 2], rows[m.OWN_JOINTS + 2 * joint - 1] = cosine, sine


@kernel
def is_due(rows, period):
    """Return whether this is the HAV's step for an action that recurs every ``period`` steps.

    HAVs with consecutive numbers have their turns in consecutive steps.
    """
    return (int(rows[m.OWN_RANDOM_KEY + 2]) + int(rows[m.OWN_NUMBER])) % period == 0


@kernel
def sensed_goal(rows):
    """Return the goal: forward [m], left [m], heading relative to the truck's [rad]."""
    return rows[m.OWN_GOAL], rows[m.OWN_GOAL + 1], rows[m.OWN_GOAL + 2]


@kernel
def hits_goal(policy, dx, dy, turn, share):
    """Return whether a goal is hit, with the tolerances times ``share``.

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
