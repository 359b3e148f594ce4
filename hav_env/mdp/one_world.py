"""This module steps one world, compiled for a single lane, with the same arrays at every step.

A loop over lanes takes longer to begin than one lane takes, and a call takes long to unwrap arrays.
Python takes long to make numbers and to name them, so it does so only for infos that change.
"""

import math
import struct
from typing import Any, NamedTuple

import numpy as np

from hav_env.compiled import NO_HELPERS, Held, arguments_of, entry, kernel
from hav_env.mdp.advance import Actions, advance_block
from hav_env.mdp.decision_process import DecisionProcess

_UNKNOWN = -1


class Changes(NamedTuple):
    """Infos that differed from their first value, for any HAV, since the episode began."""

    first: np.ndarray  # (K, C) infos at the beginning of the episode
    changed: np.ndarray  # (K,) bool
    number: np.ndarray  # (1,) int64: how many of them have changed
    values: np.ndarray  # (C * K,) the changed infos of each HAV, one HAV after the other


@entry
def advance_one(first, last, held):
    """Take (a part of) one action in each of a range of worlds, one world after the other.

    Args:
        first: First world of the range.
        last: World after the last of the range.
        held: The arguments of ``advance_block`` from ``task`` on, and then ``Changes``.
    """
    told = arguments_of(held)
    portion, outcome, changes = told[7], told[9], told[10]
    for w in range(first, last):
        advance_block(w, 1, 0, *told[:10])
        if portion.closes and portion.reports:
            _write_changes(changes, outcome.info, w)


@kernel
def _write_changes(changes, info, w):
    """Write the infos of a world that have changed since its episode began."""
    for k in range(info.shape[0]):
        for agent in range(info.shape[1]):
            if not changes.changed[k] and _differ(info[k, agent, w], changes.first[k, agent]):
                changes.changed[k] = True
                changes.number[0] += 1
    place = 0
    for agent in range(info.shape[1]):
        for k in range(info.shape[0]):
            if changes.changed[k]:
                changes.values[place] = info[k, agent, w]
                place += 1


@kernel
def _differ(one, other):
    """Return whether two numbers differ, be it in the sign of zero."""
    return one != other or math.copysign(1.0, one) != math.copysign(1.0, other)


class OneWorld:
    """Steps a decision process of one world, with the same arrays at every step.

    Attributes:
        outcome: The outcome that each step, and each beginning of an episode, overwrites.
    """

    def __init__(self, process: DecisionProcess) -> None:
        """Allocate the arrays."""
        self.outcome = process.outcome()
        size, controlled, _ = self.outcome.info.shape
        self._changes = changes = Changes(
            np.zeros((size, controlled)),
            np.zeros(size, np.bool_),
            np.zeros(1, np.int64),
            np.zeros(controlled * size),
        )
        actions, none = np.zeros((1, controlled, 2)), np.empty((0, controlled, 2), np.float32)
        self._arrays = Actions(none, actions), self.outcome, changes
        self._write_actions = struct.Struct(f"{actions.size}d").pack_into
        # buffers, because Python reads numbers from them faster than from arrays
        self._actions, self._counter = actions.data, changes.number.data
        self._values = changes.values[:0].data
        self._process = process
        self._advance: Any = None
        self._held_by_process: tuple[Held, ...] | None = None
        self._held: tuple[Held, ...] = ()
        self._first: list[dict[str, float]] = []  # infos of each HAV when the episode began
        self._changed: list[str] = []  # names of the infos that have changed since
        self._count = _UNKNOWN  # of them
        # a number that differs from all: the process may be a copy within an episode
        changes.first[:] = math.nan

    def begin(self) -> None:
        """Take note that an episode has begun; ``outcome`` has its infos if the process reports."""
        if self._process.always:
            changes = self._changes
            changes.first[:] = self.outcome.info[..., 0]
            changes.changed[:] = False
            changes.number[0] = 0
            self._first, self._count = [], _UNKNOWN

    def step(self, actions: list[float]) -> None:
        """Take the actions of all HAVs in order; they must be finite.

        Raises:
            RuntimeError: If no episode has begun.
        """
        self._write_actions(self._actions, 0, *actions)
        process = self._process
        if not process.all_begun:
            process.require_episodes("step")
        if process.held is not self._held_by_process:
            self._hold()
        for held in self._held:
            if process.driver is not None:
                process.command[:] = process.driver.decide()
            self._advance(NO_HELPERS, 1, (held,))

    def infos(self) -> list[dict[str, float]]:
        """Return the infos of each HAV by name, after a step or a beginning that reports."""
        if not self._process.always:
            return self._name(self.outcome.info[..., 0])
        count = self._counter[0]
        if count != self._count:
            self._note_changed(count)
        infos, numbers = [], iter(self._values.tolist())
        for first in self._first:
            named = first.copy()
            # a strict zip is slower: with it, a step would take about a tenth longer
            for name, number in zip(self._changed, numbers):  # noqa: B905
                named[name] = number
            infos.append(named)
        return infos

    def _note_changed(self, count: int) -> None:
        """Take note that this many infos have changed since the episode began."""
        changes = self._changes
        if not self._first:
            self._first = self._name(changes.first)
        chosen = zip(self._process.info, changes.changed.tolist(), strict=True)
        self._changed = [name for name, changed in chosen if changed]
        self._values = changes.values[: count * len(self._first)].data
        self._count = count

    def _name(self, numbers: np.ndarray) -> list[dict[str, float]]:
        names = self._process.info
        return [dict(zip(names, own, strict=True)) for own in numbers.T.tolist()]

    def _hold(self) -> None:
        """Make the constant arguments of steps from those of the process."""
        told = self._process.hold()
        self._held = tuple(Held(*one.arguments, *self._arrays) for one in told)
        self._advance = advance_one.prepare(self._held[0])
        self._held_by_process = told
