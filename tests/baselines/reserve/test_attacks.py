"""Attacks on Reserve's guarantees: random fleets, rules and densities, and HAVs that misbehave.

The contract allows a HAV to stand at any time and for any duration. A HAV without broadcast may
stand anywhere. It does not allow a HAV to drive otherwise than Reserve would. Against that, only
the guarantee without jackknifes holds.
"""

import math

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from baselines.policies.reserve import Reserve
from baselines.policies.reserve.memory import rows as m
from hav_env import PlacementError, RandomFleet, RandomPoses, Task
from tests.support.audit import drive
from tests.support.budgets import budget

WORLDS = budget(5, 1)
few = settings(max_examples=budget(15, 1))


def some(kind, **fields):
    """Return models of a kind: these fields are drawn, the others as they are by default."""
    return st.fixed_dictionaries(fields).map(lambda drawn: kind(**drawn))


fleets = some(
    RandomFleet,
    max_trailers=st.integers(1, 10),
    trailer_sigma=st.floats(0.5, 8.0),
    min_length=st.floats(0.5, 3.0),
    footprint_truck_share=st.sampled_from([0.0, 0.5, 1.0]),
    speed_max=st.floats(0.3, 2.0),
    steering_max=st.floats(math.radians(20.0), math.radians(58.0)),
    articulation_max=st.sampled_from([math.radians(50.0), math.pi / 2, 2.0]),
)
scenarios = some(
    RandomPoses,
    num_havs=st.integers(2, budget(8, 3)),
    num_goals=st.integers(1, 3),
    fleet=fleets,
    area_factor=st.floats(1.5, 4.0),
    pose_attempts=st.just(200),
    world_attempts=st.just(20),
)
seeds = st.integers(0, 2**32 - 1)
durations = st.floats(0.05, 0.5)
more_range = st.one_of(st.floats(1e-6, 3.0), st.floats(0.0, 200.0))


class Stops:
    """Lets HAVs stand for a while, again and again, and some without end, whatever they decided."""

    def __init__(self, seed, often, long, never_start=0.0):
        """Take the frequency and the duration of stops, and the share of HAVs that never start."""
        self.random = np.random.default_rng(seed)
        self.often, self.long, self.never_start = often, long, never_start
        self.left = None

    def __call__(self, step, memory, speed, steering):
        if self.left is None:
            held = self.random.random(speed.shape) < self.never_start
            self.left = np.where(held, 1_000_000, 0)
        begin = (self.left == 0) & (self.random.random(speed.shape) < self.often)
        self.left[begin] = self.random.integers(1, self.long + 1, np.count_nonzero(begin))
        speed[self.left > 0] = 0.0
        self.left[self.left > 0] -= 1


class Others:
    """Drives the HAVs from an index on, in place of Reserve, without broadcast."""

    def __init__(self, first, fastest=0.0, seed=0):
        """Take the number of the first of them and their largest speed [m/s]."""
        self.random = np.random.default_rng(seed)
        self.first, self.fastest = first, fastest

    def __call__(self, step, memory, speed, steering):
        memory[self.first :, : m.BROADCAST] = 0.0
        shape = speed[self.first :].shape
        speed[self.first :] = self.fastest * self.random.random(shape)
        steering[self.first :] = self.random.uniform(-1.0, 1.0, shape)


def attacked(scenario, seed, dt, extra, interfere=None, steps=None):
    """Return the findings of the audit; HAVs are in range before two could meet in one step."""
    task = Task(dt=dt, sensing_range=2.0 * scenario.fleet.speed_max * dt + extra)
    steps = budget(300, 2) if steps is None else steps
    try:
        return drive(
            *(scenario, seed, range(WORLDS), steps),
            policy=Reserve(dt=dt),
            task=task,
            interfere=interfere,
        )
    except PlacementError:
        assume(False)


@few
@given(scenarios, seeds, durations, more_range)
def test_random_fleets_and_rules(scenario, seed, dt, extra):
    attacked(scenario, seed, dt, extra).approve()


@few
@given(scenarios, seeds, durations, more_range, st.floats(0.001, 0.3), st.integers(1, 200))
def test_havs_that_stop_and_some_that_never_start(scenario, seed, dt, extra, often, long):
    stops = Stops(seed, often, long, never_start=0.1)
    attacked(scenario, seed, dt, extra, stops).approve()


@few
@given(scenarios, seeds, durations, more_range)
def test_havs_that_stand_and_tell_nothing(scenario, seed, dt, extra):
    attacked(scenario, seed, dt, extra, Others((scenario.num_havs + 1) // 2)).approve()


@few
@given(scenarios, seeds, durations, more_range)
def test_others_that_drive_at_random_cause_no_jackknife(scenario, seed, dt, extra):
    others = Others((scenario.num_havs + 1) // 2, 2.0, seed)
    seen = attacked(scenario, seed, dt, extra, others)
    limit = seen.worlds.fleet.limit[:, 2]
    assert (seen.largest < limit)[: others.first].all()


@few
@given(fleets, seeds, durations, st.floats(0.0, 0.3))
def test_a_hav_that_is_alone_and_stops(fleet, seed, dt, often):
    scenario = RandomPoses(fleet=fleet)
    attacked(scenario, seed, dt, 30.0, Stops(seed, often, 20), budget(600, 3)).approve()
