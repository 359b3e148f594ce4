"""The distance of measured figures from the published ones, against formulas written out."""

import math

import numpy as np
import pyarrow as pa
import pytest
from scipy.stats import betabinom

from baselines.experiments.published import PUBLISHED, Closeness, closeness
from hav_env.evaluation.figures import FOLDED_THROUGH


def table_of(size: int, num_havs: int, **columns) -> pa.Table:
    """Return a table of experiments; columns that are not given are false everywhere."""
    rows = size * num_havs
    names = {
        *("jackknifed", "goal_1_hit", "goal_2_hit", "potential_collision", "actual_collision"),
        "folded_through",
    }
    flags = {name: np.zeros(rows, bool) for name in names} | columns
    return pa.table(
        {
            "episode": np.repeat(np.arange(size), num_havs),
            "hav": np.tile(np.arange(num_havs), size),
            "num_trailers": np.full(rows, 5),
        }
        | flags
    )


def the_papers() -> dict[str, pa.Table]:
    """Return tables of the paper's size with its figures; both HAVs of a pair share collisions."""
    tables = {}
    for size, num_havs in (("single", 1), ("pair", 2)):
        columns = {}
        for published in PUBLISHED:
            if published.scenario == size:
                assert published.size == 4_500 * num_havs
                columns[published.figure.column] = np.arange(published.size) < published.events
        tables[size] = table_of(4_500, num_havs, **columns)
    return tables


def test_the_papers_own_figures_are_no_way_off():
    near = closeness(the_papers())
    assert near.chi2 == 0.0
    assert near.shares["pair first goal"] == 7142 / 9000
    assert len(near.deviations) == 8


def test_deviations_are_those_of_two_shares_with_experiments_as_units():
    collided = np.repeat(np.arange(4_500) < 20, 2)  # both of a pair: half as many observations
    near = closeness(the_papers() | {"pair": table_of(4_500, 2, actual_collision=collided)})
    pooled = (40 + 26) / 18_000
    expected = (40 - 26) / 9000 / math.sqrt(pooled * (1 - pooled) * 2 / 4_500)
    assert near.deviations["pair actual collision"] == pytest.approx(expected)
    assert near.chi2 == pytest.approx(sum(z * z for z in near.deviations.values()))


def test_the_sentence_on_few_trailers_is_a_probability():
    """The more of the counted HAVs are short, the less likely is none of 95."""
    pair = table_of(4_500, 2, jackknifed=np.arange(9_000) < 100)
    short = np.where(np.arange(9_000) < 10, 3, 5)
    place = pair.column_names.index("num_trailers")
    few = closeness({"pair": pair.set_column(place, "num_trailers", pa.array(short))}).few
    assert few == pytest.approx(-2.0 * betabinom(95, 10.5, 90.5).logpmf(0))
    none = -2.0 * betabinom(95, 0.5, 100.5).logpmf(0)
    assert closeness({"pair": pair}).few == pytest.approx(none)
    nothing = -2.0 * betabinom(95, 0.5, 0.5).logpmf(0)
    assert closeness({"pair": table_of(10, 2)}).few == pytest.approx(nothing)
    assert none < nothing < few
    assert closeness({"single": the_papers()["single"]}).few == 0.0


def test_another_figure_may_count_as_jackknifed():
    pair = table_of(50, 2, folded_through=np.arange(100) < 7)
    assert closeness({"pair": pair}).shares["pair jackknifed"] == 0.0
    assert closeness({"pair": pair}, FOLDED_THROUGH).shares["pair jackknifed"] == 0.07


def test_it_is_the_same_again_from_json():
    near = closeness(the_papers())
    assert Closeness(*near.plain()) == near
    assert near.score == near.chi2 + near.few
