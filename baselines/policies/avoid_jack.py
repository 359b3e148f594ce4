"""This module is AVOID-JACK, the paper's policy: goal attraction, jackknife repulsion, evasion."""

import math
from typing import NamedTuple

import numpy as np

from baselines.policies.dubins_pursuit import goal_attraction
from hav_env.compiled import kernel
from hav_env.maths.elementary import atan2, exp, sincos
from hav_env.maths.geometry import clip
from hav_env.models.quantities import (
    Articulation,
    Coefficient,
    Distance,
    Duration,
    Factor,
    Release,
    Share,
)
from hav_env.policies.interface import (
    act_lanes,
    check_parameters,
    evaded,
    joint_weights,
    memory_size,
)
from hav_env.world.sensing import (
    articulation_direction,
    limits,
    neighbor_footprint,
    neighbor_id,
    neighbor_length,
    neighbor_point,
    neighbor_point_distance,
    num_neighbors,
    num_obstacles,
    num_trailers,
    obstacle_point,
    own_footprint,
    steering_direction,
    unit_length,
)


class AvoidJack(NamedTuple):
    """The paper's reference policy, section IV. Its open choices are named here."""

    b: Coefficient = 0.5
    """Offset of the jackknife weight 1 + tanh(b - c cos(articulation)), eq.
    (jackknife-weigt-func)."""
    c: Coefficient = 2.0
    """Slope of the jackknife weight."""
    beta: Articulation = math.radians(75.0)
    """Articulation threshold [rad] of eq. (vmax), which bounds the speed; the paper's fleets may
    always drive their 1 m/s."""
    dt: Duration = 0.2
    """Reaction time [s] of eq. (vmax): the duration of a step, ``Task.dt``."""
    close_factor: Factor = 3.5
    """"Close to goal" means within this many truck lengths. The paper leaves it open; 3.5 fits its
    goals and jackknifes of single HAVs (docs/reproduction.md)."""
    straight_below: Distance = 1e-3
    """A turn at the start of the Dubins path shorter than this counts as none [m]. The paper
    says nothing of it; rounding makes some threshold necessary."""
    evasion_truck_share: Factor = 0.0
    """A HAV evades when the distance of the trucks falls below the collision distance d_ih plus
    this share of both trucks' lengths. The paper names d_ih alone. A HAV out of sensing range is
    not evaded: a wide circle may need a larger ``Task.sensing_range``."""
    evasion_center: Share = 0.0
    """Which points of both trucks that distance is between: this share of the truck's length ahead
    of its rear axle. The text says the rear axle (0); 0.5, the truck's centre, with half of the
    truck's length in the distance makes circles that hold the whole HAV."""
    evasion_from_center: bool = False
    """Evade from that point of the other truck to the same one of the own truck. The text goes
    from rear axle to rear axle. It makes no difference where ``evasion_center`` is 0."""
    evasion_clipped: bool = False
    """Cut the direction of evasion to the steering limit before the jackknife repulsion is added;
    goal attraction is within the limit by itself. The text cuts the sum alone. Cut, hardly any HAV
    with fewer than four trailers jackknifes, as the text says."""
    evasion_release: Release = 1.0
    """Evasion ends when the distance exceeds this many times the distance at which it starts. The
    paper leaves the end open; 1 is the least that its text needs. A HAV out of sensing range is
    no longer evaded: a larger factor may need a larger ``Task.sensing_range``."""
    keep_first: bool = True
    """Of several HAVs that are too near, evade the one detected first until it is left behind;
    otherwise the one whose circle is entered deepest. The paper gives priority to "the first
    detected HAV that initiates evasion"; of those detected in one step, it is the deepest."""

    obstacle_factor: Factor = 2.0
    """Collision distance of obstacles, in lengths of the truck. The paper models obstacles as point
    masses with a defined collision distance, and tries none. The point is the nearest one to the
    truck's rear axle. It is evaded before any HAV."""


_TINY = 1e-12  # m, keeps the direction away from a HAV at the same place finite
# What a HAV remembers: 1 + the number of the HAV being evaded, 0 for none; and while it decides:
# the goal vector or the one away from that HAV; the sum of the jackknife weights.
EVADED, VECTOR_FORWARD, VECTOR_LEFT, WEIGHT = range(4)


@check_parameters.register
def _(policy: AvoidJack, scenario) -> None:
    limit = scenario.articulation_max
    if not policy.beta < limit:  # eq. (vmax) would allow no speed
        raise ValueError(f"policy beta is {policy.beta}, but must be below {limit:.6g}")


@memory_size.register
def _(policy: AvoidJack) -> int:
    return 4  # EVADED .. WEIGHT


@joint_weights.register
def _(policy: AvoidJack, cosine):
    return 1.0 + np.tanh(policy.b - policy.c * cosine)


@evaded.register(AvoidJack)
def evaded_by_avoid_jack(policy, memory, agent, lane):
    """Return the number of the HAV being evaded."""
    return int(memory[agent, EVADED, lane]) - 1


