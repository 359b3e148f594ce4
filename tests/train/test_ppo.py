"""Arguments determine a training, which resumes where it was, and leaves files that act alone."""

import functools
import json
import shutil

import numpy as np
import pytest
import torch

from baselines.policies.files import load_policy, load_trained
from hav_env import HAVVecEnv, Reward, find_scenario
from hav_env.evaluation.comparison import figures_of, measure
from hav_env.evaluation.rollout import rollout
from hav_env.mdp.info import REPORT
from tests.support.budgets import COMPILED, budget
from tests.support.networks import actions_of
from tests.support.trainings import EVALUATED, SIZES, train, words
from train import ppo, scores
from train.curriculum import Curriculum, harm_share
from train.runs import restore
from train.sb3 import callback
from train.sb3.callback import TrainingCallback
from train.scores import HELD_OUT, score
from train.training_task import REWARD

trains_again = pytest.mark.skipif(not COMPILED, reason="trainings like the one that is tested")


@pytest.fixture(autouse=True)
def short_evaluations(monkeypatch):
    """An unfinished training hits no goals: episodes would take their full time."""
    monkeypatch.setattr(scores, "rollout", functools.partial(rollout, task=EVALUATED))


def arrays_of(folder, name="last.policy"):
    """Return all data that determine actions, to the bit."""
    policy = load_policy(folder / name)
    return [getattr(policy, field).tobytes() for field in ("sizes", "weights", "mean", "scale")]


def curve_of(folder):
    """Return the learning curve, apart from how long it took; as text, where nan is nan."""
    rows = json.loads((folder / "curve.json").read_text())
    return [repr({key: row[key] for key in row if key != "hours"}) for row in rows]


def states_of(folder):
    """Return the numbers of the checkpoint that change: weights, moments, random numbers."""
    state = torch.load(folder / "checkpoint.pt", weights_only=True)
    told = {f"weights {name}": value for name, value in state["policy"].items()}
    for number, moments in state["moments"].items():
        told |= {f"moment {number} {name}": value for name, value in moments.items()}
    told |= state["arrays"] | state["numbers"] | {"torch": state["torch"]} | state["noise"]
    assert {"worlds.state.x", "worlds.state.clock", "numpy", "seen mean"} <= set(told)
    return {name: np.asarray(value).tobytes() for name, value in told.items()}


