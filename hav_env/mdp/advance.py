"""One action in a range of worlds, and what it led to: compiled."""

from typing import NamedTuple

import numpy as np

from hav_env.compiled import VECTOR, entry, kernel, lanes_from
from hav_env.maths.geometry import clip
from hav_env.mdp.info import REPORT, write_report
from hav_env.mdp.reward import WAITED, note_before, reward_terms
from hav_env.observation import observe, plan_route
from hav_env.simulator.transition import late, remove_arrived, step, terminated
from hav_env.world.lanes import APART, OBSERVED_LANES, block_of
from hav_env.world.sensing import limits


class Outcome(NamedTuple):
    """What an action led to; the first C of the N HAVs of a world are controlled."""

    observation: np.ndarray  # (W, C, D) float32
    numbers: np.ndarray  # (K + 1, C, W) report, returns so far by term; last the reward
    ends: np.ndarray  # (2, W) bool, rows TERMINATED, TRUNCATED


TERMINATED, TRUNCATED = range(2)


def outcome_size(controlled: int, columns: int, numbers: int) -> int:
    """Return how many bytes of one world all take that telling of it needs at a time."""
    return controlled * (2 * 4 * columns + 4 * 8 * numbers)


class Between(NamedTuple):
    """What is kept from action to action, and scratch."""

    command: np.ndarray  # (2, N, W) speed [m/s], steering [rad]
    remaining: np.ndarray  # (C, W) Dubins length to the goal [m]
    before: np.ndarray  # (C, BEFORE_SIZE, W)
    route: np.ndarray  # (C, ROUTE_SIZE, W)
    returns: np.ndarray  # (T, C, W) sums of the weighted terms since the episode began
    columns: np.ndarray  # (ranges, D, APART) float32


OPENING, STEPS, CLOSING = range(3)  # of an action: does it begin, for how many steps, does it end


@kernel
def _block_of_between(between, start, slot):
    return Between(
        lanes_from(between.command, start),
        lanes_from(between.remaining, start),
        lanes_from(between.before, start),
        lanes_from(between.route, start),
        lanes_from(between.returns, start),
        between.columns[slot],
    )


@kernel
def _block_of_outcome(outcome, start):
    return Outcome(
        outcome.observation[start:],
        lanes_from(outcome.numbers, start),
        lanes_from(outcome.ends, start),
    )


@entry
def advance_worlds(
    first, last, task, vehicle, reward, observation, worlds, between, actions, part, outcome
):
    """Take (a part of) one action in each of a range of worlds, and tell what it led to.

    Args:
        first, last: the range.
        task, vehicle, reward, observation: the models.
        worlds, between, outcome: the arrays of all worlds.
        actions: (W, C, 2) from -1 to 1, cut.
        part: OPENING .. CLOSING; others than the controlled HAVs may decide between parts.
    """
    duration = task.dt * part[STEPS]
    for start in range(first, last, OBSERVED_LANES):
        block = block_of(worlds, start, min(OBSERVED_LANES, last - start), worlds.units)
        own = _block_of_between(between, start, first // VECTOR)
        told = _block_of_outcome(outcome, start)
        for agent in range(actions.shape[1]):
            _command(block, own, agent, actions[start:])
            if part[OPENING]:
                note_before(block, agent, own.remaining, own.before)
        if part[OPENING]:
            remove_arrived(task, block)
        for _ in range(part[STEPS]):
            step(task, vehicle, block, own.command[0], own.command[1])
        if part[CLOSING]:
            for agent in range(actions.shape[1]):
                plan_route(block, agent, own.route, own.remaining)
                _reward(reward, duration, block, agent, own, told)
                _tell(observation, block, agent, own, told)
            for lane in range(block.lanes):
                over = terminated(task, block, actions.shape[1], lane)
                told.ends[TERMINATED, lane] = over
                told.ends[TRUNCATED, lane] = late(task, block, lane) and not over


@entry
def look_at_worlds(first, last, observation, worlds, between, chosen, outcome):
    """Tell what is seen in those of a range of worlds where ``chosen`` (W,) is true."""
    for w in range(first, last):
        if chosen[w]:
            alone = block_of(worlds, w, 1, worlds.units)
            own = _block_of_between(between, w, first // VECTOR)
            told = _block_of_outcome(outcome, w)
            for agent in range(outcome.numbers.shape[1]):
                plan_route(alone, agent, own.route, own.remaining)
                _tell(observation, alone, agent, own, told)


@kernel
def to_command(faster, turned, speed_max, steering_max):
    """Return speed [m/s] and steering [rad] of an action, both of whose numbers are cut to [-1, 1].

    -1 is standing, 1 is full speed; -1 is as far right as the wheels go, 1 as far left.
    """
    share = 0.5 * (clip(faster, -1.0, 1.0) + 1.0)
    return share * speed_max, clip(turned, -1.0, 1.0) * steering_max


@kernel
def _command(world, own, agent, actions):
    """Turn actions into speed and steering."""
    for lane in range(world.lanes):
        speed_max, steering_max, _ = limits(world, agent, lane)
        own.command[0, agent, lane], own.command[1, agent, lane] = to_command(
            actions[lane, agent, 0], actions[lane, agent, 1], speed_max, steering_max
        )


@kernel
def _reward(reward, duration, world, agent, own, told):
    """Work out the weighted sum of the terms, and what each has come to since the beginning."""
    terms, total = told.numbers[len(REPORT) :], told.numbers[-1]
    reward_terms(reward, duration, world, agent, own.before, own.remaining, terms)
    for lane in range(world.lanes):
        total[agent, lane] = 0.0
    for t in range(len(reward)):
        for lane in range(world.lanes):
            acts = own.before[agent, WAITED, lane] == 0.0
            value = reward[t] * terms[t, agent, lane] if acts else 0.0
            own.returns[t, agent, lane] += value
            terms[t, agent, lane] = own.returns[t, agent, lane]
            total[agent, lane] += value


@kernel
def _tell(observation, world, agent, own, told):
    """Write the report and the observation."""
    write_report(world, agent, own.remaining, told.numbers)
    # with this said, the compiler knows how far the rows lie apart, and uses vectors
    if own.columns.shape[1] == APART:
        observe(observation, world, agent, own.route, own.columns)
    for lane in range(world.lanes):
        for column in range(own.columns.shape[0]):
            told.observation[lane, agent, column] = own.columns[column, lane]
