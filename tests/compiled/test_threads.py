"""Threads share the worlds: every world once, errors are raised, several callers may start."""

import threading
import time
import types

import numba
import numpy as np
import pytest

from hav_env.compiled import VECTOR, entries, entry, share_out
from tests.support.networks import forward_worlds, random_network


@pytest.mark.parametrize("threads", [1, 2, 3, 7])
@pytest.mark.parametrize("count", [0, 1, 15, 16, 17, 100, 1_000])
def test_every_world_is_worked_on_once(count, threads):
    worlds, ranges = np.zeros(count, int), []

    def mark(first, last, step):
        ranges.append((first, last))
        worlds[first:last] += step

    share_out(mark, count, (3,), threads)
    assert (worlds == 3).all()
    assert len(ranges) <= threads
    assert all(first % VECTOR == 0 for first, _ in ranges)


def test_threads_work_at_the_same_time():
    meeting = threading.Barrier(3, timeout=30)  # passed only if three are there
    share_out(lambda first, last: meeting.wait(), 3 * VECTOR, (), 3)


@pytest.mark.parametrize("bad", [0, 1, 2])
def test_an_error_is_raised_after_all_are_done(bad):
    done = []

    def fail(first, last):
        if first == bad * VECTOR:
            raise ArithmeticError(f"in {first}")
        done.append(first)

    for _ in range(3):  # helpers that failed are available again
        with pytest.raises(ArithmeticError, match=f"in {bad * VECTOR}"):
            share_out(fail, 3 * VECTOR, (), 3)
        assert sorted(done) == [k * VECTOR for k in range(3) if k != bad]
        done.clear()


def test_several_may_share_out_at_once():
    totals = np.zeros((4, 200, 64), int)

    def add(first, last, own):
        own[first:last] += 1

    def ask(caller):
        for turn in range(200):
            share_out(add, 64, (totals[caller, turn],), 2)

    callers = [threading.Thread(target=ask, args=(k,)) for k in range(4)]
    for caller in callers:
        caller.start()
    for caller in callers:
        caller.join()
    assert (totals == 1).all()


def test_several_may_be_the_first_to_call_an_entry(monkeypatch):
    """One of them makes the loop, and the others wait for it."""
    network, made = random_network(), []
    loop = entry(forward_worlds.__wrapped__)

    def slow(**options):
        made.append(options)
        time.sleep(0.1)
        return numba.njit(**options)

    its_numba = types.SimpleNamespace(**vars(numba) | {"njit": slow})  # not the one of Numba itself
    monkeypatch.setattr(entries, "numba", its_numba)
    rows = np.zeros((4, 200, 8))
    callers = [
        threading.Thread(target=loop, args=(8, network, own), kwargs={"threads": 1}) for own in rows
    ]
    for caller in callers:
        caller.start()
    for caller in callers:
        caller.join()
    assert len(made) == 1
    assert (rows[:, :2] == rows[0, :2]).all()
    assert (rows[:, 0] != 0.0).all()
