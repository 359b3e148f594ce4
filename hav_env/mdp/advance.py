"""This module advances a range of worlds by one action, compiled, and records the outcome."""

from typing import NamedTuple

import numpy as np

from hav_env.compiled import (
    VECTOR,
    arguments_of,
    entry,
    kernel,
    lanes_from,
    loop_kernel,
    of_width,
)
from hav_env.maths.geometry import clip
from hav_env.mdp.info import REPORT, write_report
from hav_env.mdp.reward import BEFORE_SIZE, WAITED, note_before, reward_terms
from hav_env.observation import (
    CHAIN_ROWS,
    SCRATCH_ROWS,
    Scratch,
    observe,
    plan_route,
    write_rows,
)
from hav_env.simulator.transition import late, remove_arrived, step, terminated
from hav_env.world.lanes import APART, OBSERVED_LANES, block_of
from hav_env.world.sensing import limits


class Outcome(NamedTuple):
    """The outcome of an action; the first C of the N HAVs of a world are controlled."""

    observation: np.ndarray  # (W, C, D) float32
    info: np.ndarray  # (K, C, W) the report, then the returns so far by term; see ``Portion``
    reward: np.ndarray  # (C, W)
    terminated: np.ndarray  # (W,) bool
    truncated: np.ndarray  # (W,) bool


def outcome_size(controlled: int, columns: int, numbers: int) -> int:
    """Return how many bytes of one world all take that telling of it needs at a time."""
    return controlled * (2 * 4 * columns + 4 * 8 * numbers)


class Actions(NamedTuple):
    """Actions as the user holds them: in one of two precisions; the other array is empty."""

    single: np.ndarray  # (W, C, 2) float32 from -1 to 1, or (0, C, 2)
    double: np.ndarray  # (W, C, 2) from -1 to 1, or (0, C, 2)


class Buffers(NamedTuple):
    """Arrays that last from action to action, and scratch."""

    command: np.ndarray  # (2, N, W) speed [m/s], steering [rad]
    remaining: np.ndarray  # (C, W) Dubins length to the goal [m]
    before: np.ndarray  # (C, BEFORE_SIZE, W)
    returns: np.ndarray  # (T, C, W) sums of the weighted terms since the episode began
    terms: np.ndarray  # (ranges, T, C, at most APART) of the reward, without weights
    columns: np.ndarray  # (ranges, D, APART) float32
    scratch: Scratch  # each of its arrays likewise


# arrays of scratch by name: they mean nothing from one action to the next
SCRATCH = "buffers.terms", "buffers.columns", "buffers.scratch"


