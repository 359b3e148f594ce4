"""With ``info="ends"`` every interface reports where episodes end, as otherwise, and only there."""

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers import vector as wrappers
from stable_baselines3.common.vec_env import VecMonitor

from hav_env import Task, parallel_env
from hav_env.envs.hav_swarm_v0 import env as one_by_one
from hav_env.envs.stable_baselines3 import HAVVecEnv
from hav_env.mdp.decision_process import DecisionProcess
from tests.support.budgets import budget
from tests.support.comparing import exactly
from tests.support.worlds import side_by_side

SWARM, SINGLE = "hav_env:HAVSwarm-v0", "hav_env:HAVSingle-v0"
STEPS = budget(60, 20)
# HAVs that arrive one after another, wherever they turn
ARRIVING = {
    "scenario": side_by_side(2.0, 3.0, 4.0),
    "task": Task(max_steps=20, distance_tolerance=1.5, heading_tolerance=4.0),
}
CASES = {
    "short": {"max_steps": 7},
    "held": {"max_steps": 7, "frame_skip": 3},
    "arriving": ARRIVING,
    "leaving": ARRIVING | {"on_goal": "remove"},
}
cases = pytest.mark.parametrize("settings", list(CASES.values()), ids=CASES)
AMONG_OTHERS = {"others": "avoid_jack", "num_havs": 3}


def both(make, **settings):
    """Return the environment that always reports, and the one that does so at ends."""
    return make(**settings), make(info="ends", **settings)


@cases
def test_agents_are_reported_on_when_they_end(settings):
    always, ends = both(parallel_env, **settings)
    rng, reported = np.random.default_rng(0), 0
    for _ in range(STEPS):
        if not always.agents:
            (seen, infos), (seen_too, none) = always.reset(seed=3), ends.reset(seed=3)
            assert exactly(seen) == exactly(seen_too)
            assert list(none) == list(infos)
            assert not any(none.values())
        actions = {a: rng.uniform(0, 1, 2).astype(np.float32) for a in always.agents}
        (*told, infos), (*told_too, infos_too) = always.step(actions), ends.step(actions)
        assert exactly(told) == exactly(told_too)
        assert always.agents == ends.agents
        assert list(infos_too) == list(infos)
        for agent, info in infos.items():
            ended = agent not in always.agents
            assert exactly(infos_too[agent]) == (exactly(info) if ended else {})
            reported += ended
    assert reported > 0


def test_agents_in_turn_are_reported_on_when_they_end():
    always, ends = both(one_by_one, **CASES["leaving"])
    for env in (always, ends):
        env.reset(seed=0)
    while always.agents:
        told, told_too = always.last(), ends.last()
        assert exactly(told[:4]) == exactly(told_too[:4])
        over = told[2] or told[3]
        assert exactly(told_too[4]) == (exactly(told[4]) if over else {})
        for env in (always, ends):
            env.step(None if over else np.ones(2))


@cases
@pytest.mark.parametrize(
    ("name", "more"),
    [(SWARM, {}), (SWARM, {"flatten": True}), (SINGLE, {}), (SINGLE, AMONG_OTHERS)],
)
def test_one_world_is_reported_on_when_it_ends(name, more, settings):
    if more is AMONG_OTHERS:
        settings = {key: settings[key] for key in settings if key != "scenario"} | more
    always, ends = both(lambda **made: gym.make(name, **made), **settings)
    over, reported = True, 0
    for _ in range(STEPS):
        if over:
            (seen, _), (seen_too, none) = always.reset(seed=5), ends.reset(seed=5)
            assert exactly(seen) == exactly(seen_too)
            assert none == {}
        action = np.ones(always.action_space.shape, np.float32)
        (*told, info), (*told_too, info_too) = always.step(action), ends.step(action)
        assert exactly(told) == exactly(told_too)
        over = told[2] or told[3]
        assert exactly(info_too) == (exactly(info) if over else {})
        reported += over
    assert reported > 0


def told_of(info, ended):
    """Return the expected infos of the worlds that ended, from those of all worlds."""
    if not ended.any():
        return {}
    return {
        name: ended
        if name.startswith("_")
        else np.where(ended.reshape(-1, *[1] * (value.ndim - 1)), value, 0.0)
        for name, value in info.items()
    }


