"""The end of an episode, its agents, and the number of steps of an action."""

import itertools

import gymnasium as gym
import numpy as np
import pytest

from hav_env import Observation, Task, explicit, parallel_env
from hav_env.envs.hav_swarm_v0 import env as one_by_one
from tests.support.budgets import budget
from tests.support.comparing import exactly
from tests.support.worlds import side_by_side

AHEAD, STAND = np.array([1.0, 0.0]), np.array([-1.0, 0.0])
HAV = [3.0, 4.0]
# the second follows the first through its goal to a farther one
FOLLOWING = explicit(
    [HAV, HAV], [[0.0, 0.0, 0.0], [-15.0, 0.0, 0.0]], [[[2.0, 0.0, 0.0]], [[30.0, 0.0, 0.0]]]
)


def run(env, action=AHEAD, most=2_000):
    """Yield the results of every step of an episode, until no agent is left."""
    env.reset(seed=0)
    for _ in range(most):
        yield env.step(dict.fromkeys(env.agents, action))
        if not env.agents:
            return


def present(observation, env):
    """Return the number of others in a row."""
    columns = env._world.process.columns
    return sum(observation[i] for i, name in enumerate(columns) if name.endswith("_present"))


def hit_step(distance):
    """Return the step of 0.2 s in which the goal is nearer than 0.5 m."""
    return next(k for k in itertools.count(1) if distance - 0.2 * k < 0.5 - 1e-9)


def test_who_hit_the_last_goal_is_told_so_and_leaves():
    distances = [2.0, 4.0, 3.0]
    env = parallel_env(scenario=side_by_side(*distances), on_goal="remove")
    last = {f"hav_{k}": hit_step(distance) for k, distance in enumerate(distances)}
    for step, (observations, rewards, terminations, truncations, infos) in enumerate(run(env), 1):
        told = [agent for agent in env.possible_agents if step <= last[agent]]
        for dictionary in (observations, rewards, terminations, truncations, infos):
            assert list(dictionary) == told
        for agent in told:
            assert terminations[agent] == (step == last[agent])
            assert infos[agent]["is_success"] == infos[agent]["goals_hit"] == (step == last[agent])
            assert (rewards[agent] > 5.0) == (step == last[agent])
        assert env.agents == [agent for agent in told if step < last[agent]]
        assert not any(truncations.values())
    assert step == max(last.values())


@pytest.mark.parametrize("frame_skip", [1, 2, 5])
def test_what_is_told_last_was_seen_from_the_goal(frame_skip):
    env = parallel_env(scenario=side_by_side(2.0, 9.0), on_goal="remove", frame_skip=frame_skip)
    place = env._world.process.columns.index("goal_distance")
    for observations, _, terminations, _, infos in run(env):
        for agent, terminated in terminations.items():
            if terminated:
                assert infos[agent]["distance_to_goal"] < 0.5
                assert observations[agent][place] == pytest.approx(
                    np.log1p(infos[agent]["distance_to_goal"]) / np.log1p(1e4), abs=1e-6
                )
    assert not env.agents


def test_nobody_senses_or_touches_who_has_left():
    env = parallel_env(scenario=FOLLOWING, on_goal="remove")
    outcomes = list(run(env))
    for step, (observations, *_) in enumerate(outcomes, 1):
        assert present(observations["hav_1"], env) == (step <= hit_step(2.0))
    last = outcomes[-1][-1]["hav_1"]
    assert last["is_success"] == 1.0
    assert last["actual_collision"] == last["potential_collision"] == 0.0


def test_who_has_left_is_zero_in_the_central_state():
    env = parallel_env(scenario=FOLLOWING, on_goal="remove")
    names, before = env._state.names, 0
    gone = [name.startswith("hav_0_") for name in names]
    for step, _ in enumerate(run(env), 1):
        assert env.state()[gone].any() == (step <= hit_step(2.0))
        before += 1
    assert before > hit_step(2.0)


def test_who_parks_stays_an_agent_and_an_obstacle():
    env = parallel_env(scenario=FOLLOWING, on_goal="park", max_steps=400)
    place = None
    for observations, rewards, terminations, truncations, infos in run(env):
        assert present(observations["hav_1"], env) == 1.0
        if infos["hav_0"]["waits"] and place is not None:
            assert infos["hav_0"]["path_length"] == place
            assert rewards["hav_0"] == 0.0
        place = infos["hav_0"]["path_length"] if infos["hav_0"]["waits"] else None
        assert len(set(terminations.values())) == len(set(truncations.values())) == 1
    assert infos["hav_1"]["actual_collision"] == 1.0
    assert infos["hav_1"]["collision_partner"] == 0.0


def test_what_parks_does_whatever_it_is_told():
    """The actions of a HAV at its last goal have no effect."""
    outcomes = []
    for action in (AHEAD, STAND, np.array([0.3, 1.0])):
        env = parallel_env(scenario=side_by_side(2.0, 9.0))
        env.reset(seed=0)
        for step in range(30):
            first = AHEAD if step < hit_step(2.0) else action
            outcome = env.step({"hav_0": first, "hav_1": AHEAD})
        outcomes.append(exactly(outcome))
    assert outcomes[0] == outcomes[1] == outcomes[2]


