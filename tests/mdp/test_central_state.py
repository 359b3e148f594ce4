"""A central critic observes the whole world."""

import numpy as np
import pytest
import shapely

from hav_env import Batch, Field, OffAxle, OnAxle, Rectangles, build_site, explicit, parallel_env
from hav_env.envs.gymnasium_vector import HAVSwarmVectorEnv
from hav_env.envs.stable_baselines3 import HAVVecEnv
from hav_env.mdp.central_state import CentralState
from hav_env.vehicles import VEHICLES
from hav_env.world.arrays import FOOTPRINT
from tests.support.budgets import budget
from tests.support.obstacles import wall_shapes
from tests.support.worlds import catalogue_like, open_plane


def made(**settings):
    env = parallel_env(**settings)
    env.reset(seed=6)
    return env, dict(zip(env._state.names, range(len(env._state.names)), strict=True))


def test_entries_have_names_of_their_own_and_fill_the_space():
    for num_havs in (1, 2, 5):
        env, places = made(num_havs=num_havs)
        assert env.state().shape == env.state_space.shape == (len(places),)
        assert len({name for name in places if name.startswith("hav_")}) == len(places) - 1


@pytest.mark.parametrize(
    "scenario", ["paper-pair", "swarm-10", pytest.param("yard-4", marks=pytest.mark.exhaustive)]
)
def test_the_state_is_the_arrays_of_the_world(scenario):
    env, places = made(scenario=scenario, max_steps=100)
    worlds, rng = env._world.process.batch.worlds, np.random.default_rng(0)
    for step in range(budget(40, 4)):
        state = env.state()
        assert state.dtype == np.float32
        assert env.state_space.contains(state)
        assert state[places["time"]] == pytest.approx(step / 100)
        for k in range(len(env.possible_agents)):
            own = {
                n.removeprefix(f"hav_{k}_"): state[i] for n, i in places.items() if f"hav_{k}_" in n
            }
            now, trailers = worlds.state, worlds.fleet.num_trailers[k, 0]
            headings = now.heading[k, : trailers + 1, 0]
            expected = {
                "present": 1.0,
                "waits": 0.0,
                "goals_left": 1.0,
                "x": now.x[k, 0] / 100,
                "y": now.y[k, 0] / 100,
                "heading_cosine": np.cos(headings[0]),
                "heading_sine": np.sin(headings[0]),
                "goal_x": worlds.goals[k, 0, 0, 0] / 100,
                "goal_y": worlds.goals[k, 0, 1, 0] / 100,
                "goal_heading_cosine": np.cos(worlds.goals[k, 0, 2, 0]),
                "goal_heading_sine": np.sin(worlds.goals[k, 0, 2, 0]),
            }
            for unit in range(trailers + 1):
                expected[f"length_{unit}"] = worlds.fleet.length[k, unit, 0] / 10
            for joint in range(1, trailers + 1):
                bend = headings[joint] - headings[joint - 1]
                expected[f"articulation_cosine_{joint}"] = np.cos(bend)
                expected[f"articulation_sine_{joint}"] = np.sin(bend)
            for name, value in own.items():
                assert value == pytest.approx(expected.get(name, 0.0), abs=1e-5), name
            assert sum(own[f"length_{j}"] for j in range(1, 11)) * 10 == pytest.approx(
                worlds.fleet.radius[k, FOOTPRINT, 0], rel=1e-5
            )
        env.step({agent: rng.uniform(-1, 1, 2) for agent in env.agents})


def test_vector_environments_return_the_states_of_their_worlds():
    """Each row is the state of the single environment with the seed of the world."""
    envs, rows = HAVSwarmVectorEnv(3, num_havs=2), HAVVecEnv(3, num_havs=2)
    for vector in (envs, rows):
        with pytest.raises(RuntimeError, match="call reset before state"):
            vector.state()
    envs.reset(seed=[6, 8, 10])
    rows.seed(6)  # row k begins with seed 6 + k, and the rows of a world with its first one
    rows.reset()
    singles = []
    for seed in (6, 8, 10):
        single = parallel_env(num_havs=2)
        single.reset(seed=seed)
        singles.append(single)
    actions = np.random.default_rng(0).uniform(-1, 1, (3, 2, 2))
    for _ in range(3):
        expected = np.stack([single.state() for single in singles])
        assert envs.state().tobytes() == rows.state().tobytes() == expected.tobytes()
        assert all(envs.single_state_space.contains(state) for state in envs.state())
        envs.step(actions)
        rows.step(actions.reshape(6, 2))
        for single, own in zip(singles, actions, strict=True):
            single.step(dict(zip(single.agents, own, strict=True)))