@cases
@pytest.mark.parametrize("mode", AutoresetMode)
@pytest.mark.parametrize(("name", "more"), [(SWARM, {}), (SINGLE, {})])
def test_worlds_are_reported_on_when_they_end(name, more, mode, settings):
    made = {"num_envs": 4, "autoreset_mode": mode} | settings | more
    always, ends = both(lambda **told: gym.make_vec(name, **told), **made)
    (seen, info), (seen_too, none) = always.reset(seed=5), ends.reset(seed=5)
    assert exactly(seen) == exactly(seen_too)
    assert none == {}
    rng, reported = np.random.default_rng(0), 0
    for _ in range(STEPS):
        actions = rng.uniform(0, 1, always.action_space.shape).astype(np.float32)
        (*told, info), (*told_too, info_too) = always.step(actions), ends.step(actions)
        assert exactly(told) == exactly(told_too)
        ended = told[2] | told[3]
        if mode == AutoresetMode.SAME_STEP:
            final = {
                n: info[n]
                for n in ("final_obs", "_final_obs", "final_info", "_final_info")
                if n in info
            }
            assert exactly(info_too) == exactly(final)
            assert ended.any() == bool(final)
        else:
            assert exactly(info_too) == exactly(told_of(info, ended))
        reported += ended.sum()
        if mode == AutoresetMode.DISABLED and ended.any():
            _, none = ends.reset(options={"reset_mask": ended.copy()})
            always.reset(options={"reset_mask": ended.copy()})
            assert none == {}
    assert reported > 0


@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
@pytest.mark.parametrize("name", [SWARM, SINGLE])
def test_wrappers_find_what_they_need(name, mode):
    made = {"num_envs": 4, "autoreset_mode": mode, "max_steps": 6}
    always, ends = both(
        lambda **told: wrappers.DictInfoToList(
            wrappers.RecordEpisodeStatistics(gym.make_vec(name, **told))
        ),
        **made,
    )
    always.reset(seed=0), ends.reset(seed=0)
    for _ in range(13):
        actions = np.full(always.action_space.shape, 0.5, np.float32)
        (*told, infos), (*told_too, infos_too) = always.step(actions), ends.step(actions)
        assert exactly(told) == exactly(told_too)
        for info, info_too in zip(infos, infos_too, strict=True):
            assert ("episode" in info_too) == ("episode" in info)
            if "episode" in info_too:
                assert exactly(info_too["episode"]["r"]) == exactly(info["episode"]["r"])
                assert info_too["episode"]["l"] == info["episode"]["l"] == 6
                assert ("is_success" in info_too) == (mode == "NextStep")
            else:
                assert info_too == {}


@cases
def test_rows_are_always_reported_on_at_ends(settings):
    plain, ends = both(lambda **told: VecMonitor(HAVVecEnv(3, **told)), **settings)
    for env in (plain, ends):
        env.seed(0)
    assert exactly(plain.reset()) == exactly(ends.reset())
    reported = 0
    for _ in range(STEPS):
        actions = np.ones((plain.num_envs, 2), np.float32)
        told, told_too = plain.step(actions), ends.step(actions)
        for infos in (told[3], told_too[3]):
            for done, info in zip(told[2], infos, strict=True):
                assert bool(info) == done
                if done:
                    reported += 1
                    assert info["episode"].pop("t") > 0.0  # a duration by the clock
                    assert {"is_success", "return_goal", "terminal_observation"} <= set(info)
        assert exactly(told) == exactly(told_too)
    assert reported > 0


@pytest.mark.parametrize(("frame_skip", "controlled"), [(1, None), (3, None), (2, 1)])
def test_nothing_is_written_of_worlds_that_go_on(frame_skip, controlled):
    """Infos that are not reported are not computed: their memory stays as it was."""
    driver = None if controlled is None else "avoid_jack"
    processes = [
        DecisionProcess(
            5, controlled, driver, info=info, max_steps=9, frame_skip=frame_skip, threads=1
        )
        for info in ("always", "ends")
    ]
    for process in processes:
        process.begin(np.arange(5), np.zeros(5, np.int64), np.ones(5, np.bool_), process.outcome())
    for process in processes:  # a second episode, whose end comes later
        process.step(np.zeros((5, process.num_controlled, 2)))
        late = np.array([False, True, False, False, True])
        process.begin(np.arange(5), np.ones(5, np.int64), late, process.outcome())
    written = 0
    for _ in range(9):
        outcomes = []
        for process in processes:
            outcome = process.outcome()
            outcome.info[:] = np.nan
            outcomes.append(process.step(np.ones((5, process.num_controlled, 2)), outcome))
        always, ends = outcomes
        over = always.terminated | always.truncated
        assert np.isfinite(always.info).all()
        assert np.isnan(ends.info[..., ~over]).all()
        assert exactly(ends.info[..., over]) == exactly(always.info[..., over])
        for name in ("observation", "reward", "terminated", "truncated"):
            assert exactly(getattr(ends, name)) == exactly(getattr(always, name))
        written += over.any() and not over.all()
        if over.all():
            break
    assert written > 0
