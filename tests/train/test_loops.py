"""The own loops: advantages by their definition, networks, normalization, files that drive."""

import json

import numpy as np
import pytest
import torch

from baselines.policies.files import load_policy, load_trained
from baselines.policies.network import input_names
from hav_env import find_scenario
from hav_env.evaluation.rollout import rollout
from hav_env.mdp.central_state import CentralState
from tests.support.networks import actions_of
from tests.support.trainings import EVALUATED, SIZES
from train import ippo, mappo
from train.loops.advantages import advantages_of
from train.loops.arguments import read_loop_arguments
from train.loops.moments import Moments, Normalizer, RewardScale
from train.loops.networks import Actor, Body, Row, log_density
from train.loops.record import policy_of
from train.loops.worlds import Worlds

LEFT_OUT = ("checkpoint-every",)


def words(folder, **changes):
    """Return the command line of a training of a few updates."""
    sizes = {name: value for name, value in SIZES.items() if name not in LEFT_OUT}
    sizes |= {name.replace("_", "-"): value for name, value in changes.items()}
    told = ["--preset", "smoke", "--output", str(folder)]
    for name, value in sizes.items():
        told += [f"--{name}", *map(str, np.atleast_1d(value))]
    return told


# advantages


def by_sums(rewards, values, ended, discount, gae_lambda):
    """Return advantages by their definition: sums of surprises until the end of the episode."""
    steps, rows = rewards.shape
    advantages = np.zeros((steps, rows))
    for t in range(steps):
        for row in range(rows):
            weight = 1.0
            for later in range(t, steps):
                following = 0.0 if ended[later, row] else values[later + 1, row]
                surprise = rewards[later, row] + discount * following - values[later, row]
                advantages[t, row] += weight * surprise
                weight *= discount * gae_lambda
                if ended[later, row]:
                    break
    return advantages


@pytest.mark.parametrize(("discount", "gae_lambda"), [(0.9, 0.8), (1.0, 1.0), (0.99, 0.0)])
def test_advantages_are_sums_of_surprises(discount, gae_lambda):
    rng = np.random.default_rng(0)
    rewards, values = rng.normal(size=(12, 5)), rng.normal(size=(13, 5))
    ended = rng.random((12, 5)) < 0.2
    given = (torch.from_numpy(array) for array in (rewards, values, ended))
    found = advantages_of(*given, discount, gae_lambda).numpy()
    assert found == pytest.approx(by_sums(rewards, values, ended, discount, gae_lambda), abs=1e-12)


# moments


def test_moments_are_those_of_all_rows():
    rng, moments = np.random.default_rng(0), Moments(3)
    parts = [rng.normal(5.0, 2.0, (n, 3)) for n in (1, 7, 0, 30)]
    for part in parts:
        moments.update(part)
    every = np.concatenate(parts)
    assert moments.mean == pytest.approx(every.mean(0))
    assert moments.variance == pytest.approx(every.var(0))


def test_pooled_neighbors_share_the_moments_of_those_present():
    rng, row = np.random.default_rng(0), Row(2, 3, 4)
    others = rng.normal(3.0, 2.0, (50, 3, 4))
    others[..., 0] = rng.random((50, 3)) < 0.5
    others[others[..., 0] == 0.0] = 0.0
    rows = np.concatenate([rng.normal(size=(50, 2)), others.reshape(50, 12)], axis=1)
    seen = Normalizer(row, pooled=True)
    seen.update(torch.from_numpy(rows))
    present = others[others[..., 0] == 1.0][:, 1:]
    for k in range(3):
        first = 2 + 4 * k
        assert seen.mean[first + 1 : first + 4] == pytest.approx(present.mean(0))
        assert seen.variance[first + 1 : first + 4] == pytest.approx(present.var(0))
        found = seen(torch.from_numpy(rows))[:, first].numpy()
        assert found.tolist() == others[:, k, 0].tolist()