@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    """Return the folder of a training that nothing has interrupted."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(scores, "rollout", functools.partial(rollout, task=EVALUATED))
        return train(tmp_path_factory.mktemp("runs") / "whole")


# files of a training


@trains_again
def test_the_smoke_preset_does_everything_once(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(scores, "rollout", rollout)
    folder = tmp_path / "smoke"
    assert ppo.main(["--preset", "smoke", "--output", str(folder)]) == 0
    assert f"policy: {folder}/best.policy" in capsys.readouterr().out
    names = [path.name for path in sorted(folder.iterdir()) if "tfevents" not in path.name]
    assert names == ["best.policy", "checkpoint.pt", "curve.json", "last.policy", "run.json"]
    assert len(curve_of(folder)) >= 2


def test_the_run_is_described(trained):
    told = json.loads((trained / "run.json").read_text())
    assert told["arguments"]["decisions"] == 768
    reward = {"class": "hav_env.mdp.reward:Reward", **REWARD._asdict()}
    assert told["arguments"]["reward"] == reward
    assert {"torch", "stable-baselines3", "numpy"} <= set(told["packages"])
    assert restore(ppo.Arguments, told["arguments"]) == ppo.read_arguments(words(trained))[0]


def test_a_policy_tells_how_it_came_to_be(trained):
    for name in ("best.policy", "last.policy"):
        about = load_trained(trained / name).about
        assert about["arguments"] == json.loads((trained / "run.json").read_text())["arguments"]
        assert about["decisions"] == about["curve"][-1]["decisions"]
        assert about["hours"] > 0.0
        assert {"revision", "packages", "python", "algorithm"} <= set(about)


def test_evaluations_are_spread_over_the_training_and_end_it(trained):
    def refuse(constant):
        raise AssertionError(f"{constant} is not JSON")

    rows = json.loads((trained / "curve.json").read_text(), parse_constant=refuse)
    assert [row["decisions"] for row in rows] == [256, 512, 768]
    assert (np.diff([row["hours"] for row in rows]) > 0.0).all()


def test_the_last_figures_are_those_of_the_file_on_the_held_out_episodes(trained):
    policy, scenario = load_policy(trained / "last.policy"), find_scenario("paper-single")
    episodes = np.arange(SIZES["evaluation-episodes"])
    table = rollout(policy, scenario, HELD_OUT, episodes, EVALUATED)
    row = json.loads((trained / "curve.json").read_text())[-1]
    for figure in figures_of(table):
        value = measure(table, figure).value
        assert figure.name in row or np.isnan(value)
        assert row.get(figure.name, np.nan) == pytest.approx(value, rel=1e-12, nan_ok=True)
    assert row["score"] == score(row)


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_tensorboard_shows_every_term_every_event_and_the_evaluations(trained):
    from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

    shown = EventAccumulator(str(trained))
    shown.Reload()
    tags = set(shown.Tags()["scalars"])
    told = {f"episodes/return_{term}" for term in Reward._fields}
    told |= {f"episodes/{name}" for name in REPORT if name not in ("seed", "episode_number")}
    assert {"is_success", "jackknifed", "actual_collision"} <= set(REPORT)
    told |= {"held_out/jackknifed", "held_out/goal_1_hit", "train/loss", "train/learning_rate"}
    assert told <= tags
    for tag in told:
        assert all(np.isfinite(event.value) for event in shown.Scalars(tag)), tag
    lengths = [event.value for event in shown.Scalars("episodes/steps")]
    assert lengths == [SIZES["max-steps"]] * len(lengths)
    assert [event.step for event in shown.Scalars("held_out/goal_1_hit")][-1] == 768
    counts = [event.value for event in shown.Scalars("episodes/count")]
    assert sum(counts) == 768 / 8  # every episode of eight decisions, the last ones too


def test_the_best_policy_is_that_of_the_highest_score(tmp_path, monkeypatch):
    hits = iter([0.2, 0.7, 0.7, 0.5])

    def scripted(policy, exercise, episodes):
        return {"jackknifed": 0.1, "goal 1 hit": next(hits), "goal 2 hit": 0.0}

    monkeypatch.setattr(callback, "evaluate", scripted)
    folder = train(tmp_path / "run", decisions=1_024)
    curve = json.loads((folder / "curve.json").read_text())
    assert [row["score"] for row in curve] == pytest.approx([-0.1, 0.15, 0.15, 0.05])
    assert load_trained(folder / "best.policy").about["decisions"] == 512
    assert load_trained(folder / "last.policy").about["decisions"] == 1_024


def test_harm_weighs_against_goals():
    goals = {"goal 1 hit": 0.8, "goal 2 hit": 0.6}
    assert score(goals | {"jackknifed": 0.0}) == pytest.approx(0.7)
    assert score(goals | {"jackknifed": 0.1, "actual collision": 0.05}) == pytest.approx(0.4)


@pytest.mark.parametrize("scenario", ["paper-single", "paper-pair"])
def test_what_is_kept_acts_as_the_learner(scenario, tmp_path):
    arguments, _ = ppo.read_arguments(words(tmp_path, scenario=scenario))
    run = ppo.Run(arguments)
    rows, rng = run.env.reset(), np.random.default_rng(0)
    for _ in range(budget(20, 4)):
        actions, _ = run.learner.predict(rows, deterministic=True)
        found = actions_of(run.policy(), run.env.get_original_obs())
        # the learner's own policy is in single precision, as are its normalized rows
        assert actions == pytest.approx(found, abs=1e-4)
        rows, *_ = run.env.step(rng.uniform(-1, 1, actions.shape))


# the same again


@trains_again
def test_the_seed_determines_the_weights(trained, tmp_path):
    same, other = train(tmp_path / "same"), train(tmp_path / "other", seed=1)
    assert arrays_of(same) == arrays_of(trained)
    assert arrays_of(same, "best.policy") == arrays_of(trained, "best.policy")
    assert curve_of(same) == curve_of(trained)
    assert states_of(same) == states_of(trained)
    for one, another in zip(arrays_of(other)[1:], arrays_of(trained)[1:], strict=True):
        assert one != another


class KilledError(Exception):
    """An error that no code expects."""


def stop_after(monkeypatch, decisions, error):
    """Let a training end suddenly in the middle of a rollout."""
    step = TrainingCallback._on_step

    def stopping(callback):
        if callback.num_timesteps > decisions:
            raise error
        return step(callback)

    monkeypatch.setattr(TrainingCallback, "_on_step", stopping)


@pytest.mark.parametrize("moments", budget([(300,), (520, 760), (260, 400, 620)], [(520,)]))
def test_a_training_that_was_killed_ends_as_if_it_had_not_been(
    moments, trained, tmp_path, monkeypatch
):
    """Independent of other random draws in the meantime, and of the present path of its folder."""
    folder = tmp_path / "run 0"
    for number, moment in enumerate(moments):
        with monkeypatch.context() as patch:
            stop_after(patch, moment, KilledError())
            with pytest.raises(KilledError):
                ppo.main(["--resume", str(folder)] if number else words(folder))
        torch.manual_seed(number)
        np.random.seed(number)  # noqa: NPY002 (the one that the learner uses)
        folder = folder.rename(tmp_path / f"run {number + 1}")
    assert ppo.main(["--resume", str(folder)]) == 0
    assert arrays_of(folder) == arrays_of(trained)
    assert arrays_of(folder, "best.policy") == arrays_of(trained, "best.policy")
    assert curve_of(folder) == curve_of(trained)
    assert states_of(folder) == states_of(trained)


def test_an_interrupted_training_says_how_to_go_on(tmp_path, monkeypatch, capsys):
    stop_after(monkeypatch, 300, KeyboardInterrupt())
    assert ppo.main(words(tmp_path / "run")) == 130
    assert "--resume" in capsys.readouterr().err


def test_a_training_that_is_over_stays_as_it_is(trained, tmp_path, capsys):
    folder = shutil.copytree(trained, tmp_path / "copy")
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    assert ppo.main(["--resume", str(folder)]) == 0
    assert f"policy: {folder}/best.policy" in capsys.readouterr().out
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


# arguments that matter


def test_harm_weighs_what_the_curriculum_says(tmp_path, monkeypatch):
    weights, process = [], HAVVecEnv(1).process
    set_reward = type(process).set_reward

    def note(process, reward):
        weights.append(reward)
        set_reward(process, reward)

    monkeypatch.setattr(type(process), "set_reward", note)
    curriculum = {"curriculum.share": 0.5, "curriculum.begin": 0.0, "curriculum.end": 0.5}
    train(tmp_path / "run", **curriculum)
    shares = [harm_share(Curriculum(0.5, 0.0, 0.5), k / 6) for k in range(6)]
    found = [reward.jackknife / REWARD.jackknife for reward in weights]
    assert found == pytest.approx(shares)
    assert {reward.goal for reward in weights} == {REWARD.goal}


@trains_again
@pytest.mark.parametrize(
    "changes",
    [
        {"scenario": "paper-pair", "worlds": 4},
        {"scenario": "crossing-8", "worlds": 1, "observation.neighbors": 2},
        {"layers": (5,), "frame_skip": 1},
        {"layers": (3, 4, 5)},
        {"curriculum.begin": 0.5, "curriculum.end": 0.5},
        {"decisions": 1},
    ],
    ids=str,
)
def test_what_was_trained_drives(changes, tmp_path):
    folder = train(tmp_path / "run", **changes)
    policy = load_policy(folder / "best.policy")
    scenario = find_scenario(changes.get("scenario", "paper-single"))
    assert policy.observation.neighbors == min(
        changes.get("observation.neighbors", 1), scenario.num_havs - 1
    )
    assert policy.frame_skip == changes.get("frame_skip", SIZES["frame-skip"])
    assert tuple(policy.sizes[1:-1]) == changes.get("layers", (8, 6))
    assert len(rollout(policy, scenario, 1, np.arange(2), EVALUATED)) == 2 * scenario.num_havs
    assert not list(folder.glob(".*"))


@trains_again
def test_noise_that_is_held_goes_on_too(tmp_path, monkeypatch):
    """Stable-Baselines3 has drawn it before the checkpoint at the same moment is written."""
    whole = train(tmp_path / "whole", hold_noise=5)
    with monkeypatch.context() as patch:
        stop_after(patch, 520, KilledError())
        with pytest.raises(KilledError):
            ppo.main(words(tmp_path / "run", hold_noise=5))
    assert ppo.main(["--resume", str(tmp_path / "run")]) == 0
    assert arrays_of(tmp_path / "run") == arrays_of(whole)
    assert states_of(tmp_path / "run") == states_of(whole)
