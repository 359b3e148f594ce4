"""Policies that exist to be tested with.

They have a folder of their own because compiled loops are cached under the digest of the folders
that policies come from: the tests themselves can then change without a new compilation.
"""

from typing import NamedTuple

from baselines.policy import act, memory_size
from hav_env import sensing


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
    """Stand still and write down all that is sensed."""

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
