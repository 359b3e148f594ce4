"""This module filters the commands of policies or learners, and lets a backup judge them."""

import re
from typing import Any, NamedTuple

import numpy as np

from hav_env.compiled import generic
from hav_env.models.annotations import show
from hav_env.models.protocols import Scenario, Vehicle
from hav_env.models.quantities import Precision
from hav_env.policies.backup import back_up, backup_rows, check_backup
from hav_env.policies.checks import check_policy
from hav_env.policies.interface import allocate_memory, memory_size
from hav_env.policies.names import make_policy
from hav_env.safety import SafetyFilter, Unfiltered, filter_command
from hav_env.safety.trial_moves import ASKED_SPEED, ASKED_STEERING
from hav_env.world.arrays import INTERVENTIONS
from hav_env.world.task import Task


class Backed(NamedTuple):
    """A safety filter with a backup behind it: the filter of an environment or of a policy."""

    safety: SafetyFilter | Unfiltered
    backup: Any


def put_behind(
    safety: SafetyFilter | Unfiltered, backup: Any, scenario: Scenario, task: Task, vehicle: Vehicle
) -> SafetyFilter | Unfiltered | Backed:
    """Return a filter with the backup that a user named or made, or the filter itself for None.

    Raises:
        TypeError: If the backup is neither a policy nor the name of one.
        ValueError: If it cannot be a backup there; the message says why.
    """
    if backup is None:
        return safety
    made = make_policy(backup)
    check_as_backup(made)
    check_behind(made, scenario, task, vehicle)
    return Backed(safety, made)


def check_guarded(safety: Any, controlled: int, num_havs: int, precision: Precision) -> None:
    """Check that learners control all HAVs where a backup judges commands, in double precision.

    Raises:
        ValueError: If others drive some of the HAVs, or a filter would predict in single precision.
    """
    if precision == "single" and not isinstance(safety, Unfiltered):
        raise ValueError(
            "precision is 'single', but must be 'double' with a safety filter or a backup: their"
            " margins cover the rounding errors of double precision"
        )
    if isinstance(safety, Backed) and controlled < num_havs:
        name = type(safety.backup).__name__
        raise ValueError(
            f"backup is {name}, but must be None where learners control {controlled} of {num_havs}"
            " HAVs: it has to judge the commands of all"
        )


def memory_behind(safety: Any, num_havs: int, num_worlds: int) -> np.ndarray:
    """Return the memory (N, M, W) of the backup behind a filter; M is 0 without one."""
    if isinstance(safety, Backed):
        return allocate_memory(safety.backup, num_havs, num_worlds)
    return np.zeros((num_havs, 0, num_worlds))


def check_as_backup(backup: Any) -> None:
    """Check that a policy registers all that a backup must.

    Raises:
        ValueError: If it does not.
    """
    if type(backup) not in back_up.table:
        raise ValueError(f"backup is {show(backup)}, but must be a policy that registers back_up")
    rows, size = backup_rows(backup), memory_size(backup)
    if rows != size:
        raise ValueError(f"backup has backup_rows {rows}, but must have memory_size, {size}")


def check_behind(backup: Any, scenario: Scenario, task: Task, vehicle: Vehicle) -> None:
    """Check a backup against the scenario, the rules and the vehicle model of episodes.

    Raises:
        TypeError, ValueError: If its parameters do not suit them.
    """
    try:
        check_policy(backup, scenario, task, vehicle)
    except ValueError as error:  # its parameters are not those of the policy
        raise ValueError(re.sub("^policy ", "backup ", str(error))) from None
    check_backup(backup, scenario)


@filter_command.register(Backed)
def _filter_and_back_up(safety, task, vehicle, memory, world, agent, speed, steering, rows):
    own = safety.safety
    filter_command(own, task, vehicle, memory, world, agent, speed, steering, rows)
    for lane in range(world.lanes):
        if not world.state.waiting[agent, lane]:
            proposed = speed[agent, lane], steering[agent, lane]
            changed = _has_changed(own, rows, lane, *proposed)
            taken, speed[agent, lane], steering[agent, lane] = back_up(
                safety.backup, memory, world, agent, lane, *proposed
            )
            # the filter has counted its own changes
            world.record.total[agent, INTERVENTIONS, lane] += 0.0 if taken or changed else 1.0


@generic
def _has_changed(safety, rows, lane, speed, steering):
    """Return whether the filter has changed a command."""


@_has_changed.register(Unfiltered)
def _never(safety, rows, lane, speed, steering):
    return False


@_has_changed.register(SafetyFilter)
def _differs(safety, rows, lane, speed, steering):
    return (speed != rows[ASKED_SPEED, lane]) | (steering != rows[ASKED_STEERING, lane])
