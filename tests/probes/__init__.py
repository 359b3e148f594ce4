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
def weave(policy, memory, world, agent):
    memory[agent, 0] += 1.0
    if memory[agent, 0] > memory[agent, 1]:
        memory[agent, 0] = 0.0
        memory[agent, 1] += 1.0
    return 1.0, policy.gain * (1.0 if memory[agent, 1] % 2.0 == 0.0 else -1.0)


class Probe(NamedTuple):
    """Stand still and write down all that is sensed."""

    width: int = 64


NEIGHBOR_COLUMNS = 7


@memory_size.register
def _(policy: Probe) -> int:
    return policy.width


@act.register(Probe)
def probe(policy, memory, world, agent):
    row = memory[agent]
    row[0] = sensing.num_trailers(world, agent)
    row[1] = sensing.unit_length(world, agent, 0)
    row[2] = sensing.stable_radius(world, agent)
    row[3], row[4], row[5] = sensing.limits(world, agent)
    row[6], row[7], row[8] = sensing.goal_pose(world, agent)
    row[9] = sensing.own_footprint(world, agent)
    row[10] = sensing.articulation_cosine(world, agent, 1)
    row[11] = sensing.articulation_sine(world, agent, 1)
    row[12], row[13], row[14] = sensing.episode_key(world)
    row[15] = sensing.num_neighbors(world, agent)
    for k in range(sensing.num_neighbors(world, agent)):
        at = 16 + 7 * k
        row[at] = sensing.neighbor_id(world, agent, k)
        row[at + 1], row[at + 2] = sensing.neighbor_position(world, agent, k)
        row[at + 3] = sensing.neighbor_distance(world, agent, k)
        row[at + 4] = sensing.neighbor_heading(world, agent, k, 1)
        row[at + 5] = sensing.neighbor_footprint(world, agent, k)
        row[at + 6] = sensing.neighbor_length(world, agent, k, 1)
    return 0.0, 0.0
