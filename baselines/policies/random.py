"""This module is a policy of random actions, the baseline that every policy must beat."""

from typing import NamedTuple

from hav_env.maths.random_numbers import uniform
from hav_env.models.quantities import Steps
from hav_env.policies.interface import act
from hav_env.world.sensing import episode_key, limits


class Random(NamedTuple):
    """Draw speed and steering uniformly from the HAV's limits, anew at intervals."""

    hold: Steps = 1
    """Number of steps for which an action is held."""


@act.register(Random)
def act_randomly(policy, memory, world, agent, lane):
    """Draw an action; it is the same for the same episode and step."""
    speed_max, steering_max, _ = limits(world, agent, lane)
    seed, episode, step = episode_key(world, lane)
    stream, draw = agent + 1, 2 * (step // policy.hold)  # the scenario uses stream 0
    speed = speed_max * uniform(seed, episode, stream, draw)
    return speed, steering_max * (2.0 * uniform(seed, episode, stream, draw + 1) - 1.0)