ACCIDENTS = {
    # full lock at full speed folds a short truck with a long trailer
    "jackknife": ("jackknifed", explicit([[2.0, 11.0]], [[0, 0, 0]], [[[900, 0, 0]]]), [1.0, 1.0]),
    # two that reach one crossing at the same time
    "collision": (
        "actual_collision",
        explicit([HAV] * 2, [[0, 0, 0], [15, -15, 1.5]], [[[900, 0, 0]], [[-900, 0, 0]]]),
        [1.0, 0.0],
    ),
}


@pytest.mark.parametrize("rule", ["record", "end"])
@pytest.mark.parametrize("kind", ACCIDENTS)
def test_an_accident_ends_the_episode_in_its_step_or_is_recorded(kind, rule):
    record, scenario, action = ACCIDENTS[kind]
    limits = {"steering_max": 1.2} if kind == "jackknife" else {}
    scenario = scenario._replace(**limits)
    env = parallel_env(scenario=scenario, max_steps=300, **{f"on_{kind}": rule})
    happened = []
    for _, _, terminations, truncations, infos in run(env, np.array(action)):
        happened.append(max(info[record] for info in infos.values()) == 1.0)
        assert set(terminations.values()) == {happened[-1] and rule == "end"}
        assert set(truncations.values()) == {len(happened) == 300}
    assert happened[-1]
    assert len(happened) == (300 if rule == "record" else happened.index(True) + 1)


@pytest.mark.parametrize("on_goal", ["park", "remove"])
def test_who_arrives_in_the_last_step_is_terminated_not_truncated(on_goal):
    steps = hit_step(2.0)
    for max_steps in (steps - 1, steps, steps + 1):
        env = parallel_env(scenario=side_by_side(2.0), on_goal=on_goal, max_steps=max_steps)
        *_, (_, _, terminations, truncations, _) = run(env)
        assert terminations == {"hav_0": max_steps >= steps}
        assert truncations == {"hav_0": max_steps < steps}
        alone = gym.make(
            "hav_env:HAVSwarm-v0",
            scenario=side_by_side(2.0),
            on_goal=on_goal,
            max_steps=max_steps,
        )
        alone.reset(seed=0)
        flags = (False, False)
        while not any(flags):
            flags = alone.step(AHEAD[None].astype(np.float32))[2:4]
        assert flags == (max_steps >= steps, max_steps < steps)


def test_of_several_each_is_terminated_or_truncated_in_the_last_step():
    distances, steps = [2.0, 9.0], hit_step(2.0)
    env = parallel_env(scenario=side_by_side(*distances), on_goal="remove", max_steps=steps)
    *_, (_, _, terminations, truncations, _) = run(env)
    assert terminations == {"hav_0": True, "hav_1": False}
    assert truncations == {"hav_0": False, "hav_1": True}
    env = parallel_env(scenario=side_by_side(*distances), on_goal="park", max_steps=steps)
    *_, (_, _, terminations, truncations, _) = run(env)
    assert set(terminations.values()) == {False}
    assert set(truncations.values()) == {True}


@pytest.mark.parametrize("frame_skip", [1, 3, 7])
@pytest.mark.parametrize("cycles", [1, 10])
def test_an_episode_takes_so_many_cycles_however_long_each_is(frame_skip, cycles):
    env = parallel_env(max_cycles=cycles, frame_skip=frame_skip)
    assert env.max_cycles == cycles
    outcomes = list(run(env))
    assert len(outcomes) == cycles
    assert outcomes[-1][4]["hav_0"]["steps"] == cycles * frame_skip
    counted = one_by_one(max_cycles=cycles, frame_skip=frame_skip)
    counted.reset(seed=0)
    turns = 0
    for _ in counted.agent_iter():
        counted.step(acting(counted))
        turns += 1
    assert turns == 2 * cycles + 2  # two agents, and each steps once more when it is done


def acting(env):
    *_, terminated, truncated, _ = env.last()
    return None if terminated or truncated else AHEAD.astype(np.float32)


@pytest.mark.parametrize("frame_skip", [2, 5])
def test_an_action_is_held_for_so_many_steps(frame_skip):
    settings = {"num_havs": 3, "observation": Observation(neighbors=2), "task": Task(max_steps=999)}
    held = parallel_env(frame_skip=frame_skip, **settings)
    plain = parallel_env(**settings)
    rng = np.random.default_rng(4)
    for env in (held, plain):
        env.reset(seed=2)
    for _ in range(budget(100, 5)):
        actions = {agent: rng.uniform(-1, 1, 2) for agent in held.agents}
        seen, *_, infos = held.step(actions)
        for _ in range(frame_skip):
            seen_then, *_, infos_then = plain.step(actions)
        assert exactly(seen) == exactly(seen_then)
        for agent, info in infos.items():
            facts = [name for name in info if not name.startswith("return_")]
            assert {k: info[k] for k in facts} == {k: infos_then[agent][k] for k in facts}
            # potentials and events add up; running penalties are evaluated at the end
            for term in ("progress", "goal", "jackknife", "actual_collision", "time"):
                name = f"return_{term}"
                assert info[name] == pytest.approx(infos_then[agent][name], abs=1e-9)
