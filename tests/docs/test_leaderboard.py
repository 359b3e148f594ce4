"""The leaderboard ranks its entries by the rules on its page, and refuses what breaks them."""

import itertools
import json
import sys

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from baselines.evaluation.run_description import describe_model
from baselines.policies.random import Random
from baselines.policies.reserve import Reserve
from hav_env import Filtered, OffAxle, OnAxle, Task, find_scenario
from hav_env.safety import Unfiltered
from hav_env.world.place.guidance import Dubins
from tests.support.paths import ROOT


@pytest.fixture(scope="module")
def board():
    sys.path.insert(0, str(ROOT / "docs"))
    try:
        import make_leaderboard

        yield make_leaderboard
    finally:
        sys.path.remove(str(ROOT / "docs"))


def test_the_page_is_what_the_command_writes(board):
    page = board.PAGE.read_text()
    assert page == board.with_ranking(page, json.loads(board.ENTRIES.read_text()))


def entry(hit, jackknifed, collided, steps):
    shares = {"last goal hit": hit, "jackknifed": jackknifed, "actual collision": collided}
    figures = {name: [value, 0.0, 1.0] for name, value in shares.items()}
    return {"figures": figures | {"last goal step": steps and [steps, 0.0, 9.0]}}


def test_each_pair_of_neighbours_follows_the_rules_of_the_page(board):
    values = itertools.product((0.0, 0.5, 1.0), (0.0, 0.002), (0.0, 0.001), (None, 100.0, 200.0))
    entries = {str(k): entry(*one) for k, one in enumerate(values)}
    ranked = board.rank(entries)
    assert sorted(ranked) == sorted(entries)
    for better, worse in itertools.pairwise(ranked):
        first, second = (entries[name]["figures"] for name in (better, worse))
        safe = [max(f["jackknifed"][0], f["actual collision"][0]) < 0.001 for f in (first, second)]
        assert safe[0] >= safe[1]
        if safe[0] == safe[1]:
            hits = [f["last goal hit"][0] for f in (first, second)]
            assert hits[0] >= hits[1]
            if hits[0] == hits[1] and second["last goal step"]:
                assert first["last goal step"]
                assert first["last goal step"][0] <= second["last goal step"][0]


@pytest.fixture
def folder(tmp_path):
    """Return a folder as ``hav-env evaluate`` writes it, with chosen values."""

    def write(**changes):
        rng, count = np.random.default_rng(1), 1_000
        columns = {
            name: rng.random(count) < 0.5
            for name in (
                *("jackknifed", "goal_1_hit", "goal_2_hit"),
                *("potential_collision", "actual_collision", "folded_through"),
            )
        }
        columns |= {
            name: rng.random(count)
            for name in (
                *("goal_1_step", "goal_2_step", "largest_articulation"),
                *("goal_1_length_ratio", "goal_2_length_ratio"),
            )
        }
        keys = {"episode": np.repeat(np.arange(500), 2), "hav": np.tile([0, 1], 500)}
        pq.write_table(pa.table(keys | columns), tmp_path / "mine.parquet")
        models = {
            "policy": Dubins(),
            "scenario": find_scenario("paper-pair"),
            "task": Task(),
            "vehicle": OnAxle(),
            "guidance": Dubins(),
        }
        told = {"num_episodes": 500, "seed": 2026, "code": "0"} | models | changes
        told = {name: describe_model(value) for name, value in told.items()}
        (tmp_path / "mine.json").write_text(json.dumps(told))
        return tmp_path, columns

    return write


def test_an_entry_has_the_shares_of_its_table(board, folder):
    path, columns = folder()
    (figures,) = (one["figures"] for one in board.read_entries(path)["paper-pair"].values())
    for name, column in (("last goal hit", "goal_2_hit"), ("jackknifed", "jackknifed")):
        assert figures[name][0] == pytest.approx(np.mean(columns[column]))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"seed": 0}, "has seed 0, but must have 2026"),
        ({"num_episodes": 499}, "has 499 episodes, but must have at least 500"),
        ({"task": Task(max_steps=5)}, "has task"),
        ({"scenario": find_scenario("swarm-5")}, "has another scenario"),
        ({"vehicle": OffAxle()}, "has vehicle .*but must have"),
    ],
)
def test_an_entry_that_breaks_a_rule_is_refused(changes, message, board, folder):
    with pytest.raises(ValueError, match=message):
        board.read_entries(folder(**changes)[0])


@pytest.mark.parametrize(
    ("policy", "name"),
    [
        (Random(), "mine"),
        (Filtered(Random()), "mine (filter both)"),
        (Filtered(Random(), Unfiltered(), backup=Reserve()), "mine (backup reserve)"),
    ],
)
def test_the_name_of_an_entry_has_its_filter_and_its_backup(policy, name, board, folder):
    path, _ = folder(policy=policy)
    assert list(board.read_entries(path)["paper-pair"]) == [name]
