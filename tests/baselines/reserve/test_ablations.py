"""Ablations of Reserve: its properties without order, without broadcast, and with noise."""

import numpy as np
import pytest

from baselines.experiments import reserve_ablations as variants
from baselines.experiments.survey import Entry
from baselines.policies.reserve import Reserve
from hav_env import Batch, RandomPoses, Task
from hav_env.policies.checks import check_policy
from hav_env.policies.driver import PolicyDriver
from hav_env.policies.interface import broadcast_size
from tests.support.audit import Audit, drive
from tests.support.budgets import budget

CROWD = RandomPoses(num_havs=5, area_factor=2.0)
EPISODES, STEPS = range(budget(8, 1)), budget(1500, 4)


def test_all_may_decide_at_once_when_they_reserve_in_turns():
    """No HAV knows another one's decision of the same step: each acts on the memory before."""
    batch = Batch(CROWD, len(EPISODES))
    batch.reset(21)
    driver, audit = PolicyDriver(Reserve(turns=5), batch), Audit(batch.worlds)
    waiting, havs = batch.worlds.state.waiting, np.arange(5)
    for _ in range(STEPS):
        before, resting = driver.memory.copy(), waiting.copy()
        after = before.copy()
        actions = np.zeros((2, 5, len(EPISODES)))
        for hav in havs:
            driver.memory[:] = before
            waiting[havs != hav] = True  # does not act
            decided = driver.decide()
            waiting[:] = resting
            after[hav] = driver.memory[hav]
            actions[:, hav] = [part[hav] for part in decided]
        driver.memory[:] = after
        batch.step(*actions)
        audit.look()
    audit.approve()
    assert waiting.mean() >= budget(1, 0) * 0.3


@pytest.mark.parametrize(
    "policy",
    [
        Reserve(broadcast=False),
        pytest.param(Reserve(position_noise=0.5, heading_noise=0.05), marks=pytest.mark.exhaustive),
        Reserve(turns=5, position_noise=0.2),
    ],
)
def test_no_variant_jackknifes_or_collides(policy):
    audit = drive(CROWD, 22, EPISODES, STEPS, policy=policy)
    audit.approve()
    assert audit.worlds.state.waiting.mean() >= budget(1, 0) * 0.2


@pytest.mark.parametrize("sensing_range", [0.5, pytest.param(5.0, marks=pytest.mark.exhaustive)])
def test_less_range_costs_no_safety(sensing_range):
    drive(CROWD, 23, EPISODES, STEPS, task=Task(sensing_range=sensing_range)).approve()


@pytest.mark.parametrize(
    ("parameter", "value"), [("turns", 0), ("position_noise", -0.1), ("heading_noise", -0.1)]
)
def test_what_no_variant_can_be(parameter, value):
    with pytest.raises(ValueError, match=f"policy {parameter} is {value}, but must be at least"):
        check_policy(Reserve()._replace(**{parameter: value}), CROWD)


@pytest.mark.exhaustive
def test_a_table_of_all_variants(tmp_path, monkeypatch, capsys):
    short = [
        one._replace(task=one.task._replace(max_steps=budget(500, 1))) for one in variants.VARIANTS
    ]
    monkeypatch.setattr(variants, "VARIANTS", short)
    monkeypatch.setattr(variants, "ENTRIES", (Entry("paper-pair", 2),))
    assert variants.main(["--output", str(tmp_path), "--share", "0.5", "--format", "md"]) == 0
    rows = capsys.readouterr().out.strip().splitlines()[2:]
    assert len(rows) == 2 + len(short) == len((tmp_path / "report.md").read_text().splitlines())
    assert all(
        f"| paper-pair | {one.name} |" in row for one, row in zip(short, rows[2:], strict=True)
    )
    assert variants.main(["--share", "0"]) == 2
    assert capsys.readouterr().err == "error: share is 0.0, but must be above 0 and at most 1\n"


def test_nobody_decides_by_what_others_keep_to_themselves():
    batch = Batch(CROWD, len(EPISODES))
    batch.reset(24)
    driver, waiting = PolicyDriver(Reserve(), batch), batch.worlds.state.waiting
    private = slice(broadcast_size(driver.policy), None)
    for _ in range(budget(400, 12)):
        before, resting, others = driver.memory.copy(), waiting.copy(), np.arange(5) != 3
        results = []
        for told in (before[others, private], np.nan):
            driver.memory[:] = before
            driver.memory[others, private] = told
            waiting[others] = True  # do not act
            results.append([*driver.decide(), driver.memory[3].copy()])
            waiting[:] = resting
        for one, other in zip(*results, strict=True):
            assert np.array_equal(one, other)
        driver.memory[:] = before
        batch.step(*driver.decide())
