"""This module computes rewards: named terms with weights, each reported under its name.

A reward is a NamedTuple of weights. Its type selects the kernel that computes its terms. The field
``progress`` is the weight of the term of that name. A waiting HAV gets the reward 0.
"""

import functools
import math
from typing import Any, NamedTuple

import numpy as np

from hav_env.compiled import fixed, generic, kernel
from hav_env.maths.elementary import sqrt
from hav_env.maths.geometry import clip
from hav_env.models.checks import check_model
from hav_env.models.quantities import Weight
from hav_env.observation.columns import place_names
from hav_env.world.arrays import (
    ACTUAL,
    ARTICULATION,
    FEW,
    JACKKNIFE,
    NEVER,
    STEERING,
    WHEN,
    World,
)
from hav_env.world.collision import collision_distance, front_gap
from hav_env.world.event_table import obstacle_hit_at
from hav_env.world.goals import goals_hit
from hav_env.world.sensing import neighbor_id, num_neighbors

# state of each HAV before the action: whether it waited, goals hit, Dubins length to the goal
# [m], whether it ever jackknifed, collided (actual collision), collided with an obstacle
WAITED, HITS, REMAINING, JACKKNIFED, COLLIDED, AT_OBSTACLE, BEFORE_SIZE = range(7)


class Reward(NamedTuple):
    """Weights of the terms; the reward of a step is the sum of weight times term."""

    progress: Weight = 0.1
    """Per metre by which the drivable Dubins path to the goal under way became shorter. Over an
    episode, these terms sum to the lengths of the paths at their beginnings minus the length that
    is left at the end. The term is potential-based (Ng, Harada and Russell, 1999), so driving to
    and fro gains nothing.
    """
    goal: Weight = 10.0
    """Per goal hit."""
    jackknife: Weight = -10.0
    """For the first jackknife of an episode."""
    actual_collision: Weight = -10.0
    """For the first actual collision of an episode."""
    potential_collision: Weight = -1.0
    """Per second, times the depth in the footprint circle of the nearest HAV: 0 at the collision
    distance, 1 at zero distance between both trucks.
    """
    proximity: Weight = 0.0
    """Per second, times the squared nearness of the truck's front axle to the chain of another HAV:
    0 from 5 m on, 1 at contact. Not computed if its weight is 0.
    """
    articulation: Weight = -0.1
    """Per second, times the squared nearness of the largest articulation to its limit: 0 up to half
    of the limit, 1 at the limit.
    """
    steering: Weight = -0.01
    """Per second, times the squared ratio of steering to its maximum."""
    time: Weight = -0.02
    """Per second."""


_TERM = place_names(Reward._fields)
_PROXIMITY_RANGE = 5.0  # [m], range of the proximity term


@generic
def reward_terms(
    reward: Any,
    duration: float,
    world: World,
    agent: int,
    before: np.ndarray,
    remaining: np.ndarray,
    terms: np.ndarray,
) -> None:
    """Compute the terms of one HAV in every lane of a block of worlds, after an action.

    Args:
        reward: Weights; their type selects the kernel, and the kernel writes the terms without
            weights.
        duration: Duration of the action [s].
        world: Block of worlds after the action.
        agent: Index of the HAV.
        before: (N, BEFORE_SIZE, W) columns WAITED .. AT_OBSTACLE, from before the action.
        remaining: (N, W) Dubins length to the goal under way after the action [m].
        terms: (T, N, W) terms to write, in the order of the fields. The caller ignores those of a
            HAV that waited before the action.
    """


@functools.singledispatch
def harm_terms(reward: Any) -> tuple[str, ...]:
    """Return the names of the terms that penalise harm: a curriculum may reduce their weights.

    A custom reward registers a function of its type that returns these names; the default is none.
    """
    return ()


@harm_terms.register
def _(reward: Reward) -> tuple[str, ...]:
    return "jackknife", "actual_collision", "potential_collision", "proximity", "articulation"


def check_reward(reward: Any) -> None:
    """Check the weights.

    Raises:
        ValueError: If a weight is invalid; the message names it, its value and the rule.
        TypeError: If this is not a reward, or a weight is not a number.
    """
    check_model("reward", reward, reward_terms)


@kernel
def note_before(world, agent, remaining, before):
    """Record the values that the terms of the next action compare with."""
    first = world.record.first
    for lane in range(world.lanes):
        waits = world.state.waiting[agent, lane]
        before[agent, WAITED, lane] = 1.0 if waits else 0.0
        before[agent, HITS, lane] = goals_hit(world, agent, lane)
        before[agent, REMAINING, lane] = remaining[agent, lane]
    for lane in range(world.lanes):
        jackknifed = first[agent, JACKKNIFE, WHEN, lane] != NEVER
        before[agent, JACKKNIFED, lane] = 1.0 if jackknifed else 0.0
        collided = first[agent, ACTUAL, WHEN, lane] != NEVER
        before[agent, COLLIDED, lane] = 1.0 if collided else 0.0
    for lane in range(world.lanes):
        hit = obstacle_hit_at(world.place, world, agent, lane) != NEVER
        before[agent, AT_OBSTACLE, lane] = 1.0 if hit else 0.0


