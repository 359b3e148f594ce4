"""This module has the arrays of a decision process: outcomes and persistent buffers."""

from typing import Any, NamedTuple

import numpy as np

from hav_env.compiled import ZEROS, kernel, lanes_from, of_width
from hav_env.mdp.reward import BEFORE_SIZE
from hav_env.models.quantities import Precision
from hav_env.observation import CHAIN_ROWS, SCRATCH_ROWS, Scratch
from hav_env.world.lanes import APART


class Outcome(NamedTuple):
    """Outcome of an action; the first C of the N HAVs of a world are controlled."""

    observation: np.ndarray  # (W, C, D) float32
    info: np.ndarray  # (K, C, W) the infos, then the returns so far by term; see ``Portion``
    reward: np.ndarray  # (C, W)
    terminated: np.ndarray  # (W,) bool
    truncated: np.ndarray  # (W,) bool


def outcome_size(controlled: int, columns: int, numbers: int) -> int:
    """Return the largest number of bytes of outcomes of one world that are in use at a time."""
    return controlled * (2 * 4 * columns + 4 * 8 * numbers)


def outcome_layout(
    num_worlds: int, controlled: int, columns: int, numbers: int
) -> list[tuple[tuple[int, ...], type]]:
    """Return shape and type of each array of an ``Outcome``, large arrays first.

    Args:
        num_worlds: Number of worlds W.
        controlled: C.
        columns: D, the number of observation columns.
        numbers: K, the number of infos of a HAV.
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
    """Arrays that persist between actions, and scratch."""

    command: np.ndarray  # (2, N, W) speed [m/s], steering [rad]
    remaining: np.ndarray  # (C, W) Dubins length to the goal [m]
    before: np.ndarray  # (C, BEFORE_SIZE, W)
    returns: np.ndarray  # (T, C, W) sums of the weighted terms since the episode began
    terms: np.ndarray  # (ranges, T, C, at most APART) of the reward, without weights
    columns: np.ndarray  # (ranges, D, APART) float32
    scratch: Scratch  # scratch of observations, one range for each thread
    filtered: np.ndarray  # (2, N, W) the command after the safety filter, or (2, 0, W) without one
    memory: np.ndarray  # (N, M, W) of the backup; M is 0 without one
    trial: np.ndarray  # (ranges, K, APART) scratch of the safety filter; K is 0 without one


# names of scratch arrays: their values are void between actions
SCRATCH = "buffers.terms", "buffers.columns", "buffers.scratch", "buffers.trial"


def allocate_buffers(
    num_worlds: int,
    num_havs: int,
    controlled: int,
    num_terms: int,
    num_columns: int,
    trial_rows: int,
    slots: int,
    precision: Precision = "double",
) -> Buffers:
    """Return allocated buffers, without the memory of a backup.

    Args:
        num_worlds: Number of worlds W.
        num_havs: N.
        controlled: C.
        num_terms: T, the number of reward terms.
        num_columns: D, the number of observation columns.
        trial_rows: K, the number of scratch rows of the safety filter; 0 without one.
        slots: Number of threads that may use the scratch at a time.
        precision: Precision of the state.
    """
    n, c, w, zeros = num_havs, controlled, num_worlds, ZEROS[precision]
    return Buffers(
        zeros((2, n, w), np.float64),
        zeros((c, w), np.float64),
        zeros((c, BEFORE_SIZE, w), np.float64),
        np.zeros((num_terms, c, w)),  # sums of many steps, in float32 they drift
        zeros((slots, num_terms, c, min(w, APART)), np.float64),
        zeros((slots, num_columns, APART), np.float32),
        Scratch(
            zeros((slots, SCRATCH_ROWS, APART), np.float32),
            zeros((slots, CHAIN_ROWS, APART), np.float64),
        ),
        zeros((2, n if trial_rows > 0 else 0, w), np.float64),
        zeros((n, 0, w), np.float64),
        zeros((slots, trial_rows, APART), np.float64),
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
        lanes_from(buffers.filtered, start),
        lanes_from(buffers.memory, start),
        of_width(buffers.trial[slot], APART),
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


def name_arrays(parts: dict[str, Any]) -> dict[str, np.ndarray]:
    """Return the arrays in nested named tuples, under dotted names, except scratch."""
    found: dict[str, np.ndarray] = {}
    for name, part in parts.items():
        if isinstance(part, np.ndarray) and not name.startswith(SCRATCH):
            found[name] = part
        elif hasattr(part, "_asdict"):
            inner = {f"{name}.{field}": one for field, one in part._asdict().items()}
            found |= name_arrays(inner)
    return found
