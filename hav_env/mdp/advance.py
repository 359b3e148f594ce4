"""This module advances a range of worlds by one action, compiled, and records the outcome."""

from typing import NamedTuple

import numpy as np

from hav_env.compiled import VECTOR, entry, kernel, lanes_from
from hav_env.maths.geometry import clip
from hav_env.mdp.info import REPORT, write_report
from hav_env.mdp.reward import BEFORE_SIZE, WAITED, note_before, reward_terms
from hav_env.observation import ROUTE_SIZE, observe, plan_route
from hav_env.simulator.transition import late, remove_arrived, step, terminated
from hav_env.world.lanes import APART, OBSERVED_LANES, block_of
from hav_env.world.sensing import limits


class Outcome(NamedTuple):
    """The outcome of an action; the first C of the N HAVs of a world are controlled."""

    observation: np.ndarray  # (W, C, D) float32
    info: np.ndarray  # (K, C, W) the report, then the returns so far by term of the reward
    reward: np.ndarray  # (C, W)
    terminated: np.ndarray  # (W,) bool
    truncated: np.ndarray  # (W,) bool


def outcome_size(controlled: int, columns: int, numbers: int) -> int:
    """Return how many bytes of one world all take that telling of it needs at a time."""
    return controlled * (2 * 4 * columns + 4 * 8 * numbers)


class Buffers(NamedTuple):
    """Arrays that last from action to action, and scratch."""

    command: np.ndarray  # (2, N, W) speed [m/s], steering [rad]
    remaining: np.ndarray  # (C, W) Dubins length to the goal [m]
    before: np.ndarray  # (C, BEFORE_SIZE, W)
    route: np.ndarray  # (C, ROUTE_SIZE, W)
    returns: np.ndarray  # (T, C, W) sums of the weighted terms since the episode began
    columns: np.ndarray  # (ranges, D, APART) float32


def allocate_buffers(
    num_worlds: int, num_havs: int, controlled: int, terms: int, columns: int, slots: int
) -> Buffers:
    """Return the buffers of W worlds: of N HAVs, C controlled ones, T terms and D columns.

    ``slots`` is how many threads may use ``Buffers.columns`` at a time.
    """
    n, c, w = num_havs, controlled, num_worlds
    return Buffers(
        np.zeros((2, n, w)),
        np.zeros((c, w)),
        np.zeros((c, BEFORE_SIZE, w)),
        np.zeros((c, ROUTE_SIZE, w)),
        np.zeros((terms, c, w)),
        np.zeros((slots, columns, APART), np.float32),
    )


def outcome_layout(
    num_worlds: int, controlled: int, columns: int, numbers: int
) -> list[tuple[tuple[int, ...], type]]:
    """Return shape and type of every array of an ``Outcome``: W, C, D and K of them."""
    w, c = num_worlds, controlled
    return [
        ((w, c, columns), np.float32),
        ((numbers, c, w), np.float64),
        ((c, w), np.float64),
        ((w,), np.bool_),
        ((w,), np.bool_),
    ]


class Portion(NamedTuple):
    """Some of the steps of an action; others than the controlled HAVs may decide in between."""

    opens: bool
    """The action begins with it."""
    steps: int
    """Number of steps of the simulator."""
    closes: bool
    """The action ends with it."""


@kernel
def _buffers_from(buffers, start, slot):
    """Return the buffers of the worlds from ``start`` on."""
    return Buffers(
        lanes_from(buffers.command, start),
        lanes_from(buffers.remaining, start),
        lanes_from(buffers.before, start),
        lanes_from(buffers.route, start),
        lanes_from(buffers.returns, start),
        buffers.columns[slot],
    )


@kernel
def _outcome_from(outcome, start):
    """Return the outcome of the worlds from ``start`` on."""
    return Outcome(
        outcome.observation[start:],
        lanes_from(outcome.info, start),
        lanes_from(outcome.reward, start),
        lanes_from(outcome.terminated, start),
        lanes_from(outcome.truncated, start),
    )


