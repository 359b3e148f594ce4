"""This module compares the measured speed of the environments with the aims."""

from collections.abc import Callable
from typing import NamedTuple

from benchmarks.interfaces.faces import (
    FEW_WORLDS,
    HAVS,
    PARALLEL,
    PARALLEL_EMPTY,
    PARALLEL_SHORT,
    SHORT,
    SWARM,
    Vector,
    empty,
    made,
)
from benchmarks.interfaces.peers import BICYCLE, MPE_SPREAD, NAVIGATION, VMAS_SPREAD, Peer

Key = Vector | Peer | str  # of a row: a vector environment, a peer, an environment of one world
Rates = dict[Key, float]  # agent-steps/s


class Aim(NamedTuple):
    """An aim of the environments, and its measurement; None if there is none."""

    what: str
    wanted: str
    least: float | None  # lower bound of the aim
    most: float | None  # upper bound of the aim
    measured: float | None
    often_reset: float | None = None  # measurement with short episodes
    unit: str = ""

    @property
    def reached(self) -> bool | None:
        """Return whether the measurement on the unchanged task reaches the aim."""
        if self.measured is None:
            return None
        high_enough = self.least is None or self.measured >= self.least
        return high_enough and (self.most is None or self.measured <= self.most)


def best(rates: Rates, matches: Callable[[Key], bool]) -> float | None:
    """Return the rate of the fastest of the rows that match; None if there are none."""
    return max((rate for key, rate in rates.items() if matches(key)), default=None)


def best_vector(rates: Rates, max_steps: int | None) -> float | None:
    """Return the rate of the swarm's vector environment on 2 threads."""
    kind = SWARM, 2, max_steps
    return best(
        rates,
        lambda key: (
            isinstance(key, Vector)
            and (key.name, key.threads, key.max_steps) == kind
            and key.num_worlds >= FEW_WORLDS
        ),
    )


def best_peer(rates: Rates, task: str) -> float | None:
    """Return the rate of a task of another simulator."""
    return best(rates, lambda key: isinstance(key, Peer) and key.task == task)


def find_aims(rates: Rates, import_seconds: float) -> list[Aim]:
    """Return the aims beside the measurements."""
    vector, short = best_vector(rates, None), best_vector(rates, SHORT)
    aims = [Aim("vector", ">= 5 M/s, aim 30", 5e6, None, vector, short, "/s")]
    for task, wanted, least in (
        (NAVIGATION, ">= 5", 5.0),
        (BICYCLE, ">= 50", 50.0),
        (VMAS_SPREAD, "> 1", 1.0),
    ):
        peer = best_peer(rates, task)
        aims.append(
            Aim(f"vector : {task}", wanted, least, None, ratio(vector, peer), ratio(short, peer))
        )
    peer, parallel = best_peer(rates, MPE_SPREAD), rates[PARALLEL]
    ratios = ratio(parallel, peer), ratio(rates[PARALLEL_SHORT], peer)
    aims.append(Aim(f"PettingZoo : {MPE_SPREAD}", ">= 5", 5.0, None, *ratios))
    idle = ratio(parallel, rates[PARALLEL_EMPTY])
    aims.append(Aim("PettingZoo : empty", "aim 0.5", 0.5, None, idle))
    for name in HAVS:
        idle = ratio(rates[made(name)], rates[empty(name)])
        aims.append(Aim(f"Gymnasium {name} : empty", ">= 0.5", 0.5, None, idle))
    aims.append(Aim("import hav_env", "< 1 s", None, 1.0, import_seconds, None, " s"))
    return aims


def ratio(one: float | None, other: float | None) -> float | None:
    """Return one over the other; None if one is missing."""
    return one / other if one and other else None
