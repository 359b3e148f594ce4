"""What a central critic sees is the whole world, and all of it."""

import numpy as np
import pytest

from hav_env import OffAxle, OnAxle, Rectangles, parallel_env
from hav_env.mdp.central_state import CentralState
from hav_env.world.arrays import FOOTPRINT
from tests.support.budgets import budget
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


@pytest.mark.parametrize("scenario", ["paper-pair", "swarm-10", "yard-4"])
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


def test_hitches_and_bodies_are_in_the_state_of_vehicles_that_have_them():
    """Others have the names of the paper's alone."""
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


def test_a_state_that_was_told_stays_as_it_was():
    env, _ = made()
    before = env.state()
    copy = before.copy()
    env.step(dict.fromkeys(env.agents, np.ones(2)))
    assert np.array_equal(before, copy)
    assert not np.shares_memory(before, env.state())
