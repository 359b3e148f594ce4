"""This module is a custom policy: the Dubins pursuit, slower the more the HAV is bent.

Run from this folder: python -m baselines evaluate avoid_jack slow_down:SlowDown
"""

from typing import NamedTuple

from baselines.policies.dubins_pursuit import goal_attraction
from hav_env.policies.interface import act
from hav_env.world import sensing


class SlowDown(NamedTuple):
    """Pursue the goal with gentler steering while any joint is bent."""

    close_factor: float = 3.5


@act.register(SlowDown)
def slow_down(policy, memory, world, agent, lane):
    """Weigh the steering with the smallest cosine of an articulation."""
    speed, steering_max, _ = sensing.limits(world, agent, lane)
    straightness = 1.0
    for joint in range(1, sensing.num_trailers(world, agent, lane) + 1):
        cosine, _ = sensing.articulation_direction(world, agent, joint, lane)
        straightness = min(straightness, cosine)
    side = goal_attraction(policy.close_factor, 1e-3, world, agent, lane)
    return speed, side * steering_max * max(straightness, 0.0)
