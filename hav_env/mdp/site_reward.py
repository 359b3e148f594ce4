"""This module has the reward for sites: the default reward and penalties for obstacles."""

from typing import NamedTuple

from hav_env.compiled import kernel
from hav_env.maths.elementary import sqrt
from hav_env.mdp.reward import AT_OBSTACLE, Reward, default_terms, harm_terms, reward_terms
from hav_env.models.quantities import Weight
from hav_env.observation.columns import place_names
from hav_env.world.arrays import NEVER
from hav_env.world.bodies import front_end
from hav_env.world.event_table import obstacle_hit_at
from hav_env.world.obstacles.nearest import nearest_to
from hav_env.world.place.segments import num_segments

_DEFAULT = Reward()
_RANGE = 5.0  # [m], range of the proximity term


class SiteReward(NamedTuple):
    """Weights of the terms among obstacles; all but the last two equal those of ``Reward``."""

    progress: Weight = _DEFAULT.progress
    goal: Weight = _DEFAULT.goal
    jackknife: Weight = _DEFAULT.jackknife
    actual_collision: Weight = _DEFAULT.actual_collision
    potential_collision: Weight = _DEFAULT.potential_collision
    proximity: Weight = _DEFAULT.proximity
    articulation: Weight = _DEFAULT.articulation
    steering: Weight = _DEFAULT.steering
    time: Weight = _DEFAULT.time
    obstacle_collision: Weight = -10.0
    """For the first collision of an episode with an obstacle."""
    obstacle_proximity: Weight = 0.0
    """Per second, times the squared nearness of an obstacle to the middle of the truck's front: 0
    from 5 m on, 1 at contact. Not computed if its weight is 0.
    """


_TERM = place_names(SiteReward._fields)


@reward_terms.register(SiteReward)
def site_terms(reward, duration, world, agent, before, remaining, terms):
    """Compute the terms of ``SiteReward``."""
    default_terms(reward, duration, world, agent, before, remaining, terms)
    for lane in range(world.lanes):
        hit = 1.0 if obstacle_hit_at(world.place, world, agent, lane) != NEVER else 0.0
        terms[_TERM.obstacle_collision, agent, lane] = hit - before[agent, AT_OBSTACLE, lane]
        terms[_TERM.obstacle_proximity, agent, lane] = 0.0
    if reward.obstacle_proximity != 0.0:
        for lane in range(world.lanes):
            nearness = _nearness(world, agent, lane)
            terms[_TERM.obstacle_proximity, agent, lane] = duration * nearness * nearness


@kernel
def _nearness(world, agent, lane):
    """Return the nearness of the nearest obstacle to the truck's front, from 0 to 1."""
    x, y = front_end(world.fleet.bodies, world, agent, lane)
    least = _RANGE * _RANGE
    for number in range(num_segments(world.place, lane)):
        dx, dy = nearest_to(world.place, number, x, y, lane)
        least = min(least, dx * dx + dy * dy)
    return 1.0 - sqrt(least) / _RANGE


@harm_terms.register
def _(reward: SiteReward) -> tuple[str, ...]:
    return *harm_terms(Reward()), "obstacle_collision", "obstacle_proximity"
