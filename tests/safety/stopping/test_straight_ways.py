"""HAVs with off-axle hitches drive straight on from accepted postures, by another integrator."""

import numpy as np
import pytest

from hav_env import Batch, Limited, OffAxle, SafetyFilter, Task
from hav_env.compiled import canonical, entry
from hav_env.safety.stopping.braking import find_doubts
from hav_env.safety.trial_moves import IN_DOUBT, count_rows
from hav_env.scenarios.presets import scenario_of
from hav_env.world.arrays import SPEED
from hav_env.world.lanes import block_of
from tests.support.budgets import budget

DT, WAY = 0.2, 40.0  # [s], [m]
VEHICLE = OffAxle(actuators=Limited())


@entry
def _doubt_all(first, last, safety, task, vehicle, worlds, speed, steering, rows):
    block = block_of(worlds, first, last - first, worlds.units)
    find_doubts(safety, task, vehicle, block, 0, speed, steering, rows)


def bend_at_random(name, worlds, seed):
    """Return a batch whose lone HAVs stand, with random bends up to 0.7 of their limits."""
    batch = Batch(scenario_of("paper-single", fleet=name), worlds, Task(), VEHICLE, threads=1)
    batch.reset(seed)
    fleet, state = batch.worlds.fleet, batch.worlds.state
    shares = np.random.default_rng(seed).uniform(-0.7, 0.7, fleet.joints.limit[0].shape)
    bends = np.minimum(fleet.joints.limit[0], np.pi / 2) * shares
    bends[0] = state.heading[0, 0]
    state.heading[0] = np.cumsum(bends, axis=0)
    state.cosine[:], state.sine[:] = np.cos(state.heading), np.sin(state.heading)
    return batch


def find_all(batch, vehicle=VEHICLE, horizon=1_000):
    """Return which HAVs (W,) the filter is in doubt about."""
    worlds = batch.worlds
    headings = worlds.state.heading.copy(), worlds.state.cosine.copy(), worlds.state.sine.copy()
    rows = np.zeros((count_rows(worlds.units), worlds.lanes))
    models = canonical(SafetyFilter(horizon=horizon)), canonical(Task()), canonical(vehicle)
    _doubt_all(worlds.lanes, *models, worlds, *np.zeros((2, 1, worlds.lanes)), rows, threads=1)
    for kept, values in zip(headings, worlds.state[2:5], strict=True):
        values[:] = kept
    return rows[IN_DOUBT] != 0.0


class Chains:
    """The general n-trailer of Altafini (2001) behind a truck that drives straight on."""

    def __init__(self, worlds):
        """Copy the HAVs that stand."""
        fleet = worlds.fleet
        units = int(fleet.num_trailers.max()) + 1
        self.present = np.arange(1, units)[:, None] <= fleet.num_trailers[0]
        self.heading = worlds.state.heading[0, :units].copy()
        self.length = np.where(self.present, fleet.length[0, 1:units], 1.0)
        self.offset = fleet.joints.offset[0, : units - 1]
        self.limit = np.where(self.present, fleet.joints.limit[0, 1:units], np.inf)
        self.longest = DT * fleet.limit[0, SPEED]

    def rates(self, heading):
        """Return the turn (U, W) of each unit for each metre of the truck [rad/m]."""
        rates, speed, rate = np.zeros(heading.shape), 1.0, 0.0
        for joint, offset in enumerate(self.offset):
            bend = heading[joint + 1] - heading[joint]
            across = speed * np.sin(bend) + offset * rate * np.cos(bend)
            along = speed * np.cos(bend) - offset * rate * np.sin(bend)
            rates[joint + 1] = np.where(self.present[joint], -across / self.length[joint], 0.0)
            speed, rate = along, rates[joint + 1]
        return rates

    def excess(self, heading):
        """Return the largest excess of a joint over its limit (W,) [rad]."""
        return (np.abs(np.diff(heading, axis=0)) - self.limit).max(axis=0)

    def drive(self, moves):
        """Return the largest excess (W,) along moves, each of which returns the new headings."""
        heading, worst = self.heading, self.excess(self.heading)
        for move in moves:
            heading = move(heading)
            worst = np.maximum(worst, self.excess(heading))
        return worst

    def exactly(self, heading):
        """Return headings after 5 cm, by the classical Runge-Kutta method."""
        step = 0.05
        first = self.rates(heading)
        second = self.rates(heading + 0.5 * step * first)
        third = self.rates(heading + 0.5 * step * second)
        fourth = self.rates(heading + step * third)
        return heading + step / 6.0 * (first + 2.0 * second + 2.0 * third + fourth)

    def midway(self, step):
        """Return a move by a length (W,) with the midpoint rule, as the simulator does it."""
        return lambda heading: (
            heading + step * self.rates(heading + 0.5 * step * self.rates(heading))
        )


@pytest.mark.parametrize(
    "name",
    [
        "baggage-train",
        *(
            pytest.param(name, marks=pytest.mark.exhaustive)
            for name in ("tugger-train", "a-double", "farm-train", "eurocombi")
        ),
    ],
)
def test_accepted_havs_straighten_at_all_speeds_and_few_others_do(name):
    batch = bend_at_random(name, budget(1_000, 12), 61)
    chains, doubts = Chains(batch.worlds), find_all(batch)
    rng = np.random.default_rng(62)
    worst = chains.drive([chains.exactly] * int(WAY / 0.05))
    assert (worst[~doubts] < 0.0).all()
    for least in (0.0, 0.9):
        steps = [
            chains.longest * rng.uniform(least, 1.0, chains.longest.size)
            for _ in range(int(3.0 * WAY / chains.longest.min()))
        ]
        assert (chains.drive(map(chains.midway, steps))[~doubts] < 0.0).all()
    straightens = worst < -0.2  # far from all limits
    assert np.count_nonzero(doubts & straightens) <= 0.01 * np.count_nonzero(straightens)
    assert np.count_nonzero(straightens) > 0.05 * doubts.size or budget(0, 1)


def test_bounds_alone_decide_where_the_way_depends_on_the_speed():
    batch = bend_at_random("baggage-train", budget(300, 12), 63)
    euler = VEHICLE._replace(integrator="euler")
    doubts = find_all(batch)
    assert np.count_nonzero(find_all(batch, euler)) > np.count_nonzero(doubts)
    assert find_all(batch, horizon=1).sum() > doubts.sum()
