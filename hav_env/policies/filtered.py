"""This module combines any policy with the safety filter: ``Filtered(make_policy("ppo_pair"))``.

With a backup, another policy drives wherever a proposal would leave it no safe way on.
"""

from typing import Any, NamedTuple

from hav_env.compiled import VECTOR, canonical, generic, local_array, rare_kernel
from hav_env.models.protocols import Scenario, Vehicle
from hav_env.policies.backed import Backed, check_as_backup, check_behind
from hav_env.policies.backup import NoBackup, backup_rows
from hav_env.policies.checks import check_parameters, check_policy, check_rules
from hav_env.policies.demands import bind, guidance_of, wants_adjacent_memory
from hav_env.policies.interface import act_lanes, broadcast_size, evaded, joint_weights, memory_size
from hav_env.safety import (
    SafetyFilter,
    Unfiltered,
    check_safety,
    filter_command,
    make_safety,
    scratch_rows,
)
from hav_env.world.lanes import LANES
from hav_env.world.task import Task

MOST_FILTERED_TRAILERS = 10


class Filtered(NamedTuple):
    """A policy whose commands pass the safety filter, and may have a backup behind them.

    The filter predicts steps, so it holds the rules and the vehicle of the episodes.
    """

    policy: Any
    """The policy that proposes commands."""
    safety: SafetyFilter | Unfiltered = SafetyFilter()
    """Events to prevent."""
    task: Task | None = None
    """Rules of the episodes; by default those in which the policy drives."""
    vehicle: Any = None
    """Kinematics of the HAVs; by default those that the policy drives."""
    backup: Any = NoBackup()
    """Policy that takes a filtered command or drives instead, such as ``Reserve()``."""


def filter_policy(
    policy: Any, safety: Any, task: Task, vehicle: Any, backup: Any = NoBackup()
) -> Any:
    """Return the policy with a filter or a backup, or the policy itself if neither is given.

    Args:
        policy: Policy to filter; its own filter and backup give way to those that are given.
        safety: None, one of ``hav_env.safety.SAFETY``, or a filter.
        task: Rules of the episodes.
        vehicle: Vehicle model (kinematics).
        backup: Policy that drives where a command would leave it no safe way on.

    Raises:
        TypeError, ValueError: If ``safety`` is none of these.
    """
    made = make_safety(safety)
    filtered = isinstance(made, SafetyFilter)
    backed = not isinstance(backup, NoBackup | type(policy))  # a policy needs no backup by itself
    if not filtered and not backed:
        return policy
    own = policy if isinstance(policy, Filtered) else Filtered(policy, Unfiltered())
    return own._replace(
        safety=made if filtered else own.safety,
        task=task,
        vehicle=vehicle,
        backup=backup if backed else own.backup,
    )


@bind.register
def _(policy: Filtered, task: Task, vehicle: Vehicle) -> Filtered:
    return policy._replace(
        policy=bind(policy.policy, task, vehicle),
        task=task if policy.task is None else policy.task,
        vehicle=vehicle if policy.vehicle is None else policy.vehicle,
    )


@guidance_of.register
def _(policy: Filtered) -> str:
    return guidance_of(policy.policy)


_TRIAL_ROWS = scratch_rows(SafetyFilter(), MOST_FILTERED_TRAILERS + 1)
_TRIAL_LANES = LANES + VECTOR  # rows at this distance do not evict each other from the cache


@act_lanes.register(Filtered)
def propose_and_filter(policy, memory, world, agent, speed, steering):
    """Let the policy decide for one HAV, then filter the decision, then let a backup judge it.

    The first rows of the memory are the backup's.
    """
    _propose(policy.backup, policy, memory, world, agent, speed, steering)


@generic
def _propose(backup, policy, memory, world, agent, speed, steering):
    """Write the decisions for a HAV, after the filter and the judgement of a backup."""


@_propose.register(NoBackup)
def _propose_alone(backup, policy, memory, world, agent, speed, steering):
    act_lanes(policy.policy, memory, world, agent, speed, steering)
    _filter(policy.safety, policy, memory, world, agent, speed, steering)


@_propose.otherwise
def _propose_to_backup(backup, policy, memory, world, agent, speed, steering):
    own = memory[:, backup_rows(backup) :]
    act_lanes(policy.policy, own, world, agent, speed, steering)
    safety = Backed(policy.safety, backup)
    _filter(safety, policy, memory, world, agent, speed, steering)


@rare_kernel
def _filter(safety, policy, memory, world, agent, speed, steering):
    """Filter on the stack: rows in the memory would move with the worlds that change places."""
    rows = local_array(1, _TRIAL_ROWS, _TRIAL_LANES)[0]
    task, vehicle = policy.task, policy.vehicle
    filter_command(safety, task, vehicle, memory, world, agent, speed, steering, rows)


@memory_size.register
def _(policy: Filtered) -> int:
    return memory_size(policy.backup) + memory_size(policy.policy)


@broadcast_size.register
def _(policy: Filtered) -> int:
    backed = not isinstance(policy.backup, NoBackup)
    return broadcast_size(policy.backup if backed else policy.policy)


@wants_adjacent_memory.register
def _(policy: Filtered) -> bool:
    return wants_adjacent_memory(policy.policy) or wants_adjacent_memory(policy.backup)


@joint_weights.register
def _(policy: Filtered, cosine):
    return joint_weights(policy.policy, cosine)


@evaded.register(Filtered)
def _evaded_by_policy(policy, memory, agent, lane):
    return _evaded(policy.backup, policy, memory, agent, lane)


@generic
def _evaded(backup, policy, memory, agent, lane):
    """Return the index of the HAV that the policy evades."""


@_evaded.register(NoBackup)
def _evaded_alone(backup, policy, memory, agent, lane):
    return evaded(policy.policy, memory, agent, lane)


@_evaded.otherwise
def _evaded_behind(backup, policy, memory, agent, lane):
    return evaded(policy.policy, memory[:, backup_rows(backup) :], agent, lane)


@check_parameters.register
def _(policy: Filtered, scenario: Scenario) -> None:
    if scenario.max_trailers > MOST_FILTERED_TRAILERS:
        raise ValueError(
            f"scenario max_trailers is {scenario.max_trailers}, but must be at most"
            f" {MOST_FILTERED_TRAILERS} under a filtered policy"
        )
    if isinstance(policy.backup, NoBackup):
        return
    check_as_backup(policy.backup)
    if broadcast_size(policy.policy) > 0:
        name = type(policy.policy).__name__
        raise ValueError(f"policy is {name}, which broadcasts, but must not where a backup does")


@check_rules.register
def _(policy: Filtered, scenario: Scenario, task: Task, vehicle: Vehicle) -> None:
    for name, own, theirs in (("task", policy.task, task), ("vehicle", policy.vehicle, vehicle)):
        if own is None:
            continue
        if type(own) is not type(theirs) or canonical(own) != canonical(theirs):
            raise ValueError(
                f"policy {name} is {own}, but must be the one of the episodes, {theirs}: pass it to"
                " Filtered"
            )
    check_safety(policy.safety, task, vehicle)
    check_policy(policy.policy, scenario, task, vehicle)
    if not isinstance(policy.backup, NoBackup):
        check_behind(policy.backup, scenario, task, vehicle)
