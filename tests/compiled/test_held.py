"""Held arguments arrive in compiled code unchanged, and never become outdated."""

import copy
import gc
import pickle
from typing import NamedTuple

import numpy as np
import pytest

from hav_env import Reward
from hav_env.compiled import Held, arguments_of, entry
from hav_env.mdp.decision_process import DecisionProcess
from tests.support.comparing import exactly


class Inner(NamedTuple):
    """Numbers of several kinds."""

    share: float
    count: int
    flag: bool
    nothing: None
    short: np.float32
    pair: tuple[int, int]


class Outer(NamedTuple):
    """Arrays of several kinds, beside them."""

    inner: Inner
    whole: np.ndarray
    flags: np.ndarray
    apart: np.ndarray


@entry
def read_held(first, last, held, found):
    """Write the held arguments."""
    outer, last_word = arguments_of(held)
    inner = outer.inner
    for k in range(first, last):
        found[k, 0] = inner.share
        found[k, 1] = inner.count
        found[k, 2] = 1.0 if inner.flag else 0.0
        found[k, 3] = inner.short
        found[k, 4] = inner.pair[0] - inner.pair[1]
        found[k, 5] = outer.whole[k, 2]
        found[k, 6] = 1.0 if outer.flags[k] else 0.0
        found[k, 7] = outer.apart[k, 1]
        found[k, 8] = last_word
        outer.whole[k, 0] += 1


def made(share=0.1):
    inner = Inner(share, -(2**40), True, None, np.float32(0.3), (7, 9))
    apart = np.arange(40.0).reshape(10, 4)[::2, ::-1]
    return Outer(inner, np.arange(15).reshape(5, 3), np.arange(5) % 2 == 0, apart)


def read(held):
    found = np.zeros((5, 9))
    read_held(5, held, found)
    return found


def expected(outer, last):
    inner = outer.inner
    numbers = [inner.share, inner.count, inner.flag, inner.short, inner.pair[0] - inner.pair[1]]
    return np.column_stack(
        [
            *(np.full(5, number, float) for number in numbers),
            *(outer.whole[:, 2], outer.flags, outer.apart[:, 1], np.full(5, last)),
        ]
    )


def test_numbers_and_arrays_arrive_as_they_are():
    outer = made()
    assert exactly(read(Held(outer, 2.5))) == exactly(expected(outer, 2.5))
    assert outer.whole[:, 0].tolist() == [1, 4, 7, 10, 13]  # written in place


def test_arrays_live_as_long_as_they_are_held():
    outer = made()
    held, then = Held(outer, 2.5), expected(outer, 2.5)
    del outer
    gc.collect()
    others = [np.full((5, 3), -1) for _ in range(100)]
    assert exactly(read(held)) == exactly(then)
    assert all((other == -1).all() for other in others)


@pytest.mark.parametrize(
    "again", [copy.copy, copy.deepcopy, lambda held: pickle.loads(pickle.dumps(held))]
)
def test_a_copy_points_at_arrays_that_it_holds(again):
    held = Held(made(), 2.5)
    other = again(held)
    del held
    gc.collect()
    assert exactly(read(other)) == exactly(expected(made(), 2.5))


def test_what_cannot_be_held_is_named():
    with pytest.raises(TypeError, match="str cannot be held, but numbers and arrays can"):
        Held((1, "two"))


def begun(process):
    worlds = process.num_worlds
    everywhere, numbers = np.ones(worlds, np.bool_), np.zeros(worlds, np.int64)
    process.begin(np.arange(worlds), numbers, everywhere, process.outcome())
    return process


def test_a_process_never_steps_with_what_it_held_before():
    process, twin = begun(DecisionProcess(3)), begun(DecisionProcess(3, reward=Reward(time=-7.0)))
    actions = np.ones((3, 2, 2))
    first, first_too = process.step(actions), twin.step(actions)
    assert exactly(first.observation) == exactly(first_too.observation)
    assert (first.reward != first_too.reward).all()
    process.set_reward(Reward(time=-7.0))
    assert exactly(process.step(actions).reward) == exactly(twin.step(actions).reward)
    process.report(always=False)
    outcome = process.outcome()
    outcome.info[:] = np.nan
    assert np.isnan(process.step(actions, outcome).info).all()
    process.report(always=True)
    twin.step(actions)
    assert exactly(process.step(actions).info[0]) == exactly(twin.step(actions).info[0])


@pytest.mark.parametrize(
    "again", [copy.deepcopy, lambda process: pickle.loads(pickle.dumps(process))]
)
def test_a_copy_of_a_process_steps_its_own_worlds(again):
    process = begun(DecisionProcess(3))
    actions = np.ones((3, 2, 2))
    process.step(actions)
    other = again(process)
    told = process.step(actions)
    assert exactly(tuple(other.step(actions))) == exactly(tuple(told))