@act_lanes.register(AvoidJack)
def avoid_jack(policy, memory, world, agent, speed, steering):
    """Add goal attraction (or evasion) and jackknife repulsion, eqs. (jackknife-vector-...)."""
    _attract(policy, memory, world, agent)
    if speed.shape[0] > 1:
        for lane in range(world.lanes):
            if not world.state.waiting[agent, lane]:
                _evade(policy, memory, world, agent, lane)
    _evade_obstacles(policy, memory, world, agent)
    _add_weights(policy, memory, world, agent)
    for lane in range(world.lanes):
        weight = memory[agent, WEIGHT, lane]
        cosine, sine = articulation_direction(world, agent, 1, lane)
        forward = memory[agent, VECTOR_FORWARD, lane] + weight * cosine
        left = memory[agent, VECTOR_LEFT, lane] + weight * sine
        speed_max, steering_max, articulation_max = limits(world, agent, lane)
        cosine, sine = steering_direction(world, agent, lane)
        safe = safe_speed(
            policy.dt,
            unit_length(world, agent, 0, lane),
            unit_length(world, agent, 1, lane),
            sine / cosine,
            articulation_max,
            policy.beta,
        )
        speed[agent, lane] = min(speed_max, safe)
        steering[agent, lane] = clip(atan2(left, forward), -steering_max, steering_max)


@kernel
def _attract(policy, memory, world, agent):
    """Set the goal vector m^g, Algorithm (goal_attraction)."""
    for lane in range(world.lanes):
        side = goal_attraction(policy.close_factor, policy.straight_below, world, agent, lane)
        cosine, sine = steering_direction(world, agent, lane)
        memory[agent, VECTOR_FORWARD, lane] = 1.0 if side == 0.0 else cosine
        memory[agent, VECTOR_LEFT, lane] = side * sine


@kernel
def _evade(policy, memory, world, agent, lane):
    """Replace the goal vector by one away from the HAV to be evaded, where there is one."""
    evaded = choose_evaded(policy, memory, world, agent, lane)
    if evaded >= 0:
        share = policy.evasion_center if policy.evasion_from_center else 0.0
        forward, left = neighbor_point(world, agent, evaded, share, lane)
        _turn_away(policy, memory, world, agent, forward, left, lane)


@kernel
def _evade_obstacles(policy, memory, world, agent):
    """Replace the vector by one away from the nearest obstacle, where one is too near."""
    for lane in range(world.lanes):
        distance = policy.obstacle_factor * unit_length(world, agent, 0, lane)
        least, nearest_forward, nearest_left = distance * distance, 0.0, 0.0
        for k in range(num_obstacles(world, agent, lane)):
            forward, left = obstacle_point(world, agent, k, lane)
            squared = forward * forward + left * left
            if squared < least:
                least, nearest_forward, nearest_left = squared, forward, left
        if least < distance * distance:
            _turn_away(policy, memory, world, agent, nearest_forward, nearest_left, lane)


@kernel
def _turn_away(policy, memory, world, agent, forward, left, lane):
    """Replace the goal vector by one away from a point: forward [m], left [m]."""
    distance = max(math.sqrt(forward * forward + left * left), _TINY)
    ahead, aside = -forward / distance, -left / distance
    cosine, sine = steering_direction(world, agent, lane)
    if policy.evasion_clipped and ahead < cosine:
        ahead, aside = cosine, sine if aside >= 0.0 else -sine
    memory[agent, VECTOR_FORWARD, lane] = ahead
    memory[agent, VECTOR_LEFT, lane] = aside


@kernel
def _add_weights(policy, memory, world, agent):
    """Sum the jackknife weights over all joints."""
    weights = memory[agent, WEIGHT]
    for lane in range(world.lanes):
        weights[lane] = 0.0
    for joint in range(1, world.units):
        for lane in range(world.lanes):
            cosine, _ = articulation_direction(world, agent, joint, lane)
            weight = jackknife_weight(policy, cosine)
            weights[lane] += weight if joint <= num_trailers(world, agent, lane) else 0.0


@kernel
def jackknife_weight(policy, cosine):
    """Return 1 + tanh(b - c cos(articulation)), eq. (jackknife-weigt-func).

    Written as 2 / (1 + exp(-2 z)), which is the same and takes one exponential.
    """
    return 2.0 / (1.0 + exp(2.0 * (policy.c * cosine - policy.b)))


@kernel
def safe_speed(dt, truck, trailer, steering_tangent, articulation_max, beta):
    """Return v_max [m/s], eq. (vmax).

    No faster can the first trailer's articulation get from the threshold past its limit in a step.

    Args:
        dt: duration of a step [s].
        truck: length l^0 of the truck [m].
        trailer: length l^1 of the first trailer [m].
        steering_tangent: tan(phi^max) of the largest steering angle.
        articulation_max: limit delta^max of the articulation [rad].
        beta: threshold of the articulation [rad].
    """
    sine, _ = sincos(beta)
    rate = abs(sine / trailer + steering_tangent / truck)
    return (articulation_max - beta) / (dt * rate)


@kernel
def choose_evaded(policy, memory, world, agent, lane):
    """Return which neighbour to evade, -1 for none, and remember the HAV."""
    before, chosen, deepest = memory[agent, EVADED, lane] - 1.0, -1, 0.0
    for k in range(num_neighbors(world, agent, lane)):
        start = own_footprint(world, agent, lane) + neighbor_footprint(world, agent, k, lane)
        trucks = unit_length(world, agent, 0, lane) + neighbor_length(world, agent, k, 0, lane)
        start += policy.evasion_truck_share * trucks
        known = neighbor_id(world, agent, k, lane) == before
        depth = start - neighbor_point_distance(world, agent, k, policy.evasion_center, lane)
        if known and depth >= start * (1.0 - policy.evasion_release):
            if policy.keep_first:
                chosen = k
                break
            depth = max(depth, 0.0)
        if depth >= deepest:
            chosen, deepest = k, depth
    number = 0.0 if chosen < 0 else neighbor_id(world, agent, chosen, lane) + 1.0
    memory[agent, EVADED, lane] = number
    return chosen
