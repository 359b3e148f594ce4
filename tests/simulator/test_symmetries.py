"""Neither the position of a world nor the order of its HAVs matters."""

import numpy as np
import pytest

from hav_env import Limited, Observation, OnAxle, RandomPoses, parallel_env
from tests.support.budgets import budget

NUM_HAVS = 4
VEHICLES = pytest.mark.parametrize(
    "vehicle", [OnAxle(), OnAxle(actuators=Limited())], ids=["instant", "limited"]
)


def written_down(seed):
    """Return the lengths, start poses and goals of an episode, as reset takes them."""
    env = parallel_env(num_havs=NUM_HAVS)
    env.reset(seed=seed)
    worlds = env._world.process.batch.worlds
    units = worlds.fleet.num_trailers[:, 0] + 1
    state = worlds.state
    return {
        "lengths": [worlds.fleet.length[k, :n, 0].tolist() for k, n in enumerate(units)],
        "start": np.stack([state.x[:, 0], state.y[:, 0], state.heading[:, 0, 0]], axis=-1),
        "goals": worlds.goals[..., 0].copy(),
    }


def moved(options, shift, turn):
    """Return the same world turned about the origin, then shifted."""

    def move(poses):
        places = (poses[..., 0] + 1j * poses[..., 1]) * np.exp(1j * turn) + shift
        return np.stack([places.real, places.imag, poses[..., 2] + turn], axis=-1)

    start, goals = move(options["start"]), move(options["goals"])
    return {"lengths": options["lengths"], "start": start, "goals": goals}


def reordered(options, order):
    return {
        "lengths": [options["lengths"][k] for k in order],
        "start": options["start"][order],
        "goals": options["goals"][order],
    }


def play(options, order, steps, vehicle):
    """Return observations, rewards and numbers of info, in the order of the HAVs as written.

    The HAV at place p of the options takes the actions of HAV order[p].
    """
    env = parallel_env(
        scenario=RandomPoses(num_havs=NUM_HAVS),
        observation=Observation(neighbors=NUM_HAVS - 1, chains=True, motion=True),
        vehicle=vehicle,
    )
    rng = np.random.default_rng(9)
    actions = rng.uniform(-1, 1, (steps, NUM_HAVS, 2))
    actions[:, :, 0] = 1.0  # far, so that they meet
    observations, infos = env.reset(seed=1, options=options)
    places = np.argsort(order)
    agents = [f"hav_{place}" for place in places]
    told = [([observations[a] for a in agents], [0.0] * NUM_HAVS, [infos[a] for a in agents])]
    for action in actions:
        chosen = {f"hav_{place}": action[k] for place, k in enumerate(order)}
        observations, rewards, _, _, infos = env.step(chosen)
        columns = observations, rewards, infos
        told.append(tuple([column[a] for a in agents] for column in columns))
    seen, rewards, infos = zip(*told, strict=True)
    names = [name for name in infos[0][0] if name != "collision_partner"]
    numbers = np.array([[[info[name] for name in names] for info in row] for row in infos])
    partners = np.array([[int(info["collision_partner"]) for info in row] for row in infos])
    named = np.append(order, -1)[partners]  # by the HAVs as written
    return np.array(seen), np.array(rewards), numbers, named


@VEHICLES
@pytest.mark.parametrize("order", [[1, 0, 2, 3], [3, 2, 1, 0], [2, 3, 0, 1], [1, 2, 3, 0]])
@pytest.mark.parametrize("seed", range(budget(5, 1)))
def test_who_comes_first_does_not_matter(order, seed, vehicle):
    options, steps = written_down(seed), budget(400, 10)
    plain = play(options, [0, 1, 2, 3], steps, vehicle)
    other = play(reordered(options, order), order, steps, vehicle)
    for one, two in zip(plain, other, strict=True):
        assert np.abs(two - one).max() <= 1e-6


@VEHICLES
@pytest.mark.parametrize(
    ("shift", "turn"), [(0j, 2.5), (300 - 700j, 0.0), (-40 + 90j, -1.1), (0j, np.pi)]
)
@pytest.mark.parametrize("seed", range(budget(5, 1)))
def test_where_the_world_lies_does_not_matter(shift, turn, seed, vehicle):
    options, steps = written_down(seed), budget(400, 10)
    plain = play(options, [0, 1, 2, 3], steps, vehicle)
    other = play(moved(options, shift, turn), [0, 1, 2, 3], steps, vehicle)
    for one, two in zip(plain, other, strict=True):
        assert np.abs(two - one).max() <= 1e-6


def test_a_world_written_down_is_the_one_that_was_drawn():
    options = written_down(3)
    env = parallel_env(num_havs=NUM_HAVS)
    drawn, _ = env.reset(seed=3)
    written, _ = env.reset(seed=8, options=options)
    for agent in env.agents:
        assert written[agent] == pytest.approx(drawn[agent], abs=1e-6)
