"""Runs of several seeds as one row: their grouping, and their figures."""

import json

import numpy as np
import pyarrow.parquet as pq
import pytest

from baselines.evaluation.arrival_times import world_times
from baselines.policies.dubins_pursuit import DubinsPursuit
from baselines.policies.random import Random
from hav_env import Task, find_scenario
from hav_env.evaluation.rollout import rollout
from tests.support.budgets import budget
from tests.train.run_folders import EVALUATIONS, write_run
from train.comparison_plots import curve_band
from train.run_groups import find_group
from train.seed_scores import TIME_RATIO, group_rows, score_group, tabulate_groups, world_values

CAP = budget(600, 8)
EASY = Task(max_steps=CAP, distance_tolerance=budget(0.5, 60.0), heading_tolerance=4.0)


# which runs


def test_the_runs_of_a_pattern_are_in_the_order_of_their_seeds(tmp_path):
    for seed in (11, 2, 5):
        write_run(tmp_path / f"seed-{seed}", seed)
    write_run(tmp_path / "seed-pair", 0, scenario="paper-pair")
    group = find_group(f"{tmp_path}/seed-*")
    assert [run.arguments["seed"] for run in group["paper-single"]] == [2, 5, 11]
    assert [run.folder.name for run in group["paper-pair"]] == ["seed-pair"]
    weights = [run.policy.weights for run in group["paper-single"]]
    assert not np.array_equal(weights[0], weights[1])
    assert [row["decisions"] for row in group["paper-single"][0].curve] == list(EVALUATIONS)


def test_the_folder_of_a_set_is_all_of_its_runs(tmp_path):
    (tmp_path / "set").mkdir()
    told = {"arguments": {"scenario": "paper-single", "seeds": [4, 1]}}
    (tmp_path / "set/run.json").write_text(json.dumps(told))
    for seed in (1, 4):
        write_run(tmp_path / f"set/seed-{seed}", seed)
    one, other = find_group(str(tmp_path / "set")), find_group(f"{tmp_path}/set/seed-*")
    assert [run.folder for run in one["paper-single"]] == [
        run.folder for run in other["paper-single"]
    ]


def test_runs_that_do_not_belong_together_are_refused(tmp_path):
    with pytest.raises(ValueError, match="matches no folder"):
        find_group(f"{tmp_path}/*")
    write_run(tmp_path / "a", 0)
    write_run(tmp_path / "b", 1, decisions=400)
    with pytest.raises(ValueError, match="another decisions: name them apart"):
        find_group(f"{tmp_path}/*")
    write_run(tmp_path / "c", 0)
    with pytest.raises(ValueError, match="seed 0 more than once"):
        find_group(f"{tmp_path}/[ac]")
    (tmp_path / "c/best.policy").unlink()
    with pytest.raises(ValueError, match=r"c, but it is no run that has a best\.policy yet"):
        find_group(f"{tmp_path}/c")
    (tmp_path / "a/run.json").write_text("{}")
    with pytest.raises(ValueError, match=r"run\.json is broken"):
        find_group(f"{tmp_path}/a")


# figures


@pytest.fixture(scope="module", params=["paper-single", "paper-pair"])
def tables(request):
    """Two policies in place of two training seeds."""
    scenario = find_scenario(request.param)
    episodes = np.arange(budget(20, 4))
    policies = DubinsPursuit(), Random()
    return scenario, [rollout(one, scenario, 3, episodes, task=EASY) for one in policies]