@reward_terms.register(Reward)
@kernel
def default_terms(reward, duration, world, agent, before, remaining, terms):
    """Compute the terms of ``Reward``."""
    state, limit, first = world.state, world.fleet.limit, world.record.first
    for lane in range(world.lanes):
        hits = goals_hit(world, agent, lane) - before[agent, HITS, lane]
        # at a hit the old goal's path is complete; ``remaining`` already belongs to the next goal
        left = 0.0 if hits > 0.0 else remaining[agent, lane]
        terms[_TERM.goal, agent, lane] = hits
        terms[_TERM.progress, agent, lane] = before[agent, REMAINING, lane] - left
    for lane in range(world.lanes):
        jackknifed = 1.0 if first[agent, JACKKNIFE, WHEN, lane] != NEVER else 0.0
        collided = 1.0 if first[agent, ACTUAL, WHEN, lane] != NEVER else 0.0
        terms[_TERM.jackknife, agent, lane] = jackknifed - before[agent, JACKKNIFED, lane]
        terms[_TERM.actual_collision, agent, lane] = collided - before[agent, COLLIDED, lane]
    for lane in range(world.lanes):
        effort = state.steering[agent, lane] / limit[agent, STEERING, lane]
        terms[_TERM.steering, agent, lane] = duration * effort * effort
        terms[_TERM.time, agent, lane] = duration
    _articulation_terms(duration, world, agent, terms)
    _collision_terms(duration, world, agent, terms)
    for lane in range(world.lanes):
        terms[_TERM.proximity, agent, lane] = 0.0
    if state.x.shape[0] > 1 and reward.proximity != 0.0:
        for lane in range(world.lanes):
            nearness = _nearness(world, agent, lane)
            terms[_TERM.proximity, agent, lane] = duration * nearness * nearness


@kernel
def _articulation_terms(duration, world, agent, terms):
    """Compute the nearness of the largest articulation to its limit."""
    heading, limit = world.state.heading, world.fleet.limit
    for lane in range(world.lanes):
        terms[_TERM.articulation, agent, lane] = 0.0
    for number in range(1, world.units):
        unit = fixed(number)
        for lane in range(world.lanes):
            bend = abs(heading[agent, unit, lane] - heading[agent, unit - 1, lane])
            bend = bend if unit <= world.fleet.num_trailers[agent, lane] else 0.0
            largest = terms[_TERM.articulation, agent, lane]
            terms[_TERM.articulation, agent, lane] = max(largest, bend)
    for lane in range(world.lanes):
        largest = terms[_TERM.articulation, agent, lane]
        share = clip(2.0 * largest / limit[agent, ARTICULATION, lane] - 1.0, 0.0, 1.0)
        terms[_TERM.articulation, agent, lane] = duration * share * share


@kernel
def _collision_terms(duration, world, agent, terms):
    """Compute the largest depth in the footprint circle of another HAV.

    Circles do not overlap beyond sensing range. In small worlds every HAV is compared, without a
    branch on the neighbour list.
    """
    num_havs = world.state.x.shape[0]
    for lane in range(world.lanes):
        terms[_TERM.potential_collision, agent, lane] = math.inf
    if num_havs <= FEW:
        for number in range(num_havs):
            if number != agent:
                other = fixed(number)
                for lane in range(world.lanes):
                    least = terms[_TERM.potential_collision, agent, lane]
                    share = _squared_share(world, agent, other, lane)
                    terms[_TERM.potential_collision, agent, lane] = min(least, share)
    else:
        for lane in range(world.lanes):
            for k in range(num_neighbors(world, agent, lane)):
                least = terms[_TERM.potential_collision, agent, lane]
                share = _squared_share(world, agent, neighbor_id(world, agent, k, lane), lane)
                terms[_TERM.potential_collision, agent, lane] = min(least, share)
    for lane in range(world.lanes):
        least = terms[_TERM.potential_collision, agent, lane]
        depth = max(0.0, 1.0 - sqrt(least))
        terms[_TERM.potential_collision, agent, lane] = duration * depth


@kernel
def _squared_share(world, agent, other, lane):
    """Return the squared ratio of two trucks' distance to their collision distance."""
    dx = world.state.x[other, lane] - world.state.x[agent, lane]
    dy = world.state.y[other, lane] - world.state.y[agent, lane]
    allowed = collision_distance(world.fleet, agent, other, lane)
    return (dx * dx + dy * dy) / (allowed * allowed)


@kernel
def _nearness(world, agent, lane):
    """Return the nearness of the truck's front to the nearest chain, from 0 to 1."""
    nearness = 0.0
    for k in range(num_neighbors(world, agent, lane)):
        other = neighbor_id(world, agent, k, lane)
        gap = front_gap(world, agent, other, lane)
        nearness = max(nearness, 1.0 - gap / _PROXIMITY_RANGE)
    return nearness
