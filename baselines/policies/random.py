"""This module is a policy of random actions, the floor that every policy must beat."""

from typing import NamedTuple

from hav_env.maths.random_numbers import uniform
from hav_env.models.quantities import Steps
from hav_env.policies.interface import act
from hav_env.world.sensing import episode_key, limits


class Random(NamedTuple):
    """Draw speed and steering evenly from what the HAV can do, anew at intervals."""

    hold: Steps = 1
    """For how many steps an action is held."""


@act.register(Random)
def act_randomly(policy, memory, world, agent, lane):
    """Draw an action; the same episode and step give the same one."""
    speed_max, steering_max, _ = limits(world, agent, lane)
    seed, episode, step = episode_key(world, lane)
    stream, draw = agent + 1, 2 * (step // policy.hold)  # stream 0 is the scenario's
    speed = speed_max * uniform(seed, episode, stream, draw)
    return speed, steering_max * (2.0 * uniform(seed, episode, stream, draw + 1) - 1.0)
