"""Reserve as a backup: no proposal leads to a jackknife or a collision, and HAVs arrive."""

from typing import NamedTuple

import numpy as np
import pytest

from baselines.policies.reserve import Reserve
from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import states
from baselines.replay.reserved_outlines import reserved_outline
from hav_env import Batch, Filtered, OnAxle, RandomPoses, Task, act, find_scenario, memory_size
from hav_env.maths.kdop import SIDES
from hav_env.policies.backup import check_backup
from hav_env.policies.checks import check_policy
from hav_env.policies.driver import PolicyDriver
from hav_env.policies.filtered import filter_policy
from hav_env.policies.interface import allocate_memory
from hav_env.safety import Unfiltered
from tests.support.audit import Audit
from tests.support.budgets import COMPILED, budget

LONG = 100.0  # shortest times of a way: proposals are never over


class Told(NamedTuple):
    """Propose the command that the test has written into the memory."""


@memory_size.register
def _(policy: Told) -> int:
    return 2  # speed [m/s], steering [rad]


@act.register(Told)
def say(policy, memory, world, agent, lane):
    return memory[agent, 0, lane], memory[agent, 1, lane]


def at_random(worlds, rng):
    """Return commands that stand, creep or drive, and steer hard; some are no numbers."""
    shape = worlds.state.x.shape
    speed = rng.choice([0.0, 0.4, 1.0, 1.0, 1.0, np.nan], shape)
    return speed, rng.choice([-9.0, -0.3, 0.0, 0.0, 9.0, np.nan, np.inf], shape)


def at_the_nearest(worlds, rng):
    """Return commands at full speed that steer every HAV to the nearest other one."""
    state = worlds.state
    here = state.x + 1j * state.y
    way = here[None] - here[:, None]
    way[np.arange(len(here)), np.arange(len(here))] = np.inf
    nearest = np.take_along_axis(way, np.abs(way).argmin(axis=1)[:, None], axis=1)[:, 0]
    bearing = np.angle(nearest * np.exp(-1j * state.heading[:, 0]))
    return np.ones(here.shape), np.clip(3.0 * bearing, -0.6, 0.6)


def propose(choose, scenario, leeway, episodes, steps, hold=15, seed=31):
    """Drive by proposals until all HAVs have arrived; return the audit and the share taken."""
    batch = Batch(scenario, episodes)
    batch.reset(seed)
    policy = Filtered(Told(), Unfiltered(), backup=Reserve(leeway=leeway))
    driver, audit = PolicyDriver(policy, batch), Audit(batch.worlds)
    rng, moving = np.random.default_rng(seed), 0
    for step in range(steps):
        if step % hold == 0:
            speed, steering = choose(batch.worlds, rng)
            driver.memory[:, m.ROWS, :episodes] = speed
            driver.memory[:, m.ROWS + 1, :episodes] = steering
        moving += np.count_nonzero(~batch.worlds.state.waiting)
        batch.step(*driver.decide())
        audit.look()
        if batch.worlds.state.waiting.all():
            break
    return audit, 1.0 - batch.worlds.record.total[:, -1].sum() / moving


@pytest.mark.exhaustive
@pytest.mark.parametrize("choose", [at_random, at_the_nearest])
def test_no_proposal_leads_to_a_jackknife_or_a_collision(choose):
    scenario = RandomPoses(num_havs=10, area_factor=2.0)
    audit, taken = propose(choose, scenario, LONG, budget(4, 1), budget(500, 3))
    audit.approve()
    assert 0.0 < taken <= 1.0


@pytest.mark.exhaustive
def test_havs_arrive_when_the_time_for_proposals_is_over():
    scenario = RandomPoses(num_havs=4, area_factor=2.0)
    audit, _ = propose(at_random, scenario, 0.5, budget(3, 1), budget(9_000, 3))
    audit.approve()
    assert audit.worlds.state.waiting.all() or not COMPILED


def test_who_may_not_be_combined_is_refused_in_a_line():
    scenario = RandomPoses(num_havs=2)
    for policy, said in (
        (Filtered(Reserve(), backup=Reserve()), "which broadcasts, but must not where a backup"),
        (Filtered(Told(), backup=Told()), r"backup is Told\(\), but must be a policy that regist"),
        (Filtered(Told(), backup=Reserve(turns=2)), "backup broadcast is True and turns is 2, but"),
        (Filtered(Told(), backup=Reserve(broadcast=False)), "backup broadcast is False and turns"),
        (Filtered(Told(), backup=Reserve(margin=0.0)), "backup margin is 0.0, but must be at l"),
    ):
        with pytest.raises(ValueError, match=said):
            check_policy(policy, scenario)


def test_a_policy_that_is_the_backup_drives_by_itself():
    backup = Reserve(dt=0.1)
    assert filter_policy(Reserve(), None, Task(), OnAxle(), backup) == Reserve()
    proposed = filter_policy(Told(), None, Task(), OnAxle(), backup)
    assert (proposed.policy, proposed.backup) == (Told(), backup)


@pytest.mark.parametrize(
    "policy",
    [
        Filtered(Reserve()),
        Filtered(Filtered(Told(), Unfiltered(), backup=Reserve())),
        Filtered(Told(), backup=Reserve()),
    ],
)
def test_the_memory_of_a_hav_is_adjacent_wherever_reserve_stands(policy):
    memory = allocate_memory(policy, 2, 4)
    assert memory[1, :, 2].strides == (memory.itemsize,)


def test_the_recorded_area_is_that_of_the_backup():
    policy = Filtered(Told(), Unfiltered(), backup=Reserve())
    memory, corners = allocate_memory(policy, 2, 2), np.full((SIDES, 2), np.nan)
    assert not reserved_outline(policy, memory, 0, 0, corners)
    memory[0, m.MODE, 0], memory[0, m.FRAME_AFTER + 2, 0] = states.RESERVED, 1.0
    memory[0, m.OUTLINE : m.OUTLINE + SIDES, 0] = 3.0
    assert reserved_outline(policy, memory, 0, 0, corners)
    np.testing.assert_allclose(np.hypot(*corners.T), 3.0 / np.cos(np.pi / SIDES))


def test_a_backup_that_senses_no_obstacles_is_refused_among_them():
    policy = Filtered(Told(), Unfiltered(), backup=Reserve())
    with pytest.raises(ValueError, match="does not sense obstacles"):
        check_backup(policy.backup, find_scenario("docks-6"))
