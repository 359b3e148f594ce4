"""This module advances a range of worlds by one action, compiled, and records the outcome."""

from typing import NamedTuple

import numpy as np

from hav_env.compiled import VECTOR, arguments_of, entry, kernel, like, loop_kernel
from hav_env.maths.geometry import clip
from hav_env.mdp.buffers import buffers_from, outcome_from
from hav_env.mdp.info import REPORT, write_interventions, write_obstacle_report, write_report
from hav_env.mdp.reward import WAITED, note_before, reward_terms
from hav_env.observation import observe, plan_route, write_rows
from hav_env.safety import filter_commands
from hav_env.simulator.transition import late, remove_arrived, step, terminated
from hav_env.world.lanes import OBSERVED_LANES, block_of
from hav_env.world.sensing import limits


class Actions(NamedTuple):
    """Actions as the user passed them, in one of two precisions; the other array is empty."""

    single: np.ndarray  # (W, C, 2) float32 from -1 to 1, or (0, C, 2)
    double: np.ndarray  # (W, C, 2) from -1 to 1, or (0, C, 2)


class Portion(NamedTuple):
    """Some of the steps of an action; other HAVs may decide between two portions."""

    opens: bool
    """Whether the action begins with this portion."""
    steps: int
    """Number of steps of the simulator."""
    closes: bool
    """Whether the action ends with this portion."""
    reports: bool
    """Whether to report on every world; otherwise only on worlds whose episodes end."""


def divide_action(frame_skip: int, driven: bool, reports: bool) -> tuple[Portion, ...]:
    """Return the portions of an action: one, or its steps if other HAVs decide before each.

    Args:
        frame_skip: Number of simulator steps for which the action is held.
        driven: Whether a policy drives other HAVs.
        reports: Whether to report on every world.
    """
    if not driven:
        return (Portion(True, frame_skip, True, reports),)
    last = frame_skip - 1
    return tuple(Portion(k == 0, 1, k == last, reports) for k in range(frame_skip))


@entry
def advance_worlds(first, last, held, actions, outcome):
    """Take (a part of) one action in each of a range of worlds.

    Args:
        first: First world of the range.
        last: World after the last of the range.
        held: Task, vehicle, safety, reward, observation, worlds, buffers and portion, as for
            ``advance_block``.
        actions: ``Actions`` of all worlds, clipped.
        outcome: Outcome of all worlds; written when the action ends.
    """
    task, vehicle, safety, reward, observation, worlds, buffers, portion = arguments_of(held)
    _advance(
        first,
        last,
        task,
        vehicle,
        safety,
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
    first,
    last,
    task,
    vehicle,
    safety,
    reward,
    observation,
    worlds,
    buffers,
    portion,
    actions,
    outcome,
):
    """Take (a part of) one action in each of a range of worlds, as ``advance_block`` does."""
    for start in range(first, last, OBSERVED_LANES):
        advance_block(
            start,
            min(OBSERVED_LANES, last - start),
            first // VECTOR,
            task,
            vehicle,
            safety,
            reward,
            observation,
            worlds,
            buffers,
            portion,
            actions,
            outcome,
        )


@kernel
def advance_block(
    start,
    lanes,
    slot,
    task,
    vehicle,
    safety,
    reward,
    observation,
    worlds,
    buffers,
    portion,
    actions,
    outcome,
):
    """Take (a part of) one action in each world of a block, and write the outcome.

    Args:
        start: First world of the block.
        lanes: Number of its worlds.
        slot: Index of the scratch columns that this thread may use.
        task: Rules of the episode.
        vehicle: Vehicle model (kinematics).
        safety: Safety filter of the commands, or ``Backed``.
        reward: Weights of the reward.
        observation: Observation settings, as ``settle`` returns them.
        worlds: Arrays of all worlds.
        buffers: Buffers of all worlds.
        portion: ``Portion`` of the action.
        actions: ``Actions`` of all worlds, clipped.
        outcome: Outcome of all worlds; written when the action ends.
    """
    duration, controlled = task.dt * like(portion.steps, task.dt), outcome.info.shape[1]
    world = block_of(worlds, start, lanes, worlds.units)
    block, result = buffers_from(buffers, start, slot), outcome_from(outcome, start)
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
        arrays = block.command, block.filtered, block.memory, block.trial
        speed, steering = filter_commands(safety, task, vehicle, world, *arrays)
        step(task, vehicle, world, speed, steering)
    if portion.closes:
        for agent in range(controlled):
            plan_route(world, agent, block.scratch, block.remaining)
            _reward(reward, duration, world, agent, block, block.terms, result)
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
    """Write the observations of those worlds of a range where ``chosen`` (W,) is true."""
    for w in range(first, last):
        if chosen[w]:
            world = block_of(worlds, w, 1, worlds.units)
            observe_block(observation, world, buffers, w, first // VECTOR, True, outcome)


@kernel
def observe_block(observation, world, buffers, start, slot, reports, outcome):
    """Write the observations of a block of worlds in which no action has just been taken.

    Rewards are zero, and nothing has ended.

    Args:
        observation: Observation settings, as ``settle`` returns them.
        world: Block of worlds.
        buffers: Buffers of all worlds.
        start: Index of the block's first world.
        slot: Index of the scratch columns that this thread may use.
        reports: Whether to write the infos.
        outcome: Outcome of all worlds, to write.
    """
    block, result = buffers_from(buffers, start, slot), outcome_from(outcome, start)
    for agent in range(result.info.shape[1]):
        plan_route(world, agent, block.scratch, block.remaining)
        _write_outcome(observation, world, agent, block, result)
        if reports:
            _report(world, agent, block, result)
        for lane in range(world.lanes):
            result.reward[agent, lane] = 0.0
    for lane in range(world.lanes):
        result.terminated[lane] = result.truncated[lane] = False


@kernel
def to_command(faster, turned, speed_max, steering_max):
    """Return speed [m/s] and steering [rad] of an action, whose numbers are clipped to [-1, 1].

    Speed: -1 is standing, 1 is full speed. Steering: -1 is full right, 1 is full left.
    """
    share = 0.5 * (clip(faster, -1.0, 1.0) + 1.0)
    return share * speed_max, clip(turned, -1.0, 1.0) * steering_max


@kernel
def _command(world, block, agent, actions):
    """Convert actions to speed and steering."""
    for lane in range(world.lanes):
        speed_max, steering_max, _ = limits(world, agent, lane)
        block.command[0, agent, lane], block.command[1, agent, lane] = to_command(
            float(actions[lane, agent, 0]), float(actions[lane, agent, 1]), speed_max, steering_max
        )


@kernel
def _reward(reward, duration, world, agent, block, terms, outcome):
    """Compute the reward terms, their weighted sum, and the returns by term."""
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
    """Write the report on a HAV and its returns by term."""
    returns, told = block.returns, outcome.info[len(REPORT) :]
    write_report(world, agent, block.remaining, outcome.info)
    others = told[returns.shape[0] :]
    written = write_obstacle_report(world.place, world, agent, others)
    write_interventions(world, agent, others[written:])
    for t in range(returns.shape[0]):
        for lane in range(world.lanes):
            told[t, agent, lane] = returns[t, agent, lane]
