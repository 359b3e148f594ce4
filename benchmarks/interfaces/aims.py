"""This module compares the measured speed of the environments with the aims."""

from collections.abc import Callable
from typing import NamedTuple

from benchmarks.interfaces.faces import (
    ENDS,
    FEW_WORLDS,
    HAVS,
    IN_SINGLE,
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
FAST = "vector in single precision"


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


def best_vector(rates: Rates, name: str, max_steps: int | None) -> float | None:
    """Return the rate of a vector environment on 2 threads."""
    kind = name, 2, max_steps
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
    usual = {NAVIGATION: 5.0, BICYCLE: 50.0, VMAS_SPREAD: 1.0}
    fast = {NAVIGATION: 7.0, VMAS_SPREAD: 1.4}
    aims = _vector_aims(rates, "vector", SWARM, 5, usual)
    aims += _vector_aims(rates, FAST, SWARM + ENDS + IN_SINGLE, 13, fast)
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


def _vector_aims(
    rates: Rates, what: str, name: str, millions: int, over_peers: dict[str, float]
) -> list[Aim]:
    """Return the aims of a vector environment: its rate, its ratios to peers, short episodes."""
    rate, short = best_vector(rates, name, None), best_vector(rates, name, SHORT)
    aims = [Aim(what, f">= {millions} M/s", 1e6 * millions, None, rate, short, "/s")]
    for task, least in over_peers.items():
        peer = best_peer(rates, task)
        ratios = ratio(rate, peer), ratio(short, peer)
        aims.append(Aim(f"{what} : {task}", f">= {least:g}", least, None, *ratios))
    brief = f"{what}, short episodes : long"
    return [*aims, Aim(brief, ">= 0.85", 0.85, None, ratio(short, rate))]


def ratio(one: float | None, other: float | None) -> float | None:
    """Return one over the other; None if one is missing."""
    return one / other if one and other else None
