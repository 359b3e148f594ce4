"""Evaluation on a Ray cluster: the same bytes, resumed, with policies from anywhere."""

import importlib
import os

import numpy as np
import pyarrow.parquet as pq
import pytest

from baselines.__main__ import main
from baselines.evaluation import executors as engines
from baselines.evaluation import runs as results
from baselines.evaluation.executors import open_engine, run_on_cluster
from baselines.evaluation.runs import Experiments, run_experiments
from baselines.policies.avoid_jack import AvoidJack
from baselines.policies.files import save_policy
from baselines.policies.network import Network, pack_layers
from hav_env import Observation, RandomPoses, Task
from hav_env.observation import name_columns, settle
from tests.stacks.ray_here import ray_here
from tests.support.paths import EXAMPLES

PAIR = Experiments(AvoidJack(), RandomPoses(num_havs=2), 8, 5, Task(max_steps=200))


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """Run Ray with custom policies in the working directory."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(EXAMPLES)
        patch.syspath_prepend(EXAMPLES)
        patch.setenv("PYTHONPATH", str(EXAMPLES.parent))  # as if the project were installed
        with ray_here(tmp_path_factory.mktemp("ray"), cores=2) as ray:
            yield ray


@pytest.fixture
def small_parts(monkeypatch):
    monkeypatch.setattr(results, "PART", 6)  # three episodes of two HAVs


@pytest.fixture
def engine(cluster, small_parts):
    with open_engine("ray") as engine:
        yield engine


def network():
    """Return a policy with random weights, for the pair."""
    observation = settle(Observation(), 2)
    trailers = RandomPoses(num_havs=2).max_trailers
    columns = len(name_columns(observation, trailers))
    rng = np.random.default_rng(0)
    layers = [(rng.normal(size=(8, columns)), np.zeros(8)), (rng.normal(size=(2, 8)), np.zeros(2))]
    sizes, weights = pack_layers(layers)
    normal = np.zeros(columns), np.ones(columns)
    return Network(sizes, weights, *normal, 10.0, 5, observation, trailers)


@pytest.mark.parametrize("policy", [AvoidJack(), network()], ids=["AvoidJack", "Network"])
@pytest.mark.parametrize("threads", [None, 2, 64])
def test_the_table_is_the_same_to_the_byte(policy, threads, engine, tmp_path):
    job = PAIR._replace(policy=policy)
    here = run_experiments(job, tmp_path / "here", "pair")
    there = run_experiments(job, tmp_path / "there", "pair", threads, engine=engine)
    assert there.read_bytes() == here.read_bytes()
    assert (there.parent / "pair.json").read_bytes() == (here.parent / "pair.json").read_bytes()
    assert not (there.parent / "pair.parts").exists()


def test_either_engine_goes_on_where_the_other_stopped(engine, tmp_path):
    whole = run_experiments(PAIR, tmp_path / "whole", "pair")

    def stop(episodes, steps):
        raise KeyboardInterrupt

    for first, second in ((None, engine), (engine, None)):
        folder = tmp_path / f"by {'ray' if first else 'local'}"
        engines_of = {True: {"engine": engine}, False: {}}
        with pytest.raises(KeyboardInterrupt):
            run_experiments(PAIR, folder, "pair", advance=stop, **engines_of[first is not None])
        assert len(list((folder / "pair.parts").iterdir())) == 1
        steps = []
        resumed = run_experiments(
            PAIR,
            folder,
            "pair",
            advance=lambda n, moved, steps=steps: steps.append(moved),
            **engines_of[second is not None],
        )
        assert steps.count(0) == 1  # the stored parts were not run again
        assert len(steps) == 3
        assert resumed.read_bytes() == whole.read_bytes()


def test_policies_of_ones_own_and_trained_ones_are_evaluated(
    cluster, small_parts, tmp_path, capsys
):
    file = tmp_path / "random.policy"
    save_policy(network(), file, {})
    for name in ("local", "ray"):
        code = main([
            "evaluate", "slow_down:SlowDown", str(file), "--scenario", "paper-pair",
            "--episodes", "7", "--task.max-steps", "100", "--engine", name,
            "--output", str(tmp_path / name),
        ])  # fmt: skip
        assert (code, capsys.readouterr().err.count("error")) == (0, 0)
    ours, theirs = (sorted((tmp_path / name).glob("*.parquet")) for name in ("local", "ray"))
    assert len(ours) == 2
    assert [path.read_bytes() for path in ours] == [path.read_bytes() for path in theirs]
    assert pq.read_metadata(theirs[0]).num_row_groups == 3


def test_more_parts_than_are_given_out_at_once(engine, tmp_path, monkeypatch, cluster):
    monkeypatch.setattr(engines, "_TASKS_AHEAD", 1)
    job = PAIR._replace(num_episodes=33, task=Task(max_steps=10))  # eleven parts, two cores
    here = run_experiments(job, tmp_path / "here", "pair")
    there = run_experiments(job, tmp_path / "there", "pair", engine=engine)
    assert there.read_bytes() == here.read_bytes()


def test_what_goes_wrong_there_is_said_here(cluster, monkeypatch, tmp_path):
    def fail(span, threads):
        raise ValueError(f"no room for {span}")

    def leave(span, threads):
        os._exit(1)

    spans = [range(3)]
    with pytest.raises(ValueError, match=r"^no room for range\(0, 3\)$"):
        list(run_on_cluster(cluster, fail, spans, None))
    (tmp_path / "only_here.py").write_text("def part(span, threads):\n    pass\n")
    monkeypatch.syspath_prepend(tmp_path)
    part = importlib.import_module("only_here").part
    with pytest.raises(OSError, match=r"cannot run episodes: .*No module named 'only_here'$"):
        list(run_on_cluster(cluster, part, spans, None))
    with pytest.raises(OSError, match="the Ray cluster cannot run episodes"):
        list(run_on_cluster(cluster, leave, spans, None))
    monkeypatch.setattr(engines, "_digest", lambda part: "other")
    with pytest.raises(ValueError, match="another version of this project"):
        list(run_on_cluster(cluster, fail, spans, None))
