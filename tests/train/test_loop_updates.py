"""Updates of the own loops, computed again by their definitions, in worlds of known outcomes."""

import copy

import numpy as np
import pytest
import torch

from hav_env.mdp.buffers import Outcome
from hav_env.observation import Observation
from train import ippo, mappo
from train.curriculum import reward_at
from train.loops import worlds as loop_worlds
from train.loops.arguments import LoopArguments

STEPS, WORLDS, HAVS, ENTRIES = 9, 3, 2, 4
COLUMNS = ("waits", "x", "y")
BOTH = pytest.mark.parametrize("module", [ippo, mappo], ids=["ippo", "mappo"])
NO_END = np.zeros((STEPS, WORLDS), bool)
TERMINATED, TRUNCATED = NO_END.copy(), NO_END.copy()
TERMINATED[[1, 4, 6], [1, 2, 0]] = True
TRUNCATED[[2, 4, 5, 5, 8], [0, 2, 0, 1, 1]] = True  # world 2 has both at once


class KnownProcess:
    """A process of random observations, rewards and states, which keeps all of them.

    The episodes end as the two tables say. As in a real process, the start of an episode erases
    the last observation, reward and state of the one before.
    """

    columns, info, num_havs = COLUMNS, ("mark",), HAVS
    observation = Observation(neighbors=0)

    def __init__(self, num_worlds, **settings):
        """Begin before the first episodes; the settings have no effect."""
        self.batch, self.rng = self, np.random.default_rng(3)
        self.names = tuple(f"entry_{k}" for k in range(ENTRIES))
        self.state = np.zeros((num_worlds, ENTRIES), np.float32)
        self.before, self.after, self.actions, self.rewards = [], [], [], []
        self.weights = None

    def set_reward(self, reward):
        self.weights = reward

    def outcome(self):
        return Outcome(
            np.zeros((WORLDS, HAVS, len(COLUMNS)), np.float32),
            self.rng.normal(size=(1, HAVS, WORLDS)),
            self.rng.normal(1.0, 2.0, size=(HAVS, WORLDS)),
            NO_END[0].copy(),
            NO_END[0].copy(),
        )

    def begin(self, seeds, episodes, chosen, outcome):
        outcome.reward[:, chosen] = 0.0
        outcome.terminated[chosen] = outcome.truncated[chosen] = False
        self.move(chosen, outcome)

    def step(self, actions):
        self.before.append((self.now.copy(), self.state.copy()))
        self.actions.append(actions.copy())
        outcome, place = self.outcome(), len(self.rewards) % STEPS
        outcome.terminated[:], outcome.truncated[:] = TERMINATED[place], TRUNCATED[place]
        self.move(np.ones(WORLDS, bool), outcome)
        self.after.append((self.now.copy(), self.state.copy()))
        self.rewards.append(outcome.reward.T.copy())
        return outcome

    def move(self, chosen, outcome):
        """Draw where worlds are."""
        count = int(chosen.sum())
        outcome.observation[chosen] = self.rng.normal(size=(count, HAVS, len(COLUMNS)))
        outcome.observation[chosen, :, 0] = self.rng.random((count, HAVS)) < 0.3
        self.state[chosen] = self.rng.normal(size=(count, ENTRIES))
        self.now = outcome.observation

    def read_worlds(self):
        return self.state.copy()


def begin(module, monkeypatch, **changes):
    """Return a learner whose rewards are not scaled, and its process."""
    monkeypatch.setattr(loop_worlds, "DecisionProcess", KnownProcess)
    monkeypatch.setattr(loop_worlds, "CentralState", lambda batch: batch)
    torch.manual_seed(0)
    usual = {"worlds": WORLDS, "rollout_decisions": STEPS, "layers": (8, 6), "epochs": 2}
    usual |= {"batch_size": 18, "discount": 0.9, "gae_lambda": 0.8}
    arguments = LoopArguments(**usual | changes)
    learner = module.Learner(arguments, loop_worlds.Worlds(arguments))
    learner.scale = lambda rewards, ended: rewards.clone()
    return learner, learner.worlds.process


def value_of(learner, rows, state):
    """Return the values (N,) of the HAVs of one world, by normalized observations and state."""
    if isinstance(learner, mappo.Learner):
        return learner.critic(rows, state)
    return learner.critic(rows)[:, 0]


@BOTH
def test_advantages_are_those_of_the_outcomes(module, monkeypatch):
    learner, process = begin(module, monkeypatch)
    seen, known = copy.deepcopy((learner.seen, getattr(learner, "known", None)))
    rollout = learner.collect()
    found, returns = learner.advantages(rollout)
    again = learner.advantages(rollout)
    assert all(torch.equal(a, b) for a, b in zip((found, returns), again, strict=True))

    @torch.no_grad()
    def values(places):
        return np.array([
            [
                value_of(learner, seen(torch.from_numpy(rows)), known and known(state[None])[0])
                for rows, state in zip(now, torch.from_numpy(states), strict=True)
            ]
            for now, states in places
        ])  # fmt: skip

    before, after = values(process.before), values(process.after)  # (T, W, N)
    following = np.where(TERMINATED[..., None], 0.0, after)
    surprises = np.array(process.rewards) + 0.9 * following - before
    raw = np.zeros_like(before)
    for w in range(WORLDS):
        for t in range(STEPS):
            for later in range(t, STEPS):
                raw[t, w] += (0.9 * 0.8) ** (later - t) * surprises[later, w]
                if TERMINATED[later, w] or TRUNCATED[later, w]:
                    break
    acts = np.array([now[..., 0] == 0.0 for now, _ in process.before])
    assert 0 < acts.sum() < acts.size
    of_actions = raw[acts]
    centred = (raw - of_actions.mean()) / of_actions.std(ddof=1)
    expected = np.where(acts, centred, 0.0).reshape(STEPS, -1)
    assert found.numpy() == pytest.approx(expected, abs=1e-4)
    assert returns.numpy() == pytest.approx((raw + before).reshape(STEPS, -1), abs=1e-4)
    taken = rollout.actions.numpy().reshape(STEPS, WORLDS, HAVS, 2)
    assert np.array_equal(taken, process.actions)


