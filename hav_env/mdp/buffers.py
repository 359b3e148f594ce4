"""This module has the arrays of a decision process: outcomes, and buffers that last."""

from typing import NamedTuple

import numpy as np

from hav_env.compiled import kernel, lanes_from, of_width
from hav_env.mdp.reward import BEFORE_SIZE
from hav_env.observation import CHAIN_ROWS, SCRATCH_ROWS, Scratch
from hav_env.world.lanes import APART


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


def outcome_layout(
    num_worlds: int, controlled: int, columns: int, numbers: int
) -> list[tuple[tuple[int, ...], type]]:
    """Return shape and type of each array of an ``Outcome``, the large ones first.

    Args:
        num_worlds: W.
        controlled: C.
        columns: D, of the observation.
        numbers: K, how many are reported of a HAV.
    """
    w, c = num_worlds, controlled
    return [
        ((w, c, columns), np.float32),
        ((numbers, c, w), np.float64),
        ((c, w), np.float64),
        ((w,), np.bool_),
        ((w,), np.bool_),
    ]


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


@kernel
def buffers_from(buffers, start, slot):
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
def outcome_from(outcome, start):
    """Return the outcome of the worlds from ``start`` on."""
    return Outcome(
        outcome.observation[start:],
        lanes_from(outcome.info, start),
        lanes_from(outcome.reward, start),
        lanes_from(outcome.terminated, start),
        lanes_from(outcome.truncated, start),
    )
