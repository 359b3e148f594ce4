"""The audit measures what Shapely measures, and detects HAVs that jackknife or collide."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely import LineString, distance

from baselines.policies.avoid_jack import AvoidJack
from baselines.policies.dubins_pursuit import DubinsPursuit
from hav_env import RandomPoses, explicit
from tests.support.audit import (
    CONTACT,
    Audit,
    axles_of,
    chain_distances,
    drive,
    joints_of,
    pair_distances,
)
from tests.support.budgets import budget
from tests.support.worlds import chain, open_plane, put, sample

NOSE_TO_NOSE = explicit(
    [[4.0, 5.0], [4.0, 5.0]],
    [[0.0, 0.0, 0.0], [40.0, 0.0, np.pi]],
    [[[40.0, 0.0, 0.0]], [[0.0, 0.0, np.pi]]],
)


def as_complex(axles):
    """Return axles (A, 2) as the audit holds them."""
    return axles[:, 0] + 1j * axles[:, 1]


@given(st.integers(0, 10_000), st.floats(0.0, 20.0))
def test_distances_of_chains_are_those_of_shapely(seed, spread):
    random = np.random.default_rng(seed)
    chains = [
        chain(random.uniform(0.5, 5.0, 4), *random.uniform(-spread, spread, 2), bends)
        for bends in random.uniform(-np.pi, np.pi, (2, 4))
    ]
    one, other = (as_complex(axles)[None] for axles in chains)
    expected = distance(*map(LineString, chains))
    assert chain_distances(one, other) == pytest.approx(expected, abs=1e-9)


def test_axles_joints_and_pairs_of_worlds_are_those_of_their_havs():
    worlds = sample(RandomPoses(num_havs=3, area_factor=1.6), 4)
    put(worlds, [3.0, 2.0, 4.0], 1.0, 2.0, [0.1, 0.4, -0.2], w=1, agent=2)
    axles, state, fleet = axles_of(worlds), worlds.state, worlds.fleet
    assert joints_of(worlds)[2, :3, 1] == pytest.approx([0.3, 0.6, 0.0])
    for w in range(4):
        lines = []
        for hav in range(3):
            units = fleet.num_trailers[hav, w] + 1
            headings = state.heading[hav, :units, w]
            own = chain(fleet.length[hav, :units, w], state.x[hav, w], state.y[hav, w], headings)
            assert axles[hav, w, : units + 1] == pytest.approx(as_complex(own))
            assert (axles[hav, w, units:] == axles[hav, w, units]).all()
            lines.append(LineString(own))
        expected = [distance(lines[i], lines[j]) for i, j in ((0, 1), (0, 2), (1, 2))]
        found = pair_distances(axles)[:, w]
        near = np.isfinite(found)
        assert found[near] == pytest.approx(np.array(expected)[near])
        assert (np.array(expected)[~near] > 0.5).all()


@pytest.mark.parametrize("policy", [DubinsPursuit(), AvoidJack()])
def test_policies_that_collide_are_caught(policy):
    scenario = RandomPoses(num_havs=8, area_factor=1.5)
    found = drive(scenario, 5, range(budget(4, 1)), budget(400, 1), policy=policy)
    nose = drive(NOSE_TO_NOSE, 5, [0], 120, policy=DubinsPursuit())
    with pytest.raises(AssertionError, match="contact"):
        nose.approve()
    assert budget((found.least <= CONTACT).sum(), 1) > 0


def test_a_jackknife_is_caught():
    """A long trailer folds behind a truck that turns as tightly as it can."""

    def turn(step, memory, speed, steering):
        speed[:], steering[:] = 1.0, 1.0

    scenario = explicit([[4.0, 12.0]], [[0.0, 0.0, 0.0]], [[[99.0, 0.0, 0.0]]])
    found = drive(scenario, 5, [0], 300, policy=DubinsPursuit(), interfere=turn)
    with pytest.raises(AssertionError, match="jackknife"):
        found.approve()


def test_who_waits_and_moves_is_caught():
    batch = open_plane(num_havs=2, num_trailers=1)
    batch.worlds.state.waiting[1] = True
    audit = Audit(batch.worlds)
    audit.look()
    assert audit.restless == 0
    batch.worlds.state.x[0] += 1.0
    audit.look()
    assert audit.restless == 0
    batch.worlds.state.x[1] += 1e-9
    audit.look()
    assert audit.restless == 1


def test_pairs_that_touch_at_the_start_are_left_out():
    batch = open_plane(num_havs=2, num_trailers=1)
    put(batch.worlds, [4.0, 3.0], 0.0, 0.0, 0.0)
    put(batch.worlds, [4.0, 3.0], 1.0, 1.0, -1.0, agent=1)
    audit = Audit(batch.worlds)
    audit.look()
    audit.approve()
