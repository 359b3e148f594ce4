"""This module is the policy Reserve: a HAV moves only within its reserved, broadcast outline."""

import math
from typing import NamedTuple

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import sizes
from baselines.policies.reserve.multi_agent import act_among_others
from baselines.policies.reserve.preconditions import (
    LEAST_MARGIN,
    check_predicted,
    check_range,
    check_step,
)
from baselines.policies.reserve.proposals import take_or_drive
from baselines.policies.reserve.single_agent import act_alone
from hav_env.compiled import contiguous
from hav_env.models.quantities import Angle, Distance, Duration, Factor, Steps
from hav_env.policies.backup import back_up, backup_rows, check_backup
from hav_env.policies.checks import check_parameters, check_rules
from hav_env.policies.demands import wants_adjacent_memory
from hav_env.policies.interface import act, broadcast_size, memory_size
from hav_env.scenarios import segments_of
from hav_env.world.task import check_at_once


class Reserve(NamedTuple):
    """A HAV moves only within its reserved space.

    By construction, no HAV jackknifes or collides. docs/safety.md has the proof.
    """

    dt: Duration = 0.2
    """Duration of a step [s], equal to ``Task.dt``."""
    distance_tolerance: Distance = 0.5
    """Distance tolerance of a goal [m], equal to ``Task.distance_tolerance``."""
    heading_tolerance: Angle = 0.1
    """Heading tolerance of a goal [rad], equal to ``Task.heading_tolerance``."""
    articulation_margin: Angle = math.radians(1.0)
    """Least distance of an articulation from its limit [rad]."""
    shortlists: Steps = 40
    """Number of lists of candidates that a lone HAV searches for a path."""
    margin: Distance = 0.3
    """Margin of a planned path to others [m]. A reserved outline keeps a share of it."""
    part: Distance = 8.0
    """Length of the part of a path that a HAV reserves at a time [m]."""
    horizon: Factor = 3.0
    """Distance up to which a plan avoids the outlines of others [radii of the nose's circle]."""
    patience: Distance = 60.0
    """Maximum detour over the shortest candidate [m]. It grows by 20 % with each failed plan."""
    shortcut: Distance = 10.0
    """Length [m] that another path must save for a HAV to leave its path."""
    wait: Steps = 25
    """Time that a HAV stands blocked before it drives round its circle [steps]."""
    refresh: Distance = 15.0
    """Distance after which a HAV on the rest to its goal reserves that rest anew [m]."""
    turns: Steps = 1
    """Round-robin period in which HAVs reserve [steps].

    With a period of at least the number of HAVs, all may decide at the same time.
    """
    broadcast: bool = True
    """Whether HAVs receive the outlines of others. Without them, a HAV moves only where no other
    HAV is near.
    """
    position_noise: Distance = 0.0
    """Largest error of the sensed positions of others [m]. Margins grow by it."""
    heading_noise: Angle = 0.0
    """Largest error of their sensed headings [rad]. Margins grow by the displacement it causes."""
    retry: Steps = 25
    """As a backup: time for which it drives after its first refusal on the way to a goal [steps].
    Each further one doubles it."""
    leeway: Factor = 1.5
    """As a backup: time for proposals on the way to a goal [shortest time of the endless circle's
    radius]."""


@memory_size.register
def _(policy: Reserve) -> int:
    return m.ROWS


@broadcast_size.register
def _(policy: Reserve) -> int:
    return m.BROADCAST


@wants_adjacent_memory.register
def _(policy: Reserve) -> bool:
    return True


@check_parameters.register
def _(policy: Reserve, scenario) -> None:
    if scenario.max_trailers > sizes.MAX_TRAILERS:
        raise ValueError(
            f"scenario max_trailers is {scenario.max_trailers}, but Reserve drives HAVs with at"
            f" most {sizes.MAX_TRAILERS}"
        )
    if not policy.articulation_margin < scenario.articulation_max:
        raise ValueError(
            f"policy articulation_margin is {policy.articulation_margin}, but must be below the"
            f" scenario's articulation_max {scenario.articulation_max}"
        )
    if policy.margin < LEAST_MARGIN:
        raise ValueError(f"policy margin is {policy.margin}, but must be at least {LEAST_MARGIN} m")
    check_step(scenario, policy)


@check_rules.register
def _(policy: Reserve, scenario, task, vehicle) -> None:
    check_predicted(vehicle)
    if task.goal_speed < scenario.fleet.speed_max:
        raise ValueError(
            f"task goal_speed is {task.goal_speed}, but must be at least speed_max,"
            f" {scenario.fleet.speed_max}: Reserve drives to its goals at full speed"
        )
    for field in ("dt", "distance_tolerance", "heading_tolerance"):
        value, rule = getattr(policy, field), getattr(task, field)
        if value != rule:
            raise ValueError(f"policy {field} is {value}, but must be the task's, {rule}")
    check_at_once(task)
    check_range(scenario, policy.dt, task.sensing_range)


@check_backup.register
def _(backup: Reserve, scenario) -> None:
    if segments_of(scenario) > 0:
        raise ValueError("backup Reserve does not sense obstacles, but the scenario has some")
    if not backup.broadcast or backup.turns != 1:
        raise ValueError(
            f"backup broadcast is {backup.broadcast} and turns is {backup.turns}, but must be True"
            " and 1: proposals are reserved in every step"
        )


@act.register(Reserve)
def reserve(policy, memory, world, agent, lane):
    """Return speed [m/s] and steering [rad] of a HAV, among others or alone in its world."""
    rows = contiguous(memory[agent, :, lane])
    if memory.shape[0] > 1:
        return act_among_others(policy, rows, memory, world, agent, lane)
    return act_alone(policy, rows, world, agent, lane)


@backup_rows.register(Reserve)
def _rows_of_reserve(policy):
    return m.ROWS


@back_up.register(Reserve)
def _take_or_drive(policy, memory, world, agent, lane, speed, steering):
    rows = contiguous(memory[agent, :, lane])
    return take_or_drive(policy, rows, memory, world, agent, lane, speed, steering)
