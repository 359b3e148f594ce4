"""Cells of a comparison hold their interval; events that are no failures stand in brackets."""

import re

import numpy as np
import pyarrow as pa
import pytest

from baselines.cli.tables import TERMINAL_WIDTH, plain_table
from hav_env.evaluation.comparison import (
    compare,
    compare_differences,
    explain_comparison,
    score,
)

NAMES = ["first", "second"]


def table_of(rng, share, steps, pairs=200):
    """Return the figures' columns of pairs."""
    count = 2 * pairs
    hit = rng.random(count) < share
    columns = {name: np.zeros(count, bool) for name in (
        "jackknifed", "potential_collision", "actual_collision", "folded_through", "goal_2_hit",
    )}  # fmt: skip
    columns["potential_collision"] = rng.random(count) < 0.8
    return pa.table({
        "episode": np.repeat(np.arange(pairs), 2),
        "hav": np.tile([0, 1], pairs),
        "goal_1_hit": hit,
        "goal_1_step": rng.normal(steps, 100.0, count),
        "goal_2_step": rng.normal(2 * steps, 100.0, count),
        "goal_1_length_ratio": rng.normal(1.0, 0.1, count),
        "goal_2_length_ratio": rng.normal(1.0, 0.1, count),
        "largest_articulation": rng.normal(1.0, 0.1, count),
        **columns,
    })  # fmt: skip


@pytest.fixture(scope="module")
def tables():
    rng = np.random.default_rng(3)
    return [table_of(rng, 0.9, 3_000.0), table_of(rng, 0.5, 1_000.0)]


def numbers(cell):
    return [float(text.replace(",", "")) for text in re.findall(r"\d[\d,.]*", cell)]


def test_a_cell_holds_the_interval_of_its_figure(tables):
    cells = compare(NAMES, tables)[1:]
    for row, scores in zip(cells, score(NAMES, tables), strict=True):
        for cell, one in zip(row[1:], scores, strict=True):
            scale = 100 if one.figure.percent else 1
            if "[" in cell:  # the half width would reach beyond what is possible
                assert one.measured.value in (0.0, 1.0)
                continue
            value, half = numbers(cell)[:2]
            rounding = max(0.11 * half, 1.0 if one.figure.steps else 0.0) + 1e-9
            assert value - half <= scale * one.measured.low + rounding
            assert value + half >= scale * one.measured.high - rounding
            assert value == pytest.approx(scale * one.measured.value, abs=rounding)


def test_a_star_says_that_the_difference_excludes_zero(tables):
    for row, scores in zip(compare(NAMES, tables)[1:], score(NAMES, tables), strict=True):
        low, high = scores[1].difference.low, scores[1].difference.high
        assert row[2].endswith(" *") == (not low <= 0 <= high and not scores[0].figure.harmless)
        assert not row[1].endswith("*")
    starred = {row[0] for row in compare(NAMES, tables)[1:] if row[2].endswith("*")}
    assert starred >= {"goal 1 hit", "goal 1 step"}


@pytest.mark.parametrize("episodes", [1, 2, 3, 5])
def test_intervals_of_few_episodes_hold_nothing_impossible(episodes, tables):
    few = [table.slice(0, 2 * episodes) for table in tables]
    for row, scores in zip(compare(NAMES, few)[1:], score(NAMES, few), strict=True):
        most = 100.0 if scores[0].figure.percent else np.inf
        for cell in row[1:]:
            shown = numbers(cell)
            if "[" in cell:
                value, low, high = shown[:3]
                assert 0 <= low <= value <= high <= most
            elif "±" in cell:
                assert shown[0] - shown[1] >= 0
                assert shown[0] + shown[1] <= most
        for one in scores:
            low = one.measured.low
            assert not low < 0 or np.isneginf(low)  # of a single episode nothing is known
        if scores[0].figure.percent and episodes > 1:
            assert scores[1].difference.low >= -1
            assert scores[1].difference.high <= 1


def test_a_share_of_all_or_none_has_an_interval_to_one_side(tables):
    few = [table.slice(0, 20) for table in tables]
    rows = {row[0]: row[1] for row in compare(NAMES, few)}
    low, high = (100 * getattr(score(NAMES, few)[0][0].measured, end) for end in ("low", "high"))
    assert low == 0
    assert rows["jackknifed"] == f"0 [0, {high:.0f}] %"


def test_steps_are_seconds_too(tables):
    (cell,) = (row[1] for row in compare(NAMES, tables, dt=0.5) if row[0] == "goal 1 step")
    steps, _, seconds = numbers(cell)
    assert re.fullmatch(r"[\d,]+ ± [\d,]+ \([\d,]+ s\)", cell)
    assert seconds == pytest.approx(0.5 * steps, abs=1.0)


@pytest.mark.parametrize("pairs", [1, 2, 3, 100, 20_000])
def test_two_policies_fit_a_terminal(pairs):
    """The widest cells are late steps of few episodes, and rare failures of many."""
    rng = np.random.default_rng(5)
    long = []
    for share in (0.002, 0.998):
        one = table_of(rng, share, 9_000.0, pairs)
        late = np.tile([2_000.0, 19_999.0], pairs)
        rare = rng.random(2 * pairs) < 0.00005
        for name, column in {"goal_1_step": late, "goal_2_step": late, "jackknifed": rare}.items():
            one = one.set_column(one.column_names.index(name), name, pa.array(column))
        long.append(one)
    told = plain_table(compare(["avoid_jack", "dubins_pursuit"], long), TERMINAL_WIDTH)
    assert "\n\n" not in told  # policies stand beside each other, not in two parts
    assert max(map(len, told.splitlines())) <= TERMINAL_WIDTH


def test_what_is_no_failure_stands_in_brackets(tables):
    names = [row[0] for row in compare(NAMES, tables)]
    assert [name for name in names if name.startswith("(")] == ["(potential collision)"]


def test_differences_are_a_table_of_their_own(tables):
    rows = compare_differences(NAMES, tables)
    assert rows[0] == ["less first", "second"]
    (hit,) = (row for row in rows if row[0] == "goal 1 hit")
    found = np.mean(tables[1]["goal_1_hit"].to_numpy(False)) - np.mean(
        tables[0]["goal_1_hit"].to_numpy(False)
    )
    assert float(hit[1].split(" pp")[0]) == pytest.approx(100 * found, abs=0.06)


@pytest.mark.parametrize("name", ["a", "avoid_jack", "x" * 300])
def test_the_legend_has_two_lines_of_a_terminal(name):
    lines = explain_comparison([name, "b"], True).splitlines()
    assert len(lines) == 2
    assert max(map(len, lines)) <= 80
