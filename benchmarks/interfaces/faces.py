"""This module lists the interfaces that learners step, and prepares the measurement of each."""

import importlib.util
from collections.abc import Iterable
from typing import NamedTuple

import gymnasium as gym

import hav_env
from benchmarks.interfaces.clocks import (
    Run,
    prepare_parallel,
    prepare_rows,
    prepare_single,
    prepare_vector,
)
from benchmarks.interfaces.empty import EmptyParallelEnv, make_empty

SWARM, SINGLE, SB3 = "HAVSwarm-v0", "HAVSingle-v0", "HAVVecEnv"
HAVS = {SWARM: 2, SINGLE: 1}
ENDS = ', info="ends"'  # of the names of environments that report only at ends
IN_SINGLE = ', precision="single"'  # and of those whose state is float32
SHORT = 100  # steps of the episodes in which resets count
MPE_STEPS = 25  # of an episode of MPE's simple_spread
FEW_WORLDS = 1_024  # below that, no second thread is woken
PARALLEL, PARALLEL_SHORT = "hav_env.parallel_env()", f"the same, max_cycles={MPE_STEPS}"
PARALLEL_EMPTY = "empty ParallelEnv"
_THREADS = (1, 2)


class Vector(NamedTuple):
    """A row of the table of vector environments, in one of its columns."""

    name: str
    num_worlds: int
    threads: int
    max_steps: int | None = None  # None: the task's 20,000

    @property
    def column(self) -> str:
        """Return the column's title."""
        words = "1 thread" if self.threads == 1 else f"{self.threads} threads"
        return words if self.max_steps is None else f"{words}, max_steps={self.max_steps}"


def vector_rows(num_worlds: Iterable[int], singles: Iterable[int], rows: int) -> list[Vector]:
    """Return the measured rows of vector environments.

    Args:
        num_worlds: Numbers of worlds of the environments of the swarm.
        singles: Numbers of worlds of the environments of a single HAV.
        rows: Number of worlds of the one for Stable-Baselines3, if that is installed.
    """
    counts = [
        (name, w) for name in (SWARM, SWARM + ENDS, SWARM + ENDS + IN_SINGLE) for w in num_worlds
    ]
    counts += [(SINGLE, w) for w in singles]
    if importlib.util.find_spec("stable_baselines3"):
        counts.append((SB3, rows))
    return [
        Vector(name, count, threads, max_steps)
        for name, count in counts
        for max_steps in (None, SHORT)
        for threads in _THREADS
        if threads == 1 or name == SB3 or count >= FEW_WORLDS
    ]


def prepare_vector_row(row: Vector) -> Run:
    """Return the measurement of a vector environment."""
    rules: dict = {} if row.max_steps is None else {"max_steps": row.max_steps}
    if row.name == SB3:
        from hav_env.envs.stable_baselines3 import HAVVecEnv  # noqa: PLC0415  (optional)

        return prepare_rows(HAVVecEnv(row.num_worlds, threads=row.threads, **rules))
    whole = row.name.removesuffix(IN_SINGLE)
    name = whole.removesuffix(ENDS)
    if whole != row.name:
        rules["precision"] = "single"
    if name != whole:
        rules["info"] = "ends"
    env = gym.make_vec(f"hav_env:{name}", num_envs=row.num_worlds, threads=row.threads, **rules)
    return prepare_vector(env, HAVS[name], row.max_steps)


def prepare_singles() -> dict[str, Run]:
    """Return the measurements of environments of one world, and of empty ones."""
    runs = {
        PARALLEL: prepare_parallel(hav_env.parallel_env()),
        PARALLEL_SHORT: prepare_parallel(hav_env.parallel_env(max_cycles=MPE_STEPS)),
        PARALLEL + ENDS: prepare_parallel(hav_env.parallel_env(info="ends")),
        PARALLEL_EMPTY: prepare_parallel(EmptyParallelEnv(hav_env.parallel_env())),
    }
    for name, num_havs in HAVS.items():
        like = f"hav_env:{name}"
        runs[made(name)] = prepare_single(gym.make(like), num_havs)
        runs[made(name) + ENDS] = prepare_single(gym.make(like, info="ends"), num_havs)
        runs[empty(name)] = prepare_single(make_empty(like), num_havs)
    return runs


def made(name: str) -> str:
    """Return the name of the row of an environment that ``gym.make`` makes."""
    return f'gym.make("{name}")'


def empty(name: str) -> str:
    """Return the name of the row of the empty environment."""
    return f"empty, as {name}"
