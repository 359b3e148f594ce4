"""This module has policies, a reward and a loop over lanes that exist to be tested with."""

import math
from typing import NamedTuple

from baselines.policies.avoid_jack import AvoidJack, choose_evaded, jackknife_weight, safe_speed
from baselines.policies.dubins_pursuit import goal_attraction
from hav_env.compiled import entry
from hav_env.maths.elementary import atan2, exp, floor, log, sincos
from hav_env.maths.geometry import clip
from hav_env.mdp.reward import REMAINING, WAITED, reward_terms
from hav_env.policies.interface import act, memory_size
from hav_env.world import sensing


class Weaving(NamedTuple):
    """Steer left and right in turns of a growing number of decisions, counted in memory."""

    gain: float = 0.4


@memory_size.register
def _(policy: Weaving) -> int:
    return 2  # decisions since the last change of sides, how many make the next one


@act.register(Weaving)
def weave(policy, memory, world, agent, lane):
    memory[agent, 0, lane] += 1.0
    if memory[agent, 0, lane] > memory[agent, 1, lane]:
        memory[agent, 0, lane] = 0.0
        memory[agent, 1, lane] += 1.0
    return 1.0, policy.gain * (1.0 if memory[agent, 1, lane] % 2.0 == 0.0 else -1.0)


class Probe(NamedTuple):
    """Stand still and record all sensed quantities."""

    width: int = 64


FIRST_NEIGHBOR, NEIGHBOR_COLUMNS = 18, 7


@memory_size.register
def _(policy: Probe) -> int:
    return policy.width


@act.register(Probe)
def probe(policy, memory, world, agent, lane):
    row = memory[agent, :, lane]
    row[0] = sensing.num_trailers(world, agent, lane)
    row[1] = sensing.unit_length(world, agent, 0, lane)
    row[2] = sensing.stable_radius(world, agent, lane)
    row[3], row[4], row[5] = sensing.limits(world, agent, lane)
    row[6], row[7], row[8] = sensing.goal_pose(world, agent, lane)
    row[9] = sensing.own_footprint(world, agent, lane)
    row[10], row[11] = sensing.articulation_direction(world, agent, 1, lane)
    row[12], row[13], row[14] = sensing.episode_key(world, lane)
    row[15], row[16] = sensing.goal_direction(world, agent, lane)
    row[17] = sensing.num_neighbors(world, agent, lane)
    for k in range(sensing.num_neighbors(world, agent, lane)):
        at = FIRST_NEIGHBOR + NEIGHBOR_COLUMNS * k
        row[at] = sensing.neighbor_id(world, agent, k, lane)
        row[at + 1], row[at + 2] = sensing.neighbor_position(world, agent, k, lane)
        row[at + 3] = sensing.neighbor_distance(world, agent, k, lane)
        row[at + 4] = sensing.neighbor_heading(world, agent, k, 1, lane)
        row[at + 5] = sensing.neighbor_footprint(world, agent, k, lane)
        row[at + 6] = sensing.neighbor_length(world, agent, k, 1, lane)
    return 0.0, 0.0


class OneByOne(NamedTuple):
    """AVOID-JACK written for one HAV, which works lane by lane; ``AvoidJack`` is for many lanes.

    Both call the same functions of single numbers; the tests compare the loops.
    """

    rules: AvoidJack = AvoidJack()


@memory_size.register
def _(policy: OneByOne) -> int:
    return 1  # 1 + the number of the HAV being evaded, 0 for none


@act.register(OneByOne)
def avoid_jack_one_by_one(policy, memory, world, agent, lane):
    rules = policy.rules
    steering_cosine, steering_sine = sensing.steering_direction(world, agent, lane)
    side = goal_attraction(rules.close_factor, rules.straight_below, world, agent, lane)
    forward, left = 1.0, 0.0
    if side != 0.0:
        forward, left = steering_cosine, side * steering_sine
    evaded = choose_evaded(rules, memory, world, agent, lane)
    if evaded >= 0:
        forward, left = sensing.neighbor_position(world, agent, evaded, lane)
        distance = max(math.sqrt(forward * forward + left * left), 1e-12)
        forward, left = -forward / distance, -left / distance
    weight = 0.0
    for joint in range(1, sensing.num_trailers(world, agent, lane) + 1):
        cosine, _ = sensing.articulation_direction(world, agent, joint, lane)
        weight += jackknife_weight(rules, cosine)
    cosine, sine = sensing.articulation_direction(world, agent, 1, lane)
    speed, steering_max, articulation_max = sensing.limits(world, agent, lane)
    safe = safe_speed(
        rules.dt,
        sensing.unit_length(world, agent, 0, lane),
        sensing.unit_length(world, agent, 1, lane),
        steering_sine / steering_cosine,
        articulation_max,
        rules.beta,
    )
    steering = atan2(left + weight * sine, forward + weight * cosine)
    return min(speed, safe), clip(steering, -steering_max, steering_max)


class Watched(NamedTuple):
    """Rewards that report the arguments of their kernel."""

    seconds: float = 1.0
    east: float = 2.0
    remaining: float = -0.5
    was_remaining: float = 0.25
    waited: float = 1.0


@reward_terms.register(Watched)
def watch(reward, duration, world, agent, before, remaining, terms):
    for lane in range(world.lanes):
        terms[0, agent, lane] = duration
        terms[1, agent, lane] = world.state.x[agent, lane]
        terms[2, agent, lane] = remaining[agent, lane]
        terms[3, agent, lane] = before[agent, REMAINING, lane]
        terms[4, agent, lane] = before[agent, WAITED, lane]


SINE, COSINE, ANGLE, POWER, WHOLE, LOGARITHM = range(6)


@entry
def evaluate(first, last, a, b, results):
    """Fill results (6, W), rows SINE .. LOGARITHM, with the functions of a and b (W,)."""
    for w in range(first, last):
        results[SINE, w], results[COSINE, w] = sincos(a[w])
    for w in range(first, last):
        results[ANGLE, w] = atan2(a[w], b[w])
    for w in range(first, last):
        results[POWER, w] = exp(a[w])
    for w in range(first, last):
        results[WHOLE, w] = floor(a[w])
    for w in range(first, last):
        results[LOGARITHM, w] = log(abs(a[w]) + 1.0)
