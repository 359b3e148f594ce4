"""AVOID-JACK, the paper's policy: goal attraction, jackknife repulsion, mutual evasion."""

import math
from typing import NamedTuple

from baselines.policy import act, check_parameters, memory_size, require_at_least
from baselines.pursuit import goal_attraction
from hav_env.compiled import kernel, world_kernel
from hav_env.geometry import clip
from hav_env.sensing import (
    articulation_cosine,
    articulation_sine,
    limits,
    neighbor_distance,
    neighbor_footprint,
    neighbor_id,
    neighbor_length,
    neighbor_position,
    num_neighbors,
    num_trailers,
    own_footprint,
    steering_direction,
    unit_length,
)


class AvoidJack(NamedTuple):
    """The paper's reference policy, section IV. Its open choices are named here."""

    b: float = 0.5
    """Offset of the jackknife weight 1 + tanh(b - c cos(articulation)), eq.
    (jackknife-weigt-func)."""
    c: float = 2.0
    """Slope of the jackknife weight."""
    beta: float = math.radians(75.0)
    """Articulation threshold [rad] of eq. (vmax), which bounds the speed; the paper's fleets may
    always drive their 1 m/s."""
    dt: float = 0.2
    """Reaction time [s] of eq. (vmax): the duration of a step, ``Task.dt``."""
    close_factor: float = 3.5
    """"Close to goal" means within this many truck lengths. The paper leaves it open; 3.5 fits its
    goals and jackknifes of single HAVs (docs/reproduction.md)."""
    straight_below: float = 1e-3
    """A turn at the start of the Dubins path shorter than this counts as none [m]. The paper
    says nothing of it; rounding makes some threshold necessary."""
    evasion_truck_share: float = 0.0
    """A HAV evades when the distance of the trucks falls below the collision distance d_ih plus
    this share of both trucks' lengths. The paper names d_ih alone."""
    evasion_release: float = 1.0
    """Evasion ends when the distance exceeds this many times the distance at which it starts. The
    paper leaves the end open; 1 is the least that its text needs. A HAV out of sensing range is
    no longer evaded: a larger factor may need a larger ``Task.sensing_range``."""
    keep_first: bool = True
    """Of several HAVs that are too near, evade the one detected first until it is left behind;
    otherwise the one whose circle is entered deepest. The paper gives priority to "the first
    detected HAV that initiates evasion"; of those detected in one step, it is the deepest."""


_TINY = 1e-12  # m, keeps the direction away from a HAV at the same place finite


@check_parameters.register
def _(policy: AvoidJack, scenario) -> None:
    limit = scenario.articulation_max
    if not 0 < policy.beta < limit:  # eq. (vmax) would allow no speed
        raise ValueError(f"policy beta is {policy.beta}, but must be above 0 and below {limit:.6g}")
    if not policy.dt > 0:
        raise ValueError(f"policy dt is {policy.dt}, but must be above 0 s")
    require_at_least(policy, 0.0, ("close_factor", "straight_below", "evasion_truck_share"))
    require_at_least(policy, 1.0, ("evasion_release",))


@memory_size.register
def _(policy: AvoidJack) -> int:
    return 1  # 1 + the number of the HAV being evaded, 0 for none


@act.register(AvoidJack)
def avoid_jack(policy, memory, world, agent):
    """Add goal attraction (or evasion) and jackknife repulsion, eqs. (jackknife-vector-...)."""
    speed_max, steering_max, articulation_max = limits(world, agent)
    cosine, sine = steering_direction(world, agent)
    evaded = choose_evaded(policy, memory, world, agent)
    if evaded >= 0:  # the goal vector is replaced by one away from the other HAV
        forward, left = neighbor_position(world, agent, evaded)
        distance = max(math.sqrt(forward * forward + left * left), _TINY)
        forward, left = -forward / distance, -left / distance
    else:
        side = goal_attraction(policy.close_factor, policy.straight_below, world, agent)
        forward, left = (cosine, side * sine) if side != 0.0 else (1.0, 0.0)
    weight = jackknife_weights(policy, world, agent)
    forward += weight * articulation_cosine(world, agent, 1)
    left += weight * articulation_sine(world, agent, 1)
    safe = safe_speed(
        policy.dt,
        unit_length(world, agent, 0),
        unit_length(world, agent, 1),
        sine / cosine,
        articulation_max,
        policy.beta,
    )
    return min(speed_max, safe), clip(math.atan2(left, forward), -steering_max, steering_max)


@world_kernel
def jackknife_weights(policy, world, agent):
    """Return the sum over all joints of the jackknife weight."""
    weight = 0.0
    for joint in range(1, num_trailers(world, agent) + 1):
        weight += jackknife_weight(policy, articulation_cosine(world, agent, joint))
    return weight


@kernel
def jackknife_weight(policy, cosine):
    """Return 1 + tanh(b - c cos(articulation)), eq. (jackknife-weigt-func).

    Written as 2 / (1 + exp(-2 z)), which is the same and takes one exponential.
    """
    return 2.0 / (1.0 + math.exp(2.0 * (policy.c * cosine - policy.b)))


@kernel
def safe_speed(dt, truck, trailer, steering_tangent, articulation_max, beta):
    """Return v_max [m/s], eq. (vmax): the articulation of the first trailer cannot pass its limit
    within one step from the threshold beta on.

    Args:
        dt: duration of a step [s].
        truck, trailer: l^0 and l^1 [m].
        steering_tangent: tan(phi^max).
        articulation_max, beta: delta^max and the threshold [rad].
    """
    rate = abs(math.sin(beta) / trailer + steering_tangent / truck)
    return (articulation_max - beta) / (dt * rate)


@world_kernel
def choose_evaded(policy, memory, world, agent):
    """Return which neighbour to evade, -1 for none, and remember the HAV."""
    before, chosen, deepest = memory[agent, 0] - 1.0, -1, 0.0
    for k in range(num_neighbors(world, agent)):
        start = own_footprint(world, agent) + neighbor_footprint(world, agent, k)
        trucks = unit_length(world, agent, 0) + neighbor_length(world, agent, k, 0)
        start += policy.evasion_truck_share * trucks
        known = neighbor_id(world, agent, k) == before
        depth = start - neighbor_distance(world, agent, k)
        if known and depth >= start * (1.0 - policy.evasion_release):
            if policy.keep_first:
                chosen = k
                break
            depth = max(depth, 0.0)
        if depth >= deepest:
            chosen, deepest = k, depth
    memory[agent, 0] = 0.0 if chosen < 0 else neighbor_id(world, agent, chosen) + 1.0
    return chosen