def test_rewards_are_scaled_by_the_deviation_of_discounted_returns():
    rng = np.random.default_rng(0)
    rewards, ended = rng.normal(1.0, 3.0, (20, 4)), rng.random((20, 4)) < 0.1
    returns, now = [], np.zeros(4)
    for t in range(20):
        now = 0.9 * now + rewards[t]
        returns.append(now)
        now = np.where(ended[t], 0.0, now)
    scale = RewardScale(4, 0.9, 1.5)
    first, second = (
        scale(torch.from_numpy(rewards[part]), torch.from_numpy(ended[part]))
        for part in (slice(0, 8), slice(8, 20))
    )
    assert first.shape == (8, 4)
    expected = np.clip(rewards[8:] / np.std(returns), -1.5, 1.5)
    assert second.numpy() == pytest.approx(expected, rel=1e-5)


# noise


def test_held_noise_is_one_function_of_the_state_with_the_stated_density():
    torch.manual_seed(0)
    actor = Actor(Body("plain", Row(6, 0, 0), (), (8, 5)), 0.3, held=True)
    rows = torch.randn(1, 6).expand(4_000, 6)
    with torch.no_grad():
        mean, deviation = actor.distribution(rows)
        actor.draw(4_000)
        actions, logs = actor.act(rows)
        again, _ = actor.act(rows)
    assert torch.equal(actions, again)
    assert (actions - mean).std(0).numpy() == pytest.approx(deviation[0].numpy(), rel=0.05)
    normal = torch.distributions.Normal(mean, deviation)
    constant = np.log(2.0 * np.pi)
    expected = (normal.log_prob(actions).sum(1) + constant).numpy()
    assert logs.numpy() == pytest.approx(expected, abs=1e-4)
    assert log_density(actions, mean, deviation).numpy() == pytest.approx(expected, abs=1e-4)


# runs


def begin(module, folder, **changes):
    arguments = read_loop_arguments("loop", "", words(folder, **changes))
    return module.Learner(arguments, Worlds(arguments))


def test_a_critic_sees_the_states_of_the_worlds_of_its_havs(tmp_path):
    learner = begin(mappo, tmp_path, scenario="paper-pair", network="pooled", worlds=4)
    worlds, steps = learner.worlds, learner.arguments.rollout_decisions
    known = CentralState(worlds.process.batch)
    seen, normalizer = worlds.seen.clone(), learner.known
    first = normalizer(torch.from_numpy(known.read_worlds()))
    expected = learner.seen(seen)
    rollout = learner.collect()
    assert torch.equal(rollout.states[0], first)
    assert torch.equal(rollout.rows[0], expected)
    assert rollout.states.shape == (steps + 1, 4, len(known.names))
    rows = rollout.rows.unflatten(1, (4, 2))
    with torch.no_grad():
        values = learner.critic(rows, rollout.states)
        joined = torch.cat([rows, rollout.states[:, :, None].expand(-1, -1, 2, -1)], -1)
        weight = torch.cat([learner.critic.of_row.weight, learner.critic.of_state.weight], 1)
        bias = learner.critic.of_row.bias + learner.critic.of_state.bias
        by_one_layer = learner.critic.rest(joined @ weight.T + bias)[..., 0]
    assert values.numpy() == pytest.approx(by_one_layer.numpy(), abs=1e-4)
    # every episode ends by the step limit, and has a future
    assert rollout.ended.any()
    assert len(rollout.futures) == int(rollout.ended[:, 0].sum())
    assert rollout.futures[0][2].shape == (4, 2, len(worlds.process.columns))


@pytest.mark.parametrize(
    ("module", "changes"),
    [
        (ippo, {"scenario": "paper-single"}),
        (mappo, {"scenario": "paper-pair", "worlds": 4, "hold_noise": 3}),
        pytest.param(
            ippo, {"scenario": "paper-pair", "backup": "reserve"}, marks=pytest.mark.exhaustive
        ),
        pytest.param(
            ippo, {"scenario": "paper-pair", "precision": "single"}, marks=pytest.mark.exhaustive
        ),
    ],
    ids=["ippo", "mappo", "backed", "single"],
)
def test_a_run_writes_a_file_that_drives(module, changes, tmp_path, capsys):
    folder = tmp_path / "run"
    assert module.main(words(folder, **changes)) == 0
    assert "best.policy" in capsys.readouterr().out
    curve = json.loads((folder / "curve.json").read_text())
    assert [row["decisions"] for row in curve] == [256, 512, 768]
    kept = load_trained(folder / "best.policy")
    assert kept.about["arguments"] == json.loads((folder / "run.json").read_text())["arguments"]
    assert kept.about["arguments"]["precision"] == changes.get("precision", "double")
    assert {"curve", "evaluation", "revision"} <= set(kept.about)
    scenario = find_scenario(changes["scenario"])
    table = rollout(load_policy(folder / "last.policy"), scenario, 1, np.arange(2), EVALUATED)
    assert len(table) == 2 * scenario.num_havs
    # Reserve stands where the proposed speed is low
    least = max if "backup" in changes else min
    assert least(table["path_length"].to_pylist()) > 0.0