def allocate_buffers(
    num_worlds: int, num_havs: int, controlled: int, num_terms: int, num_columns: int, slots: int
) -> Buffers:
    """Return buffers.

    Args:
        num_worlds: W.
        num_havs: N.
        controlled: C.
        num_terms: T, of the reward.
        num_columns: D, of the observation.
        slots: how many threads may use the scratch at a time.
    """
    n, c, w = num_havs, controlled, num_worlds
    return Buffers(
        np.zeros((2, n, w)),
        np.zeros((c, w)),
        np.zeros((c, BEFORE_SIZE, w)),
        np.zeros((num_terms, c, w)),
        np.zeros((slots, num_terms, c, min(w, APART))),
        np.zeros((slots, num_columns, APART), np.float32),
        Scratch(
            np.zeros((slots, SCRATCH_ROWS, APART), np.float32),
            np.zeros((slots, CHAIN_ROWS, APART)),
        ),
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
    reports: bool
    """Every world is reported on; otherwise only those whose episodes end."""


def divide_action(frame_skip: int, driven: bool, reports: bool) -> tuple[Portion, ...]:
    """Return the portions of an action: all of it, or its steps where others decide before each.

    Args:
        frame_skip: for how many steps of the simulator the action is held.
        driven: whether a policy drives others.
        reports: whether every world is reported on.
    """
    if not driven:
        return (Portion(True, frame_skip, True, reports),)
    last = frame_skip - 1
    return tuple(Portion(k == 0, 1, k == last, reports) for k in range(frame_skip))


@kernel
def _buffers_from(buffers, start, slot):
    """Return the buffers of the worlds from ``start`` on."""
    return Buffers(
        lanes_from(buffers.command, start),
        lanes_from(buffers.remaining, start),
        lanes_from(buffers.before, start),
        lanes_from(buffers.returns, start),
        buffers.terms[slot],
        of_width(buffers.columns[slot], APART),
        Scratch(
            of_width(buffers.scratch.rows[slot], APART),
            of_width(buffers.scratch.chain[slot], APART),
        ),
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
def advance_worlds(first, last, held, actions, outcome):
    """Take (a part of) one action in each of a range of worlds.

    Args:
        first: world of the range.
        last: the world after the range.
        held: task, vehicle, reward, observation, worlds, buffers and portion, as of ``_advance``.
        actions: ``Actions`` of all worlds, cut.
        outcome: of all worlds; written where the action closes.
    """
    task, vehicle, reward, observation, worlds, buffers, portion = arguments_of(held)
    _advance(
        first,
        last,
        task,
        vehicle,
        reward,
        observation,
        worlds,
        buffers,
        portion,
        actions,
        outcome,
    )


@loop_kernel
def _advance(
    first, last, task, vehicle, reward, observation, worlds, buffers, portion, actions, outcome
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
        portion: a ``Portion``: which part of the action.
        actions: ``Actions`` of all worlds, cut.
        outcome: of all worlds; written where the action closes.
    """
    duration, controlled = task.dt * portion.steps, outcome.info.shape[1]
    for start in range(first, last, OBSERVED_LANES):
        world = block_of(worlds, start, min(OBSERVED_LANES, last - start), worlds.units)
        block, result = (
            _buffers_from(buffers, start, first // VECTOR),
            _outcome_from(outcome, start),
        )
        for agent in range(controlled):
            if actions.single.shape[0] > 0:
                _command(world, block, agent, actions.single[start:])
            else:
                _command(world, block, agent, actions.double[start:])
            if portion.opens:
                note_before(world, agent, block.remaining, block.before)
        if portion.opens:
            remove_arrived(task, world)
        for _ in range(portion.steps):
            step(task, vehicle, world, block.command[0], block.command[1])
        if portion.closes:
            for agent in range(controlled):
                plan_route(world, agent, block.scratch, block.remaining)
                terms = result.info[len(REPORT) :] if portion.reports else block.terms
                _reward(reward, duration, world, agent, block, terms, result)
                _write_outcome(observation, world, agent, block, result)
                if portion.reports:
                    _report(world, agent, block, result)
            for lane in range(world.lanes):
                over = terminated(task, world, controlled, lane)
                result.terminated[lane] = over
                result.truncated[lane] = late(task, world, lane) and not over
            if not portion.reports:
                _report_ends(worlds, buffers, outcome, start, world.lanes)


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
    for agent in range(result.info.shape[1]):
        plan_route(world, agent, block.scratch, block.remaining)
        _write_outcome(observation, world, agent, block, result)
        _report(world, agent, block, result)
        for lane in range(world.lanes):
            result.reward[agent, lane] = 0.0
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
            float(actions[lane, agent, 0]), float(actions[lane, agent, 1]), speed_max, steering_max
        )


@kernel
def _reward(reward, duration, world, agent, block, terms, outcome):
    """Work out the terms, their weighted sum, and what each has come to since the beginning."""
    total = outcome.reward
    reward_terms(reward, duration, world, agent, block.before, block.remaining, terms)
    for lane in range(world.lanes):
        total[agent, lane] = 0.0
    for t in range(len(reward)):
        for lane in range(world.lanes):
            acts = block.before[agent, WAITED, lane] == 0.0
            value = reward[t] * terms[t, agent, lane] if acts else 0.0
            block.returns[t, agent, lane] += value
            total[agent, lane] += value


@kernel
def _write_outcome(observation, world, agent, block, outcome):
    """Write the observation."""
    observe(observation, world, agent, block.scratch, block.columns)
    write_rows(block.columns, world.lanes, outcome.observation[:, agent])


@kernel
def _report_ends(worlds, buffers, outcome, start, lanes):
    """Write the reports on those worlds of a block whose episodes end."""
    for w in range(start, start + lanes):
        if outcome.terminated[w] | outcome.truncated[w]:
            world = block_of(worlds, w, 1, worlds.units)
            block, result = _buffers_from(buffers, w, 0), _outcome_from(outcome, w)
            for agent in range(outcome.info.shape[1]):
                _report(world, agent, block, result)


@kernel
def _report(world, agent, block, outcome):
    """Write the report on a HAV, and what each term of its reward has come to."""
    returns, told = block.returns, outcome.info[len(REPORT) :]
    write_report(world, agent, block.remaining, outcome.info)
    for t in range(returns.shape[0]):
        for lane in range(world.lanes):
            told[t, agent, lane] = returns[t, agent, lane]