@pytest.mark.exhaustive
def test_hitches_and_bodies_are_in_the_state_of_vehicles_that_have_them():
    """Other vehicles have only the names of the paper's."""
    paper = CentralState(open_plane(1, 2, 3)).names
    for vehicle in (OnAxle(bodies=Rectangles()), OffAxle(), OffAxle(bodies=Rectangles())):
        hitched, wide = vehicle != OnAxle(bodies=Rectangles()), vehicle != OffAxle()
        batch = catalogue_like(vehicle) if hitched else open_plane(1, 2, 3, vehicle=vehicle)
        fleet, central = batch.worlds.fleet, CentralState(batch)
        fleet.num_trailers[1] = 2
        told = dict(zip(central.names, central.read(), strict=True))
        assert central.space.contains(central.read())
        assert [name for name in told if name in paper] == list(paper)
        expected = {}
        for hav, trailers in enumerate(fleet.num_trailers[:, 0]):
            for joint in range(1, 4) if hitched else ():
                there = joint <= trailers
                offset = fleet.joints.offset[hav, joint - 1, 0] / 10.0 * there
                limit = fleet.joints.limit[hav, joint, 0] / np.pi * there
                expected[f"hav_{hav}_hitch_offset_{joint}"] = offset
                expected[f"hav_{hav}_articulation_limit_{joint}"] = limit
            for unit in range(4) if wide else ():
                body = fleet.bodies.shape[hav, unit, :, 0] / 10.0 * (unit <= trailers)
                parts = "half_width", "front_overhang", "rear_overhang"
                expected |= {f"hav_{hav}_{part}_{unit}": body[k] for k, part in enumerate(parts)}
        assert told.keys() - set(paper) == expected.keys()
        for name, value in expected.items():
            assert told[name] == pytest.approx(value), name
        assert min(expected.values()) < 0.0 or not hitched


@pytest.mark.parametrize("far", [0.0, 2e6])
@pytest.mark.exhaustive
def test_the_segments_of_the_place_are_in_the_state(far):
    """In the frame of all positions; planes have only the names of the plane."""
    walls = np.array([[[20.0, 0.0], [20.0, 9.0]], [[-7.0, -30.0], [40.0, -25.0]]]) + far
    start, goals = [[far, far, 0.0]], [[[far + 30.0, far, 0.0]]]
    batch = Batch(explicit([[3.0, 4.0]], start, goals, site=build_site(lines=walls)))
    batch.reset(6)
    central = CentralState(batch)
    told = dict(zip(central.names, central.read(), strict=True))
    assert central.space.contains(central.read())
    paper = CentralState(open_plane(1, 1, 1)).names
    assert tuple(told)[: len(paper)] == paper
    assert told["segments_share"] == 1.0
    truck, goal = (np.array([told[f"hav_0_{n}x"], told[f"hav_0_{n}y"]]) for n in ("", "goal_"))
    assert goal - truck == pytest.approx([0.3, 0.0], abs=1e-5)
    for k, wall in enumerate(walls):
        for name, end in zip(("start", "end"), wall, strict=True):
            seen = np.array([told[f"segment_{k}_{name}_x"], told[f"segment_{k}_{name}_y"]])
            assert seen - truck == pytest.approx((end - far) / 100.0, abs=1e-5)


@pytest.mark.exhaustive
def test_segments_that_a_world_does_not_have_are_zeros():
    """Walls of random worlds are where Shapely has them."""
    batch = Batch(Field(num_segments=5), 2, vehicle=VEHICLES.make("realistic"))
    batch.reset(4)
    central, walls = CentralState(batch), wall_shapes(batch.worlds)
    first = central.names.index("segment_0_start_x")
    for w, count in enumerate((5, 2)):
        batch.worlds.place.count[w] = count
        told = central.read(w)[first:]
        assert told.shape == (4 * 5 + 1,)
        seen = shapely.linestrings(100.0 * told[:-1].reshape(5, 2, 2))
        assert (shapely.hausdorff_distance(seen, walls[:, w])[:count] < 1e-4).all()
        assert not told[4 * count : -1].any()
        assert told[-1] == pytest.approx(count / 5)


@pytest.mark.parametrize(
    "vehicle",
    [OnAxle(), pytest.param(OffAxle(bodies=Rectangles()), marks=pytest.mark.exhaustive)],
)
def test_the_states_of_all_worlds_are_those_of_each(vehicle):
    batch = catalogue_like(vehicle) if vehicle != OnAxle() else open_plane(3, 2, 3)
    state, rng = batch.worlds.state, np.random.default_rng(0)
    state.x[:] += rng.normal(0.0, 10.0, state.x.shape)
    batch.worlds.fleet.num_trailers[0] = 1
    central = CentralState(batch)
    states = central.read_worlds()
    assert states.shape == (batch.num_worlds, len(central.names))
    assert states.flags.c_contiguous
    for w in range(batch.num_worlds):
        assert states[w].tobytes() == central.read(w).tobytes()
    assert np.array_equal(central.read_worlds(slice(1, None)), states[1:])
    if batch.num_worlds > 1:
        assert not np.array_equal(states[0], states[1])


def test_a_state_that_was_told_stays_as_it_was():
    env, _ = made()
    before = env.state()
    copy = before.copy()
    env.step(dict.fromkeys(env.agents, np.ones(2)))
    assert np.array_equal(before, copy)
    assert not np.shares_memory(before, env.state())
