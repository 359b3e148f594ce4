"""This module begins episodes of learners on a stage, compiled, with what is seen at first.

Worlds that begin are scattered among thousands, and every number of a world lies far from the next.
So they begin side by side on a small stage, as lanes of whole vectors, and are copied from there.
"""

from typing import NamedTuple

import numpy as np

from hav_env.compiled import VECTOR, entry, kernel, lanes_from, take
from hav_env.mdp.advance import observe_block
from hav_env.mdp.buffers import Buffers, Outcome, allocate_buffers, outcome_layout
from hav_env.simulator.batch import Batch, worlds_for
from hav_env.simulator.beginning import begin, copy_rows, put_worlds
from hav_env.world.arrays import EPISODE, SEED, World
from hav_env.world.lanes import LANES, block_of


class Stage(NamedTuple):
    """Worlds in which episodes begin, the same number for each thread, and what is seen there."""

    lanes: int
    """Number of worlds for one thread."""
    worlds: World
    buffers: Buffers
    outcome: Outcome


def allocate_stage(
    batch: Batch, threads: int, sizes: tuple[int, int, int, int], numbers: int
) -> Stage:
    """Return a stage.

    Args:
        batch: the worlds in which episodes will begin.
        threads: how many begin them.
        sizes: of the buffers, N, C, T and D, see ``allocate_buffers``.
        numbers: K, how many are reported of a HAV.
    """
    lanes = min(batch.num_worlds, max(1, min(VECTOR, LANES // batch.scenario.num_havs)))
    size = lanes * threads
    _, controlled, _, columns = sizes
    layout = outcome_layout(size, controlled, columns, numbers)
    return Stage(
        lanes,
        worlds_for(batch.scenario, batch.task, batch.vehicle, size),
        allocate_buffers(size, *sizes, threads),
        Outcome(*(np.zeros(shape, kind) for shape, kind in layout)),
    )


@entry
def begin_episodes(
    first,
    last,
    scenario,
    task,
    observation,
    worlds,
    buffers,
    outcome,
    stage,
    parts_taken,
    places,
    seeds,
    episodes,
    placed,
):
    """Begin episodes in a range of those worlds that are to begin, and write what is seen there.

    Args:
        first: index into ``places`` of the first one.
        last: index of the one after the last.
        scenario: who starts where.
        task: the rules.
        observation: settled for the number of HAVs.
        worlds: the arrays of all worlds.
        buffers: of all worlds.
        outcome: of all worlds.
        stage: a ``Stage``.
        parts_taken: (1,) how many of its parts threads have taken, zero at first.
        places: (B,) the worlds that are to begin.
        seeds: (W,) of the episodes of all worlds.
        episodes: (W,) their numbers.
        placed: (B,) bool, to be written: whether the scenario found room for the HAVs.
    """
    part = take(parts_taken) if first < last else 0
    on_stage = part * stage.lanes
    for start in range(first, last, stage.lanes):
        count = min(stage.lanes, last - start)
        block = block_of(stage.worlds, on_stage, count, worlds.units)
        for lane in range(count):
            block.state.clock[SEED, lane] = seeds[places[start + lane]]
            block.state.clock[EPISODE, lane] = episodes[places[start + lane]]
        begin(scenario, task, block, placed[start:])
        put_worlds(block, worlds, places[start:])
        observe_block(observation, block, stage.buffers, on_stage, part, stage.outcome)
        _put_outcome(stage, on_stage, count, buffers, outcome, places[start:])


@kernel
def _put_outcome(stage, on_stage, lanes, buffers, outcome, places):
    """Copy what is seen in worlds of the stage to their places; nothing has been returned yet."""
    seen, kept = stage.outcome, stage.buffers
    copy_rows(lanes_from(kept.remaining, on_stage), buffers.remaining, places, lanes)
    copy_rows(lanes_from(kept.returns, on_stage), buffers.returns, places, lanes)
    copy_rows(lanes_from(seen.info, on_stage), outcome.info, places, lanes)
    copy_rows(lanes_from(seen.reward, on_stage), outcome.reward, places, lanes)
    copy_rows(lanes_from(seen.terminated, on_stage), outcome.terminated, places, lanes)
    copy_rows(lanes_from(seen.truncated, on_stage), outcome.truncated, places, lanes)
    for lane in range(lanes):
        for agent in range(seen.observation.shape[1]):
            for column in range(seen.observation.shape[2]):
                number = seen.observation[on_stage + lane, agent, column]
                outcome.observation[places[lane], agent, column] = number
