"""This module reports the results of a search for readings: figures, and the paper's claims."""

from collections.abc import Iterator

from baselines.experiments.paper_claims import evading_in_misses, fingerprints
from baselines.experiments.published import PAPER_SIZES, PUBLISHED, counting
from baselines.experiments.readings import Reading, scenario_of_reading
from baselines.experiments.search import Scored, rollout_of
from baselines.replay.trajectory import Trajectory, record_trajectory

_RECORDED = 100  # number of pairs whose states are inspected one by one


def names_of(found: list[Scored]) -> list[str]:
    """Return the names of the readings of the last rounds, in the order of their numbers."""
    return list(dict.fromkeys(one.reading.name for one in found if one.round == "full"))


def show_found(found: list[Scored]) -> list[list[str]]:
    """Return rows of text: the numbered readings of the last rounds, figures in percent."""
    names = names_of(found)
    head = ["reading", "round", "seed", *(f"{p.key} [%]" for p in PUBLISHED), "chi2", "few"]
    theirs = [f"{100 * p.events / p.size:.2f}" for p in PUBLISHED]
    rows = [head, ["the paper", "", "", *theirs, "", ""]]
    for one in found:
        if one.round in ("full", "confirm"):
            shares = [f"{100 * one.near.shares[p.key]:.2f}" for p in PUBLISHED]
            ends = [f"{one.near.chi2:.1f}", f"{one.near.few:.1f}"]
            rows.append(
                [str(names.index(one.reading.name) + 1), one.round, str(one.seed), *shares, *ends]
            )
    return rows


def compare_words(found: list[Scored], threads: int | None = None) -> list[list[str]]:
    """Return rows of text: the paper's claims in words, and the confirmed readings' pairs.

    Args:
        found: All measurements of ``search``.
        threads: Number of threads.
    """
    picks: dict[str, Scored] = {}
    for one in found:
        if one.round == "confirm":
            picks.setdefault(one.reading.name, one)
    columns = []
    for number, one in enumerate(picks.values(), 1):
        single, pair = (
            counting(
                rollout_of(one.reading, size, one.seed, one.experiments, threads),
                one.reading.jackknifed,
            )
            for size in PAPER_SIZES
        )
        rows = [[name, claim] for name, _, claim in fingerprints(single, pair)[1:]]
        evading = evading_in_misses(_record_pairs(one.reading, one.seed), one.reading.task)
        rows.append([f"close misses in which a HAV evades (none), {_RECORDED} pairs", evading])
        columns.append([["", f"reading {number}, seed {one.seed}"], *rows])
    names = [name for name, _ in columns[0]]
    return [[name, *(column[k][1] for column in columns)] for k, name in enumerate(names)]


def _record_pairs(reading: Reading, seed: int) -> Iterator[Trajectory]:
    models = reading.policy, scenario_of_reading(reading, "pair")
    for episode in range(_RECORDED):
        yield record_trajectory(*models, seed, episode, reading.task, reading.vehicle)
