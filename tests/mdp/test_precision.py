"""Worlds in single precision: near those in double, with the same starts and the same bits."""

import gymnasium as gym
import numpy as np
import pytest

from hav_env import Batch, SafetyFilter, find_scenario, parallel_env
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.world.arrays import NEVER, OBSTACLE, REMOVED, WHEN
from hav_env.world.place.segments import NEXT_DUE
from hav_env.world.units.parts import arrays_in
from tests.support.budgets import budget
from tests.support.comparing import exactly
from tests.support.obstacles import touching_walls

SWARM, SINGLE = "hav_env:HAVSwarm-v0", "hav_env:HAVSingle-v0"
WORLDS, STEPS = budget(70, 3), budget(120, 8)


def begun(worlds=WORLDS, **settings):
    process = DecisionProcess(worlds, **settings)
    outcome = process.outcome()
    keys = np.full(worlds, 3), np.arange(worlds), np.ones(worlds, np.bool_)
    process.begin(*keys, outcome)
    return process, outcome


def actions(worlds, steps=STEPS, havs=2):
    """Return actions that turn and drive, each held for ten steps."""
    rng = np.random.default_rng(4)
    drawn = rng.uniform((-0.2, -1.0), (1.0, 1.0), (steps // 10 + 1, worlds, havs, 2))
    return np.repeat(drawn, 10, axis=0)[:steps].astype(np.float32)


def test_worlds_drive_nearly_as_in_double_precision():
    (double, _), (single, _) = begun(), begun(precision="single")
    for action in actions(WORLDS):
        seen, seen_too = double.step(action), single.step(action)
        assert seen_too.reward == pytest.approx(seen.reward, abs=1e-3)
        assert exactly(seen_too.terminated) == exactly(seen.terminated)
        off = np.abs(seen_too.observation - seen.observation)
        assert np.quantile(off, 0.999) < 1e-4  # equally short paths may swap
    state, state_too = double.batch.worlds.state, single.batch.worlds.state
    assert state_too.x.dtype == np.float32
    assert state_too.x == pytest.approx(state.x, abs=2e-3)
    assert state_too.heading == pytest.approx(state.heading, abs=1e-4)


def test_episodes_begin_in_double_precision():
    (double, first), (single, first_too) = begun(), begun(precision="single")
    assert exactly(first_too) == exactly(first)
    rounded = double.batch.worlds.state.x.astype(np.float32)
    assert exactly(single.batch.worlds.state.x) == exactly(rounded)


@pytest.mark.parametrize("threads", [1, 2])
def test_a_world_has_the_same_bits_in_any_batch(threads):
    many, _ = begun(precision="single", threads=threads)
    alone, _ = begun(1, precision="single")
    for action in actions(WORLDS, budget(60, 6)):
        seen, seen_too = many.step(action), alone.step(action[:1])
        assert exactly(seen_too.observation[0]) == exactly(seen.observation[0])
        assert exactly(seen_too.reward[:, 0]) == exactly(seen.reward[:, 0])


def test_interfaces_have_the_same_bits():
    agents = parallel_env(precision="single")
    vector = gym.make_vec(SWARM, num_envs=2, precision="single", flatten=False)
    first, _ = agents.reset(seed=5)
    seen, _ = vector.reset(seed=[5, 6])
    for action in actions(2, budget(40, 5)):
        assert [exactly(row) for row in first.values()] == [exactly(row) for row in seen[0]]
        first, *_ = agents.step(dict(zip(agents.agents, action[0], strict=True)))
        seen, *_ = vector.step(action)


@pytest.mark.exhaustive
@pytest.mark.parametrize("others", ["avoid_jack", "ppo_pair", "reserve"])
def test_policies_drive_other_havs(others):
    places = []
    for precision in ("double", "single"):
        env = gym.make_vec(SINGLE, num_envs=5, num_havs=3, others=others, precision=precision)
        env.reset(seed=2)
        for _ in range(budget(50, 4)):
            env.step(np.tile(np.float32([1.0, 0.1]), (5, 1)))
        places.append(env.unwrapped._process.batch.worlds.state.x.astype(float))
    assert places[1] == pytest.approx(places[0], abs=2e-3)


def test_every_float_of_a_world_is_single():
    process, _ = begun(precision="single")
    kinds = {array.dtype.name for array in arrays_in(process.batch.worlds)}
    assert "float64" not in kinds
    size = sum(array.nbytes for array in arrays_in(process.batch.worlds))
    assert size < 0.6 * WORLDS * process.batch.bytes_per_world


def test_removed_havs_stay_apart():
    """Their places are so far away that float32 has only every millionth metre there."""
    process, _ = begun(
        precision="single", on_goal="remove", distance_tolerance=100.0, heading_tolerance=3.2
    )
    for action in actions(WORLDS, 6):
        seen = process.step(action)
    gone = process.batch.worlds.record.total[:, REMOVED] == 1.0
    assert gone.all(axis=0).any()
    assert np.isfinite(seen.observation).all()
    assert len(np.unique(process.batch.worlds.state.x[:, gone.all(axis=0)])) == 2


@pytest.mark.exhaustive
def test_hits_of_obstacles_are_those_of_a_brute_force_after_many_metres():
    """Sums of driven distances are so large by then that float32 has only 0.5 m there."""
    process, _ = begun(
        budget(40, 2),
        precision="single",
        scenario="field-1",
        vehicle="realistic",
        guidance="dubins",
    )
    worlds, before = process.batch.worlds, np.float32(2.0**22)
    worlds.place.due[:] += before
    worlds.place.driven[:, : NEXT_DUE + 1] += before
    expected = np.full((1, worlds.lanes), NEVER)
    for step, action in enumerate(actions(worlds.lanes, budget(200, 8), 1), 1):
        process.step(np.float32([0.2, 1.0]) * action - np.float32([0.8, 0.0]))  # slow
        new = touching_walls(worlds).any(axis=1) & (expected == NEVER)
        expected[new] = step
        assert exactly(worlds.record.first[:, OBSTACLE, WHEN]) == exactly(expected), step
    assert (expected != NEVER).mean() >= budget(0.2, 0.0)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"safety": "jackknife"}, "precision is 'single', but must be 'double' with a safety"),
        ({"safety": SafetyFilter()}, "precision is 'single', but must be 'double' with a safety"),
        ({"backup": "reserve"}, "precision is 'single', but must be 'double' with a safety"),
        (
            {"scenario": "field-1", "vehicle": "realistic", "guidance": "witness"},
            "precision is 'single', but must be 'double' with Witness",
        ),
        ({"precision": "half"}, "precision is 'half', but must be double or single"),
    ],
)
def test_what_it_does_not_cover_is_refused(settings, message):
    with pytest.raises(ValueError, match=message):
        parallel_env(**{"precision": "single"} | settings)


def test_a_batch_in_single_precision_does_not_reset():
    with pytest.raises(RuntimeError, match='reset needs precision="double"'):
        Batch(find_scenario("paper-pair"), precision="single").reset(0)