def test_updates_change_actor_and_critic_and_the_same_seed_gives_the_same(tmp_path):
    learners = [begin(ippo, tmp_path) for _ in range(2)]
    for learner in learners:
        torch.manual_seed(0)
        with torch.no_grad():  # the initial weights depend on earlier draws
            for weights in learner.parameters:
                weights.copy_(0.1 * torch.randn(weights.shape))
        before = [weights.detach().clone() for weights in learner.parameters]
        figures = learner.update(0.0)
        changed = zip(before, learner.parameters, strict=True)
        assert all(not torch.equal(old, new) for old, new in changed)
        assert figures["minibatches"] >= 1
        assert np.isfinite(figures["value loss"])
    for one, other in zip(*(learner.parameters for learner in learners), strict=True):
        assert torch.equal(one, other)
    learner = learners[0]
    policy = policy_of(learner.actor, learner.seen, learner.worlds.process)
    with torch.no_grad():
        mean, _ = learner.actor.distribution(learner.seen(learner.worlds.seen))
    found = actions_of(policy, learner.worlds.seen)
    assert mean.clamp(-1.0, 1.0).numpy() == pytest.approx(found, abs=1e-4)


def test_a_start_on_the_route_drives_at_full_speed_along_it(tmp_path):
    for network in ("plain", "pooled"):
        learner = begin(ippo, tmp_path, begin_with="route", network=network, scenario="paper-pair")
        process, rows = learner.worlds.process, learner.worlds.seen
        steering = rows[:, process.columns.index("goal_path_steering")].numpy()
        with torch.no_grad():
            mean, _ = learner.actor.distribution(learner.seen(rows))
        assert mean[:, 0].numpy() == pytest.approx(1.0, abs=0.1)
        assert mean[:, 1].numpy() == pytest.approx(steering, abs=0.1)


@pytest.mark.parametrize("network", ["plain", "pooled"])
def test_a_start_with_a_lone_policy_steers_as_it_did(network, tmp_path):
    changes = {"scenario": "paper-pair", "network": network, "layers": (64, 64)}
    learner = begin(ippo, tmp_path, begin_with="ppo_single", **changes)
    policy, process = load_trained_single(), learner.worlds.process
    places = [process.columns.index(name) for name in input_names(policy)]
    rows = learner.worlds.seen
    with torch.no_grad():
        mean, _ = learner.actor.distribution(learner.seen(rows))
    expected = actions_of(policy, rows[:, places])
    assert mean[:, 1].clamp(-1.0, 1.0).numpy() == pytest.approx(expected[:, 1], abs=0.02)
    assert (mean[:, 0] == 1.0).all()


def load_trained_single():
    from baselines.policies.shipped import find_trained

    return find_trained("ppo_single")


def test_a_pooled_start_needs_a_pooled_network(tmp_path):
    folder, changes = tmp_path / "run", {"scenario": "paper-pair", "worlds": 4}
    learner = begin(ippo, folder, network="pooled", **changes)
    from baselines.policies.files import save_policy

    policy = policy_of(learner.actor, learner.seen, learner.worlds.process)
    path = tmp_path / "pooled.policy"
    save_policy(policy, path, {})
    again = begin(ippo, folder, network="pooled", begin_with=str(path), **changes)
    rows = learner.worlds.seen
    with torch.no_grad():
        means = [own.actor.distribution(own.seen(rows))[0] for own in (learner, again)]
    assert means[1].numpy() == pytest.approx(means[0].numpy(), abs=1e-4)
    with pytest.raises(ValueError, match="choose --network pooled"):
        begin(ippo, folder, begin_with=str(path), **changes)
