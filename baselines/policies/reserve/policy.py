"""Reserve: commit only to what was predicted to end well, and tell the others."""

import math
from typing import NamedTuple

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import sizes
from baselines.policies.reserve.multi_agent import act_among_others
from baselines.policies.reserve.preconditions import LEAST_MARGIN, check_range, check_step
from baselines.policies.reserve.single_agent import act_alone
from hav_env import OnAxle
from hav_env.compiled import contiguous
from hav_env.models.quantities import Angle, Distance, Duration, Factor, Steps
from hav_env.policies.interface import (
    act,
    broadcast_size,
    check_parameters,
    check_rules,
    memory_size,
)


class Reserve(NamedTuple):
    """Move only within what was reserved: no jackknife and no collision, by construction."""

    dt: Duration = 0.2
    """Duration of a step [s], ``Task.dt``: what is planned is predicted step by step."""
    distance_tolerance: Distance = 0.5
    """``Task.distance_tolerance`` [m]."""
    heading_tolerance: Angle = 0.1
    """``Task.heading_tolerance`` [rad]."""
    articulation_margin: Angle = math.radians(1.0)
    """No articulation comes nearer to its limit than this [rad]."""
    shortlists: Steps = 40
    """How many lists of candidates a HAV that is alone looks through for a path."""
    margin: Distance = 0.3
    """Distance [m] kept from others by what is planned; what is reserved may come nearer."""
    part: Distance = 8.0
    """How much of its path [m] a HAV reserves at a time."""
    horizon: Factor = 3.0
    """How far ahead what others have reserved counts for a plan, in radii of the nose's circle."""
    patience: Distance = 60.0
    """How much longer than the shortest path [m] one may be, more after failures."""
    wait: Steps = 25
    """Steps that a HAV stands blocked before it goes round its circle."""
    refresh: Distance = 15.0
    """After how much of the rest to its goal [m] a HAV reserves anew what is left of it."""
    turns: Steps = 1
    """HAVs reserve in turns of so many steps: with as many as HAVs, all may decide at once."""
    broadcast: bool = True
    """Whether HAVs hear what others have reserved; if not, they move where nobody is near."""
    position_noise: Distance = 0.0
    """How far off [m] the sensed positions of others may be; margins grow by it."""
    heading_noise: Angle = 0.0
    """How far off [rad] their sensed headings may be; margins grow by what that displaces."""


@memory_size.register
def _(policy: Reserve) -> int:
    return m.ROWS


@broadcast_size.register
def _(policy: Reserve) -> int:
    return m.BROADCAST


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
    if vehicle != OnAxle():
        raise ValueError(f"vehicle is {vehicle}, but Reserve predicts every step of {OnAxle()}")
    for field in ("dt", "distance_tolerance", "heading_tolerance"):
        value, rule = getattr(policy, field), getattr(task, field)
        if value != rule:
            raise ValueError(f"policy {field} is {value}, but must be the task's, {rule}")
    check_range(scenario, policy.dt, task.sensing_range)


@act.register(Reserve)
def reserve(policy, memory, world, agent, lane):
    """Follow the path that was reserved, or the one of a HAV that is alone in its world."""
    rows = contiguous(memory[agent, :, lane])
    if memory.shape[0] > 1:
        return act_among_others(policy, rows, memory, world, agent, lane)
    return act_alone(policy, rows, world, agent, lane)
