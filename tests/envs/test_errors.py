"""Invalid settings raise an error that names the argument, its value and the valid range."""

import re
import subprocess
import sys

import gymnasium as gym
import numpy as np
import pytest

from hav_env import Observation, Reward, Task, parallel_env
from hav_env.envs.hav_swarm_v0 import env as one_by_one
from hav_env.envs.stable_baselines3 import HAVVecEnv
from tests.support.comparing import exactly

SWARM, SINGLE = "hav_env:HAVSwarm-v0", "hav_env:HAVSingle-v0"
MAKERS = {
    "parallel": parallel_env,
    "one by one": one_by_one,
    "swarm": lambda **settings: gym.make(SWARM, **settings),
    "single": lambda **settings: gym.make(SINGLE, **settings),
    "swarms": lambda **settings: gym.make_vec(SWARM, num_envs=2, **settings),
    "singles": lambda **settings: gym.make_vec(SINGLE, num_envs=2, **settings),
    "rows": HAVVecEnv,
}
SETTINGS = [
    ({"scenario": "moon"}, ValueError, "unknown scenario 'moon'; known: paper-single"),
    ({"scenario": "no.json"}, ValueError, "no scenario file no.json"),
    ({"scenario": 3}, TypeError, "3 is not a scenario"),
    ({"num_havs": 0}, ValueError, "num_havs is 0"),
    ({"num_havs": -1}, ValueError, "num_havs is -1"),
    ({"num_havs": 2.5}, (TypeError, ValueError), "num_havs is 2.5"),
    ({"observation": Observation(-1)}, ValueError, "observation neighbors is -1"),
    ({"observation": Observation(1.5)}, ValueError, "observation neighbors is 1.5"),
    ({"reward": Reward(goal=np.inf)}, ValueError, "reward goal is inf"),
    ({"reward": Reward(time=np.nan)}, ValueError, "reward time is nan"),
    ({"reward": "much"}, ValueError, "unknown reward 'much'; known: default"),
    ({"frame_skip": 0}, ValueError, "frame_skip is 0"),
    ({"frame_skip": 1.5}, ValueError, "frame_skip is 1.5"),
    ({"max_steps": 0}, ValueError, "max_steps is 0"),
    ({"max_steps": 1.5}, ValueError, "max_steps is 1.5"),
    ({"on_goal": "explode"}, ValueError, "on_goal is 'explode', but must be park or remove"),
    ({"on_jackknife": "stop"}, ValueError, "on_jackknife is 'stop'"),
    ({"on_collision": 1}, ValueError, "on_collision is 1"),
    ({"info": "never"}, ValueError, "info is 'never', but must be always or ends"),
    ({"info": True}, ValueError, "info is True, but must be always or ends"),
    ({"threads": -1}, ValueError, "threads is -1"),
    ({"threads": 1.5}, (TypeError, ValueError), "threads is 1.5"),
    ({"task": Task(dt=-1.0)}, ValueError, "dt is -1.0"),
    ({"speed": 3}, TypeError, "unknown argument 'speed'"),
    ({"max_cycle": 3}, TypeError, "did you mean 'max_cycles'"),
    ({"scenari": "field-1"}, TypeError, "did you mean 'scenario'"),
    ({"observation": 3}, TypeError, "observation"),
    ({"task": {"dt": 0.1}}, TypeError, "task"),
    ({"vehicle": "car"}, ValueError, "unknown vehicle 'car'; known: on_axle"),
    ({"reward": Reward(goal="much")}, (TypeError, ValueError), "reward goal is much"),
    ({"controlled": 1}, TypeError, "controlled"),
    ({"render_mode": "hologram"}, ValueError, "render_mode is 'hologram'"),
]


# Gymnasium warns before this project raises an error
@pytest.mark.filterwarnings("ignore:.*hologram")
@pytest.mark.parametrize(("settings", "error", "message"), SETTINGS, ids=str)
@pytest.mark.parametrize("make", list(MAKERS.values()), ids=MAKERS)
def test_a_setting_that_cannot_be_is_named(make, settings, error, message):
    with pytest.raises(error, match=re.escape(message)):
        make(**settings)


@pytest.mark.parametrize(
    ("name", "settings", "message"),
    [
        (SWARM, {"team_reward": "max"}, "team_reward is 'max', but must be one of mean, sum, min"),
        (SINGLE, {"others": "ghost", "num_havs": 2}, "unknown policy 'ghost'"),
    ],
)
def test_what_only_one_environment_takes_is_named_too(name, settings, message):
    for make in (gym.make, gym.make_vec):
        with pytest.raises(ValueError, match=message):
            make(name, **settings)


