"""This module is AVOID-JACK, the paper's policy: goal attraction, jackknife repulsion, evasion."""

import math
from typing import NamedTuple

import numpy as np

from baselines.policies.dubins_pursuit import goal_attraction, steering_along
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
    Speed,
)
from hav_env.policies.checks import check_parameters
from hav_env.policies.interface import act_lanes, evaded, joint_weights, memory_size
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
    route_ahead,
    steering_direction,
    unit_length,
)


class AvoidJack(NamedTuple):
    """The paper's reference policy, section IV. It names the paper's open choices."""

    b: Coefficient = 0.5
    """Offset of the jackknife weight 1 + tanh(b - c cos(articulation)), eq. (15)."""
    c: Coefficient = 2.0
    """Slope of the jackknife weight."""
    beta: Articulation = math.radians(75.0)
    """Articulation threshold [rad] of eq. (16), which bounds the speed; the paper's fleets may
    always drive their 1 m/s."""
    dt: Duration = 0.2
    """Reaction time [s] of eq. (16): the duration of a step, ``Task.dt``."""
    close_factor: Factor = 3.5
    """Distance in truck lengths that counts as "close to goal". The paper leaves it open; 3.5 fits
    the paper's goals and jackknifes of single HAVs (docs/reproduction.md).
    """
    straight_below: Distance = 1e-3
    """Length [m] below which the turn at the start of a Dubins path counts as none. The paper does
    not state it; rounding makes a threshold necessary.
    """
    evasion_truck_share: Factor = 0.0
    """A HAV evades if the distance of the trucks is below the collision distance d_ih plus this
    share of both trucks' lengths. The paper names d_ih alone. A HAV does not evade others out of
    sensing range: a wide circle may need a larger ``Task.sensing_range``.
    """
    evasion_center: Share = 0.0
    """Points of both trucks between which that distance is measured, as a share of the truck's
    length ahead of its rear axle. The text states the rear axle (0). The truck's centre (0.5), with
    half of the truck's length in the distance, makes circles that cover the whole HAV.
    """
    evasion_from_center: bool = False
    """Whether to evade from that point of the other truck to the same point of the own truck. The
    text uses the rear axles. It has no effect if ``evasion_center`` is 0.
    """
    evasion_clipped: bool = False
    """Whether to clip the direction of evasion to the steering limit before the jackknife repulsion
    is added; goal attraction is always within the limit. The text clips the sum only. With
    clipping, hardly any HAV with fewer than four trailers jackknifes, as the text states.
    """
    evasion_release: Release = 1.0
    """Evasion ends when the distance exceeds this many times the distance at which it starts. The
    paper leaves the end open; 1 is the least value that its text allows. A HAV stops evading others
    that leave sensing range: a larger factor may need a larger ``Task.sensing_range``.
    """
    keep_first: bool = True
    """Whether to evade the HAV detected first until it is left behind, if several are too near;
    otherwise the one whose circle is entered deepest. The paper gives priority to "the first
    detected HAV that initiates evasion"; among those detected in one step, it is the deepest.
    """

    obstacle_factor: Factor = 2.0
    """Collision distance of obstacles [truck lengths]. The paper models obstacles as point masses
    with a defined collision distance, and tests none. The point is the one nearest to the truck's
    rear axle. A HAV evades it before any HAV, and not at all on a route of the guidance.
    """
    guided_speed: Speed = 1.5
    """Largest speed on a route of the guidance [m/s]. Real wheels take time to turn: at full speed
    a truck would miss the bends. The paper's fleets drive 1 m/s.
    """
    guided_pull: Factor = 4.0
    """Length of the goal vector on a route of the guidance; elsewhere it is 1. Against a vector of
    length 1, the jackknife repulsion keeps trucks from circles that their trailers can follow.
    """


_TINY = 1e-12  # m, keeps the direction away from a HAV at the same position finite
# Memory of a HAV: 1 + the index of the HAV that it evades, 0 for none; during a decision the goal
# vector, or the vector away from that HAV, and the sum of the jackknife weights.
EVADED, VECTOR_FORWARD, VECTOR_LEFT, WEIGHT = range(4)


