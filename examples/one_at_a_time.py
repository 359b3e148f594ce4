"""This module is a custom policy for real vehicles at real places: one HAV drives at a time.

Run from this folder, with road networks and the safety filter:
hav-env evaluate one_at_a_time:OneAtATime --scenario gate-2 --vehicle realistic --guidance roads \
    --safety both --task.sensing-range 1000 --task.max-steps 12000 --episodes 10
"""

import math
from typing import NamedTuple

from hav_env import act, broadcast_size, heard, memory_size, sensing

# rows of the memory: the broadcast rank in the queue, the handicap in it [m], whether the HAV went
RANK, HANDICAP, WENT = range(3)


class OneAtATime(NamedTuple):
    """Follow the road when all others stand; the HAV nearest to its goal goes first.

    A HAV that the filter stops has to let others go.
    """

    speed: float = 1.5
    """Speed [m/s]."""
    handicap: float = 30.0
    """Distance [m] by which a HAV falls back in the queue whenever the filter stops it."""


@act.register(OneAtATime)
def drive_in_turn(policy, memory, world, agent, lane):
    """Drive, or wait for the end of another HAV's drive."""
    fastest, steepest, _ = sensing.limits(world, agent, lane)
    known, _, _, curvature, left = sensing.route_ahead(world, agent, lane)
    steering = math.atan(sensing.unit_length(world, agent, 0, lane) * curvature) if known else 0.0
    own = memory[agent, :, lane]
    stands = sensing.own_speed(world, agent, lane) == 0.0
    if stands and own[WENT] > 0.0:
        own[HANDICAP] += policy.handicap
    own[RANK] = left + own[HANDICAP]
    first = True
    for k in range(sensing.num_neighbors(world, agent, lane)):
        other = sensing.neighbor_id(world, agent, k, lane)
        moves = sensing.neighbor_speed(world, agent, k, lane) > 0.0
        rank = heard(memory, world, agent, k, RANK, lane)
        ahead = rank < own[RANK] or (rank == own[RANK] and other < agent)
        first = first and not moves and (sensing.waits(world, other, lane) or not ahead)
    own[WENT] = 1.0 if first or not stands else 0.0
    speed = min(policy.speed, fastest) * own[WENT]
    return speed, min(max(steering, -steepest), steepest)


@memory_size.register
def _(policy: OneAtATime) -> int:
    return WENT + 1


@broadcast_size.register
def _(policy: OneAtATime) -> int:
    return RANK + 1
