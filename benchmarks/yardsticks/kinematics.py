"""This module measures the kinematics alone: HAVs that move without policy or records."""

import time

import numpy as np

from hav_env import Batch, OnAxle, RandomFleet, RandomPoses
from hav_env.compiled import entry
from hav_env.vehicles import move
from hav_env.world.lanes import LANES

_DT = 0.2  # [s]
_BLOCKS = 16  # blocks of worlds, sorted by trailers, one after another as in a rollout


@entry
def drive_straight_on(first, last, vehicle, num_steps, worlds):
    """Move the HAV of every lane by a number of steps."""
    for _ in range(first, last):
        for _ in range(num_steps):
            move(vehicle, _DT, worlds, 0)


def kinematics_rate(trailers: int | None, num_steps: int = 2_000) -> float:
    """Return HAV-steps/s of single HAVs on one thread.

    Args:
        trailers: Trailers of every HAV; None for the paper's mix.
        num_steps: Steps of each block of worlds.
    """
    fixed = {} if trailers is None else {"min_trailers": trailers, "max_trailers": trailers}
    batch = Batch(RandomPoses(fleet=RandomFleet(**fixed)), LANES * _BLOCKS)
    batch.reset(0)
    counts = batch.worlds.fleet.num_trailers[0]
    seconds = 0.0
    for places in np.argsort(counts, kind="stable").reshape(_BLOCKS, LANES):
        block = Batch(batch.scenario, LANES)
        block.reset(0, places)
        block.worlds.state.speed[:] = 1.0
        block.worlds.state.steering[:] = 0.02
        worlds = block.worlds._replace(units=int(counts[places].max()) + 1)
        drive_straight_on(1, OnAxle(), 1, worlds, threads=1)  # compile
        start = time.perf_counter()
        drive_straight_on(1, OnAxle(), num_steps, worlds, threads=1)
        seconds += time.perf_counter() - start
    return LANES * _BLOCKS * num_steps / seconds