def loss_of(learner, rollout, advantages, returns):
    """Return the clipped objective and the mean squared error of the values, HAV by HAV."""
    clip, objectives, missed = learner.arguments.clip_range, [], []
    for t in range(STEPS):
        for w in range(WORLDS):
            havs = range(w * HAVS, (w + 1) * HAVS)
            state = rollout.states[t, w] if hasattr(rollout, "states") else None
            values = value_of(learner, rollout.rows[t, havs], state)
            for k, hav in enumerate(havs):
                mean, deviation = learner.actor.distribution(rollout.rows[t, hav][None])
                normal = torch.distributions.Normal(mean[0], deviation[0])
                density = normal.log_prob(rollout.actions[t, hav]).sum() + np.log(2.0 * np.pi)
                ratio, gain = (density - rollout.logs[t, hav]).exp(), advantages[t, hav]
                bound = 1.0 + clip if gain > 0.0 else 1.0 - clip  # no gain from beyond it
                beyond = ratio > bound if gain > 0.0 else ratio < bound
                objectives.append(gain * (bound if beyond else ratio))
                missed.append((values[k] - returns[t, hav]) ** 2)
    return -torch.stack(objectives).mean(), torch.stack(missed).mean()


@BOTH
def test_a_step_follows_the_gradient_of_the_clipped_objective(module, monkeypatch):
    changes = {"epochs": 1, "batch_size": STEPS * WORLDS * HAVS, "target_divergence": 1e6}
    learner, _ = begin(module, monkeypatch, **changes)
    rollout = learner.collect()
    rollout = rollout._replace(logs=rollout.logs + 0.3 * torch.randn(rollout.logs.shape))
    policy_loss, value_loss = loss_of(learner, rollout, *learner.advantages(rollout))
    gradient = torch.autograd.grad(policy_loss + 0.5 * value_loss, learner.parameters)
    norm = torch.cat([part.flatten() for part in gradient]).norm()
    before = [weights.detach().clone() for weights in learner.parameters]
    learner.optimizer = torch.optim.SGD(learner.parameters, lr=1.0)
    figures = learner.learn(rollout)
    assert figures["minibatches"] == 1
    assert figures["value loss"] == pytest.approx(float(value_loss.detach()), rel=1e-4)
    assert norm > 0.5
    for old, new, part in zip(before, learner.parameters, gradient, strict=True):
        moved = (old - new).detach().numpy()
        assert moved == pytest.approx((part * 0.5 / norm).numpy(), abs=1e-5)


@BOTH
def test_an_update_ends_at_one_and_a_half_times_the_target_divergence(module, monkeypatch):
    apart = np.exp(-0.3) - 1.0 + 0.3  # of logarithms of densities that all fell by 0.3
    for target, minibatches in ((0.99 * apart / 1.5, 0), (1.01 * apart / 1.5, 6)):
        learner, _ = begin(module, monkeypatch, target_divergence=target)
        learner.optimizer.param_groups[0]["lr"] = 0.0
        rollout = learner.collect()
        rollout = rollout._replace(logs=rollout.logs + 0.3)
        calls = []
        learner.actor.body.register_forward_hook(lambda *_, calls=calls: calls.append(1))
        figures = learner.learn(rollout)
        assert figures["divergence"] == pytest.approx(apart, rel=1e-4)
        assert figures["minibatches"] == minibatches
        assert len(calls) == max(minibatches, 1)
        assert ("value loss" in figures) == (minibatches > 0)
    # the minibatches of an epoch hold every action once
    _, value_loss = loss_of(learner, rollout, *learner.advantages(rollout))
    assert figures["value loss"] == pytest.approx(float(value_loss.detach()), rel=1e-4)


@BOTH
def test_the_learning_rate_falls_and_the_deviation_keeps_its_bound(module, monkeypatch):
    learner, process = begin(module, monkeypatch, learning_rate=1e-3, least_deviation=0.08)
    arguments, group = learner.arguments, learner.optimizer.param_groups[0]
    learner.update(0.25)
    assert group["lr"] == pytest.approx(0.75e-3)
    assert process.weights == reward_at(arguments.curriculum, arguments.reward, 0.25)
    with torch.no_grad():
        learner.actor.log_deviation.copy_(torch.tensor([0.01, 0.3]).log())
    figures = learner.update(1.0)
    assert group["lr"] == 0.0
    deviation = learner.actor.log_deviation.detach().exp().numpy()
    assert deviation == pytest.approx([0.08, 0.3])
    assert figures["divergence"] == pytest.approx(0.0, abs=1e-5)  # the rollout has the bound too
