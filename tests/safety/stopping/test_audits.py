"""No HAV with limited actuators jackknifes or collides under the filter: independent audits."""

import numpy as np
import pytest

from hav_env import (
    Batch,
    Limited,
    OffAxle,
    OnAxle,
    RandomFleet,
    RandomPoses,
    Rectangles,
    SafetyFilter,
    Task,
)
from hav_env.mdp.decision_process import DecisionProcess
from tests.safety.stopping.limited_havs import Guarded, filter_all
from tests.safety.test_filter import at_each_other, at_random, drive_among_walls, run
from tests.support.budgets import COMPARED, COMPILED, budget

LIMITED = OnAxle(actuators=Limited())
TASK = Task(max_steps=10_000)
FAST = RandomPoses(num_havs=2, fleet=RandomFleet(speed_max=4.0), area_factor=16.0)


def at_the_other(havs, rng, held):
    """Return commands at full speed towards the other HAV."""
    bearing = np.arctan2(havs.y[::-1] - havs.y, havs.x[::-1] - havs.x) - havs.heading[:, 0]
    bearing = (bearing + np.pi) % (2.0 * np.pi) - np.pi
    return havs.fastest, np.clip(2.0 * bearing, -havs.steepest, havs.steepest)


def anything(havs, rng, held):
    """Return commands that are held for a while: fast, slow or none, with random steering."""
    if held is not None and rng.random() < 0.95:
        return held
    speed = havs.fastest * rng.choice([0.0, 0.2, 1.0, 1.0], havs.x.shape)
    return speed, rng.choice([-1.0, 0.3, 1.0], havs.x.shape) * havs.steepest


def meet(scenario, vehicle, choose, *, safety, worlds, steps, seed=5):
    """Let HAVs drive by commands under the filter; return the audit."""
    guarded = Guarded(Batch(scenario, worlds, TASK, vehicle), safety, TASK, vehicle, seed)
    rng, held = np.random.default_rng(seed), None
    for _ in range(steps):
        held = choose(guarded.havs, rng, held)
        guarded.command(*held)
        assert (guarded.havs.bends() < guarded.havs.most_bent).all() or safety is None
    assert guarded.error() < 1e-6 or safety is None
    return guarded


@pytest.mark.parametrize(
    "choose", [at_the_other, pytest.param(anything, marks=pytest.mark.exhaustive)]
)
def test_no_command_jackknifes_or_collides(choose):
    sizes = {"worlds": budget(24, 2), "steps": budget(250, 25)}
    guarded = meet(FAST, LIMITED, choose, safety=SafetyFilter(), **sizes)
    guarded.audit.approve(rolls=True)
    assert guarded.least > 1e-6


@pytest.mark.exhaustive
@pytest.mark.parametrize(
    "vehicle",
    [
        OnAxle(actuators=Limited(0.5, 0.6, 0.2, 0.5)),
        OnAxle(actuators=Limited(1e9, 1e9, 1e9, 1e9)),
        OnAxle(actuators=Limited(1e9, 3.0, 0.3)),
    ],
    ids=["sluggish", "unlimited", "abrupt"],
)
def test_other_limits_are_safe_as_well(vehicle):
    sizes = {"worlds": budget(60, 2), "steps": budget(400, 20)}
    for choose in (at_the_other, anything):
        guarded = meet(FAST, vehicle, choose, safety=SafetyFilter(), **sizes)
        guarded.audit.approve(rolls=True)
        assert guarded.least > 1e-6


@pytest.mark.exhaustive
def test_without_the_filter_the_same_commands_end_in_both():
    sizes = {"worlds": budget(60, 2), "steps": budget(400, 60)}
    guarded = meet(FAST, LIMITED, at_the_other, safety=None, **sizes)
    assert guarded.least <= 0.0 or budget(0, 1)
    assert (guarded.audit.largest > guarded.havs.most_bent).any() or budget(0, 1)


@pytest.mark.exhaustive
@pytest.mark.parametrize("choose", [at_random, at_each_other])
def test_no_two_havs_collide_in_a_dense_swarm(choose):
    process = DecisionProcess(
        budget(12, 1), scenario="dense-10", vehicle=LIMITED, safety="both", threads=1
    )
    audit, info = run(process, budget(500, 10), choose, hold=30)
    audit.approve(rolls=True)
    assert not info["jackknifed"].any()
    assert info["interventions"].sum() > 0.0 or budget(0, 1)


@pytest.mark.exhaustive
@pytest.mark.parametrize("scenario", ["field-1", "docks-6"])
def test_realistic_vehicles_hit_no_wall_and_no_other(scenario):
    vehicle = OffAxle(bodies=Rectangles(), actuators=Limited())
    process = DecisionProcess(
        budget(16, 2), scenario=scenario, vehicle=vehicle, safety="both", threads=1
    )
    info = drive_among_walls(process, budget(300, 8))
    assert info["path_length"].mean() > 2.0 or budget(0, 1)


@pytest.mark.exhaustive
@pytest.mark.parametrize("against", ["jackknife", "collision"])
def test_each_filter_alone_prevents_its_events(against):
    sizes = {"worlds": budget(40, 2), "steps": budget(300, 20)}
    guarded = Guarded(
        Batch(FAST, sizes["worlds"], TASK, LIMITED), SafetyFilter(against), TASK, LIMITED, 7
    )
    largest = np.zeros(guarded.havs.x.shape)
    for _ in range(sizes["steps"]):
        guarded.command(*at_the_other(guarded.havs, None, None))
        largest = np.maximum(largest, guarded.havs.bends())
    if against == "jackknife":
        assert (largest < guarded.havs.most_bent).all()
        assert guarded.least == 0.0 or budget(0, 1)
    else:
        assert guarded.least > 1e-6
        assert (largest > guarded.havs.most_bent).any() or budget(0, 1)


def test_joints_never_hold_a_hav_permanently():
    worlds, steps = budget(100, 4), budget(300, 40)
    scenario = RandomPoses(num_havs=1, fleet=RandomFleet())
    batch = Batch(scenario, worlds, TASK, LIMITED)
    guarded = Guarded(batch, SafetyFilter("jackknife"), TASK, LIMITED, 9)
    batch.worlds.state.waiting[:] = False
    moved = np.zeros((steps, worlds))
    for step in range(steps):
        guarded.command(guarded.havs.fastest, guarded.havs.steepest)
        moved[step] = guarded.havs.speed[0]
    assert (guarded.havs.bends() < guarded.havs.most_bent).all()
    assert (moved[-steps // 4 :].sum(axis=0) > 0.0).all()


@pytest.mark.skipif(not COMPILED, reason=COMPARED)
def test_plain_python_filters_as_compiled_code_does():
    worlds, rng = 6, np.random.default_rng(4)
    batch = Batch(FAST, worlds, TASK, LIMITED)
    guarded = Guarded(batch, SafetyFilter(), TASK, LIMITED, 4)
    changed = 0
    for step in range(120):
        given = np.stack(at_the_other(guarded.havs, rng, None))
        if step % 12 == 11:
            told = SafetyFilter(), TASK, LIMITED, batch.worlds, given
            compiled, plain = filter_all(*told), filter_all(*told, plain=True)
            assert np.array_equal(plain, compiled)
            changed += (plain != given).any()
        guarded.command(*given)
    assert changed > 0
