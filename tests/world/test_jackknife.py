"""A HAV is jackknifed when cos(articulation) < cos(limit), eq. (4)."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hav_env import OnAxle
from hav_env.world.arrays import JACKKNIFE, LARGEST, WHEN, WHERE
from hav_env.world.events import jackknifed
from tests.support.worlds import limit, open_plane, put, stand

LIMITS = [0.1, math.radians(60), math.pi / 2, 2.0, 3.1, math.pi]


@given(st.floats(0.01, math.pi), st.floats(-math.pi, math.pi))
def test_within_half_a_turn_the_cosine_says_what_the_angle_says(most, articulation):
    if abs(abs(articulation) - most) > 1e-6:
        assert jackknifed(articulation, most) == (abs(articulation) > most)
    assert jackknifed(-articulation, most) == jackknifed(articulation, most)


@pytest.mark.parametrize("most", LIMITS)
def test_the_limit_itself_is_allowed(most):
    assert not jackknifed(most, most)
    assert not jackknifed(-most, most)


def look(bends, most):
    """Record straight HAVs (worlds) that have these articulations (W, joints)."""
    batch = open_plane(len(bends), num_trailers=len(bends[0]))
    limit(batch.worlds, articulation=most)
    for w, joints in enumerate(bends):
        headings = np.r_[0.0, np.cumsum(joints)]
        put(batch.worlds, np.full(len(headings), 3.0), headings=headings, w=w)
    stand(batch)
    return batch.worlds.record


@pytest.mark.parametrize("most", LIMITS)
def test_what_is_recorded_is_the_inequality_of_the_paper(most):
    bends = np.r_[np.random.default_rng(7).uniform(-6.2, 6.2, 300), most, -most, 0.0]
    record = look(bends[:, None], most)
    beyond = np.cos(bends) < math.cos(most)
    assert record.first[0, JACKKNIFE, WHEN].tolist() == np.where(beyond, 1, -1).tolist()
    assert record.first[0, JACKKNIFE, WHERE].tolist() == np.where(beyond, 1, -1).tolist()
    assert record.total[0, LARGEST] == pytest.approx(np.abs(bends))


@pytest.mark.parametrize(
    ("joints", "which"),
    [([0.0, 0.0, 1.6], 3), ([0.1, -1.7, 0.2], 2), ([1.58, -1.9, 2.0], 1), ([1.5, -1.5, 1.5], -1)],
)
def test_the_first_joint_beyond_the_limit_is_recorded(joints, which):
    record = look([joints], math.pi / 2)
    assert record.first[0, JACKKNIFE, WHERE, 0] == which


def test_the_first_jackknife_stays_recorded():
    batch = open_plane()
    limit(batch.worlds)
    for bends in ([0.0, 0.0], [0.0, 1.6], [-2.0, 0.0], [0.0, 0.0]):
        put(batch.worlds, [3.0] * 3, headings=np.r_[0.0, np.cumsum(bends)])
        stand(batch)
    record = batch.world(0).record
    assert record.first[0, JACKKNIFE].tolist() == [2, 2]
    assert record.total[0, LARGEST] == 2.0


@pytest.mark.parametrize("most", [1.0, math.pi / 2])
def test_a_drive_on_a_tight_circle_jackknifes_when_the_equations_say_so(most):
    lengths, steering, headings = np.array([2.0, 5.0, 4.0]), 0.8, np.zeros(3)
    bent, step = np.array([]), 0
    while bent.size == 0:
        step += 1
        rates = [math.tan(steering) / lengths[0]]
        speed = 1.0
        for j in (1, 2):
            bend = headings[j] - headings[j - 1]
            rates.append(-speed / lengths[j] * math.sin(bend))
            speed *= math.cos(bend)
        headings = headings + 0.2 * np.array(rates)
        bent = np.flatnonzero(np.abs(np.diff(headings)) > most)
    batch = open_plane(vehicle=OnAxle(simultaneous=True))
    limit(batch.worlds, steering=1.0, articulation=most)
    put(batch.worlds, lengths)
    for _ in range(step + 20):
        batch.step(np.ones((1, 1)), np.full((1, 1), steering))
    assert batch.world(0).record.first[0, JACKKNIFE].tolist() == [step, bent[0] + 1]
    assert batch.world(0).record.total[0, LARGEST] > most


def test_a_hav_that_folds_through_shows_more_than_half_a_turn():
    batch = open_plane()
    limit(batch.worlds, steering=1.2)
    put(batch.worlds, [2.0, 9.0])
    for _ in range(300):
        batch.step(np.ones((1, 1)), np.full((1, 1), 1.2))
    record = batch.world(0).record
    assert record.total[0, LARGEST] > math.pi
    assert record.first[0, JACKKNIFE, WHERE] == 1