@check_parameters.register
def _(policy: AvoidJack, scenario) -> None:
    limit = scenario.articulation_max
    if not policy.beta < limit:  # eq. (16) would allow no speed
        rule = f"must be below {limit:.6g}, the least limit of the vehicles' articulations"
        advice = f"in the paper it is 5/6 of the limit, here {5 / 6 * limit:.4g}"
        raise ValueError(f"policy beta is {policy.beta}, but {rule}: {advice}")


@memory_size.register
def _(policy: AvoidJack) -> int:
    return 4  # EVADED .. WEIGHT


@joint_weights.register
def _(policy: AvoidJack, cosine):
    return 1.0 + np.tanh(policy.b - policy.c * cosine)


@evaded.register(AvoidJack)
def evaded_by_avoid_jack(policy, memory, agent, lane):
    """Return the index of the HAV that is being evaded, NEVER for none."""
    return int(memory[agent, EVADED, lane]) - 1


@act_lanes.register(AvoidJack)
def avoid_jack(policy, memory, world, agent, speed, steering):
    """Add goal attraction (or evasion) and jackknife repulsion, eqs. (10) and (11)."""
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
        known, _, _, _, _ = route_ahead(world, agent, lane)
        most = policy.guided_speed if known else speed_max
        speed[agent, lane] = min(speed_max, safe, most)
        steering[agent, lane] = clip(atan2(left, forward), -steering_max, steering_max)


@kernel
def _attract(policy, memory, world, agent):
    """Set the goal vector m^g, Algorithm (goal_attraction)."""
    for lane in range(world.lanes):
        side = goal_attraction(policy.close_factor, policy.straight_below, world, agent, lane)
        cosine, sine = steering_direction(world, agent, lane)
        memory[agent, VECTOR_FORWARD, lane] = 1.0 if side == 0.0 else cosine
        memory[agent, VECTOR_LEFT, lane] = side * sine
    for lane in range(world.lanes):
        known, _, _, curvature, _ = route_ahead(world, agent, lane)
        if known:
            sine, cosine = sincos(steering_along(world, agent, lane, curvature))
            memory[agent, VECTOR_FORWARD, lane] = policy.guided_pull * cosine
            memory[agent, VECTOR_LEFT, lane] = policy.guided_pull * sine


@kernel
def _evade(policy, memory, world, agent, lane):
    """Replace the goal vector by one away from the HAV to evade, if there is one."""
    evaded = choose_evaded(policy, memory, world, agent, lane)
    if evaded >= 0:
        share = policy.evasion_center if policy.evasion_from_center else 0.0
        forward, left = neighbor_point(world, agent, evaded, share, lane)
        _turn_away(policy, memory, world, agent, forward, left, lane)


@kernel
def _evade_obstacles(policy, memory, world, agent):
    """Replace the vector by one away from the nearest obstacle, if one is too near."""
    for lane in range(world.lanes):
        distance = policy.obstacle_factor * unit_length(world, agent, 0, lane)
        least, nearest_forward, nearest_left = distance * distance, 0.0, 0.0
        for k in range(num_obstacles(world, agent, lane)):
            forward, left = obstacle_point(world, agent, k, lane)
            squared = forward * forward + left * left
            if squared < least:
                least, nearest_forward, nearest_left = squared, forward, left
        known, _, _, _, _ = route_ahead(world, agent, lane)
        if least < distance * distance and not known:
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
    """Return 1 + tanh(b - c cos(articulation)), eq. (15).

    The form 2 / (1 + exp(-2 z)) is equal and needs one exponential.
    """
    return 2.0 / (1.0 + exp(2.0 * (policy.c * cosine - policy.b)))


@kernel
def safe_speed(dt, truck, trailer, steering_tangent, articulation_max, beta):
    """Return v_max [m/s], eq. (16).

    At that speed, the first trailer's articulation cannot pass from the threshold beyond its limit
    in a step.

    Args:
        dt: Duration of a step [s].
        truck: Length l^0 of the truck [m].
        trailer: Length l^1 of the first trailer [m].
        steering_tangent: tan(phi^max), the tangent of the largest steering angle.
        articulation_max: Limit delta^max of the articulation [rad].
        beta: Threshold of the articulation [rad].
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
