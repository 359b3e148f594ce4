"""This module begins episodes of learners in a compact stage, compiled, with first observations.

Worlds that begin are scattered among thousands, and the numbers of one world are far apart in
memory. They therefore begin side by side in a small stage, as lanes of whole vectors, and are
copied from there.
"""

import functools
from typing import NamedTuple

import numpy as np

from hav_env.compiled import VECTOR, arguments_of, entry, kernel, lanes_from, loop_kernel, take
from hav_env.mdp.advance import observe_block
from hav_env.mdp.buffers import Buffers, Outcome, allocate_buffers, outcome_layout
from hav_env.simulator.batch import Batch, worlds_for
from hav_env.simulator.beginning import begin, copy_rows, put_worlds
from hav_env.world.arrays import EPISODE, SEED, World
from hav_env.world.lanes import LANES, block_of


class Stage(NamedTuple):
    """Worlds in which episodes begin, the same number for each thread, with their observations."""

    lanes: int
    """Number of worlds per thread."""
    worlds: World
    buffers: Buffers
    outcome: Outcome


def allocate_stage(
    batch: Batch, threads: int, sizes: tuple[int, int, int, int, int], numbers: int
) -> Stage:
    """Return an allocated stage.

    Args:
        batch: Worlds in which episodes will begin.
        threads: Number of threads.
        sizes: Sizes of the buffers, from N to K, see ``allocate_buffers``.
        numbers: K, the number of infos of a HAV.
    """
    lanes = min(batch.num_worlds, max(1, min(VECTOR, LANES // batch.scenario.num_havs)))
    size = lanes * threads
    _, controlled, _, columns, _ = sizes
    layout = outcome_layout(size, controlled, columns, numbers)
    return Stage(
        lanes,
        worlds_for(batch, size),
        allocate_buffers(size, *sizes, threads),
        Outcome(*(np.zeros(shape, kind) for shape, kind in layout)),
    )


@functools.partial(entry, portion=1)  # few worlds begin at a time, and are copied anywhere
def begin_episodes(
    first, last, scenario, held, outcome, parts_taken, places, seeds, episodes, reports, placed
):
    """Begin episodes in a range of those worlds that are to begin, and write their observations.

    Args:
        first: Index of the first world in ``places``.
        last: Index after the last world.
        scenario: Model of fleets, start poses and goal poses.
        held: Rules of the episode, observation settings as ``settle`` returns them, the arrays of
            all worlds, buffers of all worlds, and the stage of all threads.
        outcome: Outcome of all worlds.
        parts_taken: (1,) how many of its parts threads have taken, zero at first.
        places: (B,) indices of the worlds that are to begin.
        seeds: (W,) of the episodes of all worlds.
        episodes: (W,) numbers of the episodes.
        reports: Whether to write the infos.
        placed: (B,) bool, to write: whether the scenario placed the HAVs.
    """
    task, observation, worlds, buffers, stage = arguments_of(held)
    _begin_episodes(
        first,
        last,
        scenario,
        task,
        observation,
        worlds,
        buffers,
        stage,
        outcome,
        parts_taken,
        places,
        seeds,
        episodes,
        reports,
        placed,
    )


@loop_kernel
def _begin_episodes(
    first,
    last,
    scenario,
    task,
    observation,
    worlds,
    buffers,
    stage,
    outcome,
    parts_taken,
    places,
    seeds,
    episodes,
    reports,
    placed,
):
    """Begin episodes, see ``begin_episodes``."""
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
        observe_block(observation, block, stage.buffers, on_stage, part, reports, stage.outcome)
        _put_outcome(stage, on_stage, count, reports, buffers, outcome, places[start:])


@kernel
def _put_outcome(stage, on_stage, lanes, reports, buffers, outcome, places):
    """Copy the first observations of worlds in the stage to their places."""
    seen, kept = stage.outcome, stage.buffers
    copy_rows(lanes_from(kept.remaining, on_stage), buffers.remaining, places, lanes)
    copy_rows(lanes_from(kept.returns, on_stage), buffers.returns, places, lanes)
    if reports:
        copy_rows(lanes_from(seen.info, on_stage), outcome.info, places, lanes)
    copy_rows(lanes_from(seen.reward, on_stage), outcome.reward, places, lanes)
    copy_rows(lanes_from(seen.terminated, on_stage), outcome.terminated, places, lanes)
    copy_rows(lanes_from(seen.truncated, on_stage), outcome.truncated, places, lanes)
    for lane in range(lanes):
        for agent in range(seen.observation.shape[1]):
            for column in range(seen.observation.shape[2]):
                number = seen.observation[on_stage + lane, agent, column]
                outcome.observation[places[lane], agent, column] = number
