"""This module has the paper's published figures, and measures the distance of others from them."""

import math
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa

from hav_env.evaluation.figures import GOAL_HIT, Figure, figure_of_event, figure_of_goal, measure
from hav_env.evaluation.statistics import Interval, standardized_difference, wilson
from hav_env.world.arrays import ACTUAL, JACKKNIFE, POTENTIAL
from hav_env.world.event_table import EVENTS

PAPER_EXPERIMENTS = 4_500  # number of experiments of each size
PAPER_SIZES = ("single", "pair")  # experiments with one HAV, and with two
_FEW_TRAILERS = 4  # no jackknifed HAV of a pair had fewer


class Published(NamedTuple):
    """One figure of the paper, section VI: the number of HAVs that it counts, out of how many."""

    scenario: str
    figure: Figure
    name: str
    """Name in the paper."""
    events: int
    size: int

    @property
    def key(self) -> str:
        """Return the name of the figure in tables."""
        return f"{self.scenario} {self.name}"


JACKKNIFE_FIGURE, _CIRCLES_MET, _COLLISIONS = (
    figure_of_event(EVENTS[row]) for row in (JACKKNIFE, POTENTIAL, ACTUAL)
)
_FIRST_GOAL, _SECOND_GOAL = (figure_of_goal(GOAL_HIT, goal) for goal in (1, 2))
PUBLISHED = (
    Published("single", JACKKNIFE_FIGURE, "jackknifed", 7, 4500),
    Published("single", _FIRST_GOAL, "first goal", 3904, 4500),
    Published("single", _SECOND_GOAL, "second goal", 3754, 4500),
    Published("pair", JACKKNIFE_FIGURE, "jackknifed", 95, 9000),
    Published("pair", _FIRST_GOAL, "first goal", 7142, 9000),
    Published("pair", _SECOND_GOAL, "second goal", 5856, 9000),
    Published("pair", _CIRCLES_MET, "potential collision", 8516, 9000),
    Published("pair", _COLLISIONS, "actual collision", 26, 9000),
)


def published_interval(published: Published, here: Interval) -> Interval:
    """Return a published share with its interval.

    The paper counts HAVs. The dependence between the two HAVs of a pair is taken from ``here``.
    """
    return wilson(published.events, published.size, here.design_effect)


class Closeness(NamedTuple):
    """Distance of measured figures from the published ones."""

    shares: dict[str, float]
    """Share of each figure, by ``Published.key``."""
    deviations: dict[str, float]
    """Standardized difference z of each figure, with experiments as units."""
    few: float
    """-2 ln of the probability that none of the paper's 95 jackknifed HAVs of pairs has fewer than
    four trailers, given the count here; 0 without pairs.
    """

    @property
    def chi2(self) -> float:
        """Return the sum of z^2; for a true reading it is about the number of figures."""
        return sum(z * z for z in self.deviations.values())

    @property
    def score(self) -> float:
        """Return the objective that a search minimises: the figures and that sentence together."""
        return self.chi2 + self.few

    def plain(self) -> list[Any]:
        """Return it as JSON; ``Closeness(*plain)`` restores it."""
        return [self.shares, self.deviations, self.few]


def closeness(tables: dict[str, pa.Table], jackknifed: Figure = JACKKNIFE_FIGURE) -> Closeness:
    """Return the distance of the tables of experiments from the published figures.

    Args:
        tables: Tables by size, "single" and "pair" or one of them; columns as in docs/metrics.md.
        jackknifed: Figure that counts as jackknifed.
    """
    shares, deviations = {}, {}
    for published in PUBLISHED:
        if published.scenario in tables:
            here = measure_published(tables[published.scenario], published, jackknifed)
            shares[published.key] = here.value
            theirs = published_interval(published, here)
            deviations[published.key] = standardized_difference(here, theirs)
    few = _few_trailers(tables["pair"], jackknifed) if "pair" in tables else 0.0
    return Closeness(shares, deviations, few)


def measure_published(table: pa.Table, published: Published, jackknifed: Figure) -> Interval:
    """Return a measured figure, with a given figure counting as jackknifed."""
    return measure(table, jackknifed if published.figure == JACKKNIFE_FIGURE else published.figure)


def counting(table: pa.Table, jackknifed: Figure) -> pa.Table:
    """Return a table in which another figure counts as jackknifed.

    Step and joint remain those of the first articulation beyond the limit.
    """
    place = table.column_names.index(JACKKNIFE_FIGURE.column)
    return table.set_column(place, JACKKNIFE_FIGURE.column, table[jackknifed.column])


def _few_trailers(pair: pa.Table, jackknifed: Figure) -> float:
    """Return ``Closeness.few``: beta-binomial, with Jeffreys' prior of the share of such HAVs."""
    hit = pair[jackknifed.column].to_numpy(zero_copy_only=False).astype(bool)
    short = hit & (pair["num_trailers"].to_numpy() < _FEW_TRAILERS)
    few, more = np.sum(short) + 0.5, np.sum(hit & ~short) + 0.5
    events = next(p.events for p in PUBLISHED if p.key == "pair jackknifed")
    whole = few + more
    log_probability = math.lgamma(more + events) - math.lgamma(more)
    log_probability -= math.lgamma(whole + events) - math.lgamma(whole)
    return -2.0 * log_probability