@pytest.mark.parametrize("name", ["parallel", "swarm", "swarms", "rows"])
def test_a_policy_for_others_is_unknown_where_there_are_none(name):
    with pytest.raises(TypeError, match="unknown argument 'others'"):
        MAKERS[name](others="avoid_jack")


@pytest.mark.parametrize("cycles", [0, -1, 2.5, "many"])
def test_a_number_of_cycles_that_cannot_be_is_named(cycles):
    with pytest.raises((TypeError, ValueError), match=f"max_(cycles|steps) is '?{cycles}"):
        parallel_env(max_cycles=cycles)


POSES, GOALS = [[0, 0, 0], [50, 0, 0]], [[[99, 0, 0]] * 2, [[99, 90, 0]] * 2]
UNITS = [[3.0, 4.0]] * 2
OPTIONS = [
    (
        {"start": [[0, 0, 0], [5, 0, 0]], "lengths": UNITS},
        "starts of HAVs 0 and 1 are 5.00 m apart",
    ),
    (
        {"goals": [[[0, 0, 0]] * 2] * 2, "lengths": UNITS},
        "goals 1 of HAVs 0 and 1 are 0.00 m apart",
    ),
    ({"start": [[0, 0, 0]]}, "2 HAVs have lengths, 1 a start and 2 goals"),
    ({"goals": GOALS[:1]}, "2 HAVs have lengths, 2 a start and 1 goals"),
    ({"lengths": UNITS[:1]}, "1 HAVs have lengths, 2 a start and 2 goals"),
    (
        {"lengths": UNITS[:1], "start": POSES[:1], "goals": GOALS[:1]},
        "reset got 1 HAVs, but needs 2",
    ),
    (
        {"lengths": UNITS, "start": POSES, "goals": [GOALS[0][:1], GOALS[1][:1]]},
        "reset got 1 goals of each HAV, but needs 2",
    ),
    (
        {"lengths": [[3.0, 4.0], [3.0, *[1.0] * 11]], "start": POSES, "goals": GOALS},
        "11 trailers, but .* space for 10",
    ),
    (
        {"lengths": [[3.0], [3.0, 4.0]]},
        "HAV 0 needs the lengths of a truck and at least one trailer",
    ),
    ({"lengths": [[3.0, -4.0], [3.0, 4.0]]}, r"HAV 0 has lengths \[3.0, -4.0\]"),
    ({"start": [[0, 0], [50, 0]]}, r"HAV 0: \[0, 0\] is not a pose"),
    (
        {"start": [[np.nan, 0, 0], [50, 0, 0]], "lengths": UNITS},
        "HAV 0 has a pose that is not finite",
    ),
    ({"episode": -1}, "episode is -1, but must be from 0 to 4294967295"),
    ({"episode": 1.5}, "episode is 1.5, but must be from 0 to 4294967295, a whole"),
]
SINGLES = {k: MAKERS[k] for k in ("parallel", "one by one", "swarm")}


@pytest.mark.parametrize(("options", "message"), OPTIONS, ids=str)
@pytest.mark.parametrize("make", list(SINGLES.values()), ids=SINGLES)
def test_a_world_that_cannot_be_is_described(make, options, message):
    env = make()
    with pytest.raises(ValueError, match=message):
        env.reset(seed=0, options=options)


@pytest.mark.parametrize("make", list(SINGLES.values()), ids=SINGLES)
def test_after_an_error_in_reset_the_environment_can_be_reset(make):
    spoilt, fresh = make(), make()
    for options, _ in OPTIONS:
        with pytest.raises(ValueError, match=r"."):
            spoilt.reset(seed=0, options=options)
    one, other = (env.reset(seed=5) or env.observe("hav_0") for env in (spoilt, fresh))
    assert exactly(one) == exactly(other)


@pytest.mark.parametrize("seed", [-1, 2**32, 2**70])
def test_a_seed_that_cannot_be_is_named(seed):
    with pytest.raises(ValueError, match=f"seed is {seed}, but must be from 0 to 4294967295"):
        parallel_env().reset(seed=seed)
    if seed >= 0:  # Gymnasium itself looks at the sign
        with pytest.raises(ValueError, match=f"seed is {seed}"):
            gym.make(SWARM).reset(seed=seed)