def test_worlds_are_the_units(tables):
    scenario, (table, _) = tables
    found = world_values(table, scenario.fleet, CAP)
    rows = table.to_pylist()
    for world, episode in enumerate(sorted({row["episode"] for row in rows})):
        own = [row for row in rows if row["episode"] == episode]
        hits = [row["goal_1_hit"] for row in own]
        steps = [CAP if row["goal_1_step"] is None else row["goal_1_step"] for row in own]
        ratios = [row["goal_1_length_ratio"] for row in own if row["goal_1_hit"]]
        assert found["goal 1 hit"][world] == np.mean(hits)
        assert found["goal 1 step"][world] == pytest.approx(np.mean(steps))
        ratio = found["goal 1 driven / Dubins"][world]
        assert ratio == pytest.approx(np.mean(ratios)) if ratios else np.isnan(ratio)
    times = world_times(table, scenario.fleet, CAP)
    assert found[TIME_RATIO] == pytest.approx(times.driven / times.shortest)


def test_a_group_is_one_row_over_seeds_and_worlds(tables):
    scenario, both = tables
    group = score_group("ours", both, scenario.fleet, CAP)
    alone = [score_group("one", [table], scenario.fleet, CAP) for table in both]
    worlds = both[0].num_rows // scenario.num_havs
    assert group.seeds == 2
    for figure in ("goal 1 hit", "jackknifed"):
        one = group.measured[figure]
        assert one.value == pytest.approx(np.mean([own.measured[figure].value for own in alone]))
        assert one.size == 2 * worlds
        assert one.low <= one.value <= one.high
    head, row = group_rows([group])
    assert head[:3] == ["", "seeds", "jackknifed"]
    assert row[:2] == ["ours", "2"]
    assert row[2] == group.measured["jackknifed"].show(percent=True)
    kept = {row["figure"]: row for row in tabulate_groups([group]).to_pylist()}
    assert kept[TIME_RATIO]["value"] == group.measured[TIME_RATIO].value
    assert kept[TIME_RATIO]["seeds"] == 2


def test_the_profile_is_the_share_of_worlds_of_all_seeds(tables):
    scenario, both = tables
    group = score_group("ours", both, scenario.fleet, CAP)
    ratios = np.stack([world_values(table, scenario.fleet, CAP)[TIME_RATIO] for table in both])
    for limit, share in zip(*group.profile[:2], strict=True):
        assert share == pytest.approx(np.mean(ratios <= limit))


def test_a_learning_curve_is_the_mean_over_seeds_where_all_have_been():
    curves = [
        [{"decisions": n, "goal 1 hit": n / 400 + seed / 10} for n in EVALUATIONS[: 2 + (seed > 0)]]
        for seed in range(3)
    ]
    decisions, mean, low, high = curve_band(curves, "goal 1 hit")
    assert decisions.tolist() == [100, 200]
    assert mean == pytest.approx([0.35, 0.6])
    assert low == pytest.approx([0.25, 0.5])  # of three seeds the interval is the range
    assert high == pytest.approx([0.45, 0.7])
    assert np.isnan(curve_band(curves, "never told")[1:]).all()


@pytest.mark.exhaustive
def test_the_comparison_has_a_row_for_the_group(tmp_path):
    from train import compare

    for seed in (0, 1):
        write_run(tmp_path / f"runs/seed-{seed}", seed)
    pattern, output = f"{tmp_path}/runs/seed-*", tmp_path / "out"
    options = compare.Options(
        single=("avoid_jack",), pair=(), runs=(pattern,), episodes=budget(6, 1), output=output
    )
    compare.compare_all(options)
    report = (output / "report.md").read_text()
    kept = pq.read_table(output / "paper-single-seeds.parquet").to_pylist()
    assert {(row["policy"], row["seeds"]) for row in kept} == {("avoid_jack", 1), (pattern, 2)}
    hits = [
        np.mean(pq.read_table(path)["goal_1_hit"].to_numpy(zero_copy_only=False))
        for path in output.glob("*-runs-seed-*.parquet")
    ]
    told = {row["figure"]: row["value"] for row in kept if row["policy"] == pattern}
    assert len(hits) == 2
    assert told["goal 1 hit"] == pytest.approx(np.mean(hits))
    for what in ("profiles", "curves", "episode", "bars"):
        assert f"paper-single-{what}.png" in report
        assert (output / f"paper-single-{what}.png").stat().st_size > 10_000
