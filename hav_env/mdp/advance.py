"""This module advances a range of worlds by one action, compiled, and records the outcome."""

from typing import NamedTuple

import numpy as np

from hav_env.compiled import VECTOR, arguments_of, entry, kernel, loop_kernel
from hav_env.maths.geometry import clip
from hav_env.mdp.buffers import buffers_from, outcome_from
from hav_env.mdp.info import REPORT, write_obstacle_report, write_report
from hav_env.mdp.reward import WAITED, note_before, reward_terms
from hav_env.observation import observe, plan_route, write_rows
from hav_env.simulator.transition import late, remove_arrived, step, terminated
from hav_env.world.lanes import OBSERVED_LANES, block_of
from hav_env.world.sensing import limits


class Actions(NamedTuple):
    """Actions as the user holds them: in one of two precisions; the other array is empty."""

    single: np.ndarray  # (W, C, 2) float32 from -1 to 1, or (0, C, 2)
    double: np.ndarray  # (W, C, 2) from -1 to 1, or (0, C, 2)


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
            buffers_from(buffers, start, first // VECTOR),
            outcome_from(outcome, start),
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
    block, result = buffers_from(buffers, start, slot), outcome_from(outcome, start)
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
            block, result = buffers_from(buffers, w, 0), outcome_from(outcome, w)
            for agent in range(outcome.info.shape[1]):
                _report(world, agent, block, result)


@kernel
def _report(world, agent, block, outcome):
    """Write the report on a HAV, and what each term of its reward has come to."""
    returns, told = block.returns, outcome.info[len(REPORT) :]
    write_report(world, agent, block.remaining, outcome.info)
    write_obstacle_report(world.place, world, agent, told[returns.shape[0] :])
    for t in range(returns.shape[0]):
        for lane in range(world.lanes):
            told[t, agent, lane] = returns[t, agent, lane]