@entry
def advance_worlds(
    first, last, task, vehicle, reward, observation, worlds, buffers, actions, portion, outcome
):
    """Take (a part of) one action in each of a range of worlds, and write what it led to.

    Args:
        first: world of the range.
        last: the world after the range.
        task: the rules.
        vehicle: the kinematics.
        reward: the weights.
        observation: settled for the number of HAVs.
        worlds: the arrays of all worlds.
        buffers: of all worlds.
        actions: (W, C, 2) from -1 to 1, cut.
        portion: a ``Portion``: which part of the action.
        outcome: of all worlds; written where the action closes.
    """
    duration = task.dt * portion.steps
    for start in range(first, last, OBSERVED_LANES):
        world = block_of(worlds, start, min(OBSERVED_LANES, last - start), worlds.units)
        block, result = (
            _buffers_from(buffers, start, first // VECTOR),
            _outcome_from(outcome, start),
        )
        for agent in range(actions.shape[1]):
            _command(world, block, agent, actions[start:])
            if portion.opens:
                note_before(world, agent, block.remaining, block.before)
        if portion.opens:
            remove_arrived(task, world)
        for _ in range(portion.steps):
            step(task, vehicle, world, block.command[0], block.command[1])
        if portion.closes:
            for agent in range(actions.shape[1]):
                plan_route(world, agent, block.route, block.remaining)
                _reward(reward, duration, world, agent, block, result)
                _write_outcome(observation, world, agent, block, result)
            for lane in range(world.lanes):
                over = terminated(task, world, actions.shape[1], lane)
                result.terminated[lane] = over
                result.truncated[lane] = late(task, world, lane) and not over


@entry
def observe_worlds(first, last, observation, worlds, buffers, chosen, outcome):
    """Write what is seen in those of a range of worlds where ``chosen`` (W,) is true."""
    for w in range(first, last):
        if chosen[w]:
            world = block_of(worlds, w, 1, worlds.units)
            observe_block(observation, world, buffers, w, first // VECTOR, outcome)


@kernel
def observe_block(observation, world, buffers, start, slot, outcome):
    """Write what is seen in a block of worlds in which no action has just been taken.

    Rewards are zero, and nothing has ended.

    Args:
        observation: settled for the number of HAVs.
        world: the block.
        buffers: of all worlds.
        start: the first of them that is in the block.
        slot: which of the buffers' columns this thread may use.
        outcome: of all worlds, to be written.
    """
    block, result = _buffers_from(buffers, start, slot), _outcome_from(outcome, start)
    returns = result.info[len(REPORT) :]
    for agent in range(result.info.shape[1]):
        plan_route(world, agent, block.route, block.remaining)
        _write_outcome(observation, world, agent, block, result)
        for lane in range(world.lanes):
            result.reward[agent, lane] = 0.0
        for t in range(returns.shape[0]):
            for lane in range(world.lanes):
                returns[t, agent, lane] = block.returns[t, agent, lane]
    for lane in range(world.lanes):
        result.terminated[lane] = result.truncated[lane] = False


@kernel
def to_command(faster, turned, speed_max, steering_max):
    """Return speed [m/s] and steering [rad] of an action, both of whose numbers are cut to [-1, 1].

    -1 is standing, 1 is full speed; -1 is as far right as the wheels go, 1 as far left.
    """
    share = 0.5 * (clip(faster, -1.0, 1.0) + 1.0)
    return share * speed_max, clip(turned, -1.0, 1.0) * steering_max


@kernel
def _command(world, block, agent, actions):
    """Turn actions into speed and steering."""
    for lane in range(world.lanes):
        speed_max, steering_max, _ = limits(world, agent, lane)
        block.command[0, agent, lane], block.command[1, agent, lane] = to_command(
            actions[lane, agent, 0], actions[lane, agent, 1], speed_max, steering_max
        )


@kernel
def _reward(reward, duration, world, agent, block, outcome):
    """Work out the weighted sum of the terms, and what each has come to since the beginning."""
    terms, total = outcome.info[len(REPORT) :], outcome.reward
    reward_terms(reward, duration, world, agent, block.before, block.remaining, terms)
    for lane in range(world.lanes):
        total[agent, lane] = 0.0
    for t in range(len(reward)):
        for lane in range(world.lanes):
            acts = block.before[agent, WAITED, lane] == 0.0
            value = reward[t] * terms[t, agent, lane] if acts else 0.0
            block.returns[t, agent, lane] += value
            terms[t, agent, lane] = block.returns[t, agent, lane]
            total[agent, lane] += value


@kernel
def _write_outcome(observation, world, agent, block, outcome):
    """Write the report and the observation."""
    write_report(world, agent, block.remaining, outcome.info)
    # with this said, the compiler knows how far the rows lie apart, and uses vectors
    if block.columns.shape[1] == APART:
        observe(observation, world, agent, block.route, block.columns)
    for lane in range(world.lanes):
        for column in range(block.columns.shape[0]):
            outcome.observation[lane, agent, column] = block.columns[column, lane]
