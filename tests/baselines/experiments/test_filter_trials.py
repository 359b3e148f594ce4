"""Trials of the safety filter: HAVs come to harm without it, and none with it."""

import pytest

from baselines.experiments import filter_trials
from baselines.experiments.filter_trials import Trial, TrialOptions, main, try_all
from tests.support.budgets import budget


@pytest.mark.exhaustive
@pytest.mark.parametrize("actuators", ["instant", "limited"])
@pytest.mark.parametrize("scenario", ["paper-pair", "docks-6"])
def test_only_havs_without_the_filter_come_to_harm(scenario, actuators):
    options = TrialOptions((scenario,), actuators, budget(120, 12), 120, threads=1)
    trials = list(try_all(options))
    assert [trial.filtered for trial in trials] == [False, True] * 2
    assert trials[1].harmed == trials[3].harmed == 0
    assert trials[0].harmed + trials[2].harmed > 0
    assert any(trial.changed > 0 for trial in trials[1::2])


def test_rows_are_printed_when_they_are_known(monkeypatch, capsys):
    def interrupted(options):
        yield Trial("paper-pair", "at random", True, 2, 20, 0, 1, None, 5)
        raise KeyboardInterrupt

    monkeypatch.setattr(filter_trials, "try_all", interrupted)
    assert main([]) == 130
    printed = capsys.readouterr()
    assert "| paper-pair | at random | both | 2 | 20 | 0 | 1 |  | 25.00 % |" in printed.out
    assert "rows above stay valid" in printed.err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--scenarios", "dock-6"], "there is no scenario 'dock-6' (did you mean 'docks-6'?)"),
        (["--actuators", "slow"], "unknown actuators 'slow'"),
        (["--havs", "0"], "havs is 0, but must be"),
        (["--steps", "0"], "steps is 0, but must be"),
    ],
)
def test_a_wrong_option_is_one_line(words, message, capsys):
    assert main(words) != 0
    told = capsys.readouterr().err
    assert message in told
    assert "Traceback" not in told