def test_an_option_that_is_not_known_is_named_in_a_warning():
    with pytest.warns(UserWarning, match="reset ignores the option 'colour'; known: episode"):
        parallel_env().reset(seed=0, options={"colour": "red"})


AGENTS = [
    ({"hav_0": np.zeros(2)}, "there is no action for hav_1"),
    ({}, "there is no action for hav_0"),
    ({"hav_0": np.zeros(2), "hav_1": np.zeros(3)}, r"action of hav_1 has shape \(3,\)"),
    ({"hav_0": 0.5, "hav_1": np.zeros(2)}, r"action of hav_0 has shape \(\)"),
    ({f"hav_{k}": np.zeros(2) for k in range(3)}, "no agent 'hav_2' to act; agents: hav_0, hav_1"),
    ({"hav_0": np.zeros(2), "hav_1": np.full(2, np.nan)}, "hav_1 holds nan, but must be finite"),
    ({"hav_0": np.zeros(2), "hav_1": np.full(2, np.inf)}, "hav_1 holds inf, but must be finite"),
]


@pytest.mark.parametrize(("actions", "message"), AGENTS, ids=str)
def test_actions_of_agents_that_cannot_be_are_named_and_change_nothing(actions, message):
    spoilt, other = parallel_env(), parallel_env()
    for env in (spoilt, other):
        env.reset(seed=0)
    with pytest.raises(ValueError, match=message):
        spoilt.step(actions)
    proper = {"hav_0": np.ones(2), "hav_1": np.ones(2)}
    for one, two in zip(*(env.step(proper)[0].values() for env in (spoilt, other)), strict=True):
        assert np.array_equal(one, two)


@pytest.mark.parametrize("shape", [(2,), (2, 3), (3, 2), (1, 2, 2), ()])
def test_a_joint_action_of_another_shape_is_named(shape):
    env = gym.make(SWARM).unwrapped
    env.reset(seed=0)
    with pytest.raises(ValueError, match=re.escape(f"shape {shape}, but must have (2, 2)")):
        env.step(np.zeros(shape))


@pytest.mark.parametrize("number", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize(("name", "shape"), [(SWARM, (2, 2)), (SINGLE, (2,))])
def test_an_action_that_is_not_finite_is_named(name, shape, number):
    env = gym.make(name).unwrapped
    env.reset(seed=0)
    with pytest.raises(ValueError, match=f"the action holds {number}, but must be finite"):
        env.step(np.full(shape, number))


def test_a_step_before_the_first_reset_is_an_error():
    with pytest.raises(RuntimeError, match="call reset before step"):
        parallel_env().step({"hav_0": np.zeros(2)})
    for name in (SWARM, SINGLE):
        env = gym.make(name).unwrapped
        with pytest.raises(RuntimeError, match="call reset before step"):
            env.step(np.zeros(env.action_space.shape))


def test_a_step_of_one_after_the_other_before_the_first_reset_is_an_error():
    with pytest.raises(AttributeError, match="reset"):
        _ = one_by_one().agents


def in_fresh_python(script) -> subprocess.CompletedProcess:
    return subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=False
    )


def test_importing_takes_no_library_that_only_some_need():
    heavy = ("torch", "pygame", "matplotlib", "stable_baselines3", "baselines", "moviepy")
    found = in_fresh_python(
        f"import sys, hav_env; print(*[m for m in {heavy} if m in sys.modules])"
    )
    assert found.stderr == ""
    assert found.stdout.split() == []


def test_stepping_without_drawing_takes_none_either():
    found = in_fresh_python(
        "import sys, numpy, hav_env; env = hav_env.parallel_env(); env.reset(seed=0);"
        "env.step(dict.fromkeys(env.agents, numpy.zeros(2)));"
        "print(*[m for m in ('torch', 'pygame', 'matplotlib', 'baselines') if m in sys.modules])"
    )
    assert found.returncode == 0, found.stderr
    assert found.stdout.split() == []


@pytest.mark.parametrize("render_mode", ["rgb_array", "human"])
def test_a_missing_library_is_named_with_the_command_that_installs_it(render_mode):
    found = in_fresh_python(
        "import sys; sys.modules['pygame'] = None; import hav_env;"
        f"hav_env.parallel_env(render_mode={render_mode!r})"
    )
    last = found.stderr.strip().splitlines()[-1]
    assert last.startswith("ImportError")
    assert re.search(r"pip install -e .*\[rendering\]", last)
