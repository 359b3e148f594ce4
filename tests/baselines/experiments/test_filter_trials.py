"""Trials of the safety filter: HAVs come to harm without it, and none with it."""

import pytest

from baselines.experiments.filter_trials import TrialOptions, main, try_all
from tests.support.budgets import budget


def rows_of(text):
    """Return the rows of a Markdown table as dictionaries."""
    head, _, *rows = [
        [cell.strip() for cell in line.split("|")[1:-1]] for line in text.split("\n") if line
    ]
    return [dict(zip(head, row, strict=True)) for row in rows]


@pytest.mark.exhaustive
@pytest.mark.parametrize("scenario", ["paper-pair", "docks-6"])
def test_only_havs_without_the_filter_come_to_harm(scenario):
    options = TrialOptions((scenario,), budget(120, 12), 120, threads=1)
    rows = rows_of(try_all(options))
    assert [row["filter"] for row in rows] == ["none", "both"] * 2
    events = [name for name in ("jackknifed", "collided", "hit an obstacle") if rows[0][name]]
    harmed = [sum(int(row[event]) for event in events) for row in rows]
    assert harmed[1] == harmed[3] == 0
    assert harmed[0] + harmed[2] > 0
    assert any(float(row["changed"].removesuffix(" %")) > 0.0 for row in rows[1::2])


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--scenarios", "dock-6"], "there is no scenario 'dock-6' (did you mean 'docks-6'?)"),
        (["--havs", "0"], "havs is 0, but must be"),
        (["--steps", "0"], "steps is 0, but must be"),
    ],
)
def test_a_wrong_option_is_one_line(words, message, capsys):
    assert main(words) != 0
    told = capsys.readouterr().err
    assert message in told
    assert "Traceback" not in told
