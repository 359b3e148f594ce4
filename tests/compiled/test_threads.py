"""Threads share the worlds: every world once, errors are raised, several callers may start."""

import functools
import subprocess
import sys
import threading
import time
import types

import numba
import numpy as np
import pytest

from hav_env.compiled import VECTOR, crew_of, disk_cache, entry
from hav_env.compiled.sharing import _free, _new_lock, _take, _take_from_python
from tests.support.budgets import COMPILED
from tests.support.networks import forward_worlds, random_network
from tests.support.paths import ROOT

pytestmark = pytest.mark.usefixtures("eight_cores")
compiled_only = pytest.mark.skipif(not COMPILED, reason="plain Python uses one thread")


def mark(first, last, worlds, begins):
    begins[first] += 1
    for k in range(first, last):
        worlds[k] += 1


mark_worlds = entry(mark)
mark_singly = entry(types.FunctionType(mark.__code__, globals(), "mark_singly"), portion=1)


@pytest.mark.parametrize(("loop", "portion"), [(mark_worlds, VECTOR), (mark_singly, 1)])
@pytest.mark.parametrize("threads", [1, 2, 3, 7, 20])
@pytest.mark.parametrize("count", [0, 1, 15, 16, 17, 41, 100, 1_000])
def test_every_world_is_worked_on_once(loop, portion, threads, count):
    worlds, begins = np.zeros((2, count + 1), int)
    for turn in range(1, 4):
        loop(count, worlds, begins, threads=threads)
        assert (worlds[:count] == turn).all()
    places = np.flatnonzero(begins)
    assert len(places) <= min(threads, 8)
    assert (places % portion == 0).all()
    if COMPILED and count > 0:
        shares = np.diff([*places, count])
        assert shares.max() < count / min(threads, 8) + portion


@entry
def meet(first, last, lock):
    """Wait in the first range for the last one, which another thread must run."""
    if first == 0:
        _take(lock, 1)
    else:
        _free(lock)


@compiled_only
def test_threads_work_at_the_same_time():
    lock = _new_lock()
    _take_from_python(lock, 0)
    for _ in range(100):
        meet(2 * VECTOR, lock, threads=2)


@entry
def fail(first, last, bad, done):
    """Raise an error in the range of one world."""
    if first <= bad < last:
        raise ArithmeticError("a bad world")
    for k in range(first, last):
        done[k] += 1


@pytest.mark.parametrize("bad", [0, VECTOR, 2 * VECTOR])
def test_an_error_is_raised_after_all_are_done(bad):
    for _ in range(3):  # helpers that failed are available again
        done = np.zeros(3 * VECTOR, int)
        with pytest.raises(ArithmeticError, match="a bad world"):
            fail(len(done), bad, done, threads=3)
        expected = np.full(len(done), int(COMPILED))
        expected[bad : bad + VECTOR] = 0
        assert (done == expected).all()


def test_several_may_share_out_at_once():
    totals = np.zeros((4, 200, 64), int)
    begins = np.zeros((4, 64), int)

    def ask(caller):
        for turn in range(200):
            mark_worlds(64, totals[caller, turn], begins[caller], threads=2)

    callers = [threading.Thread(target=ask, args=(k,)) for k in range(4)]
    for caller in callers:
        caller.start()
    for caller in callers:
        caller.join()
    assert (totals == 1).all()


def test_threads_are_no_more_than_cores(monkeypatch):
    monkeypatch.setattr("hav_env.compiled.threads._cores", lambda: 1)
    _, mailboxes = crew_of(5).arguments
    assert len(mailboxes) == 0


def helpers():
    """Return the number of threads that wait for work, without those that are about to leave."""
    deadline, found = time.monotonic() + 5.0, -1
    while time.monotonic() < deadline:
        alive = sum(thread.name == "hav_env" for thread in threading.enumerate())
        if alive == found:
            break
        found = alive
        time.sleep(0.1)
    return found


@compiled_only
def test_several_may_be_the_first_to_need_helpers():
    """They need one crew; those of the others leave."""
    before, gate = helpers(), threading.Barrier(8)

    def ask(threads):
        gate.wait()
        mark_worlds(64, *np.zeros((2, 64), int), threads=threads)

    # more threads than cores are as many as cores
    callers = [threading.Thread(target=ask, args=(threads,)) for threads in [8, 9, 20, 64] * 2]
    for caller in callers:
        caller.start()
    for caller in callers:
        caller.join()
    assert helpers() == before + 7


@compiled_only
def test_helpers_leave_if_another_cannot_start(monkeypatch):
    before, begin, begun = helpers(), threading.Thread.start, []

    def start(thread):
        begun.append(thread)
        if len(begun) == 3:
            raise RuntimeError("can't start new thread")
        begin(thread)

    worlds = np.zeros((2, 64), int)
    with monkeypatch.context() as patched:
        patched.setattr(threading.Thread, "start", start)
        with pytest.raises(RuntimeError, match="can't start"):
            mark_worlds(64, *worlds, threads=4)
    assert helpers() == before
    mark_worlds(64, *worlds, threads=4)
    assert (worlds[0] == 1).all()
    assert helpers() == before + 3


@compiled_only
def test_threads_that_share_the_one_of_their_caller_do_not_wait():
    """As those of gevent, in a process of its own that can be ended."""
    program = (
        "import threading, types, numpy as np; from hav_env.compiled import threads;"
        "threads._cores = lambda: 3; from tests.compiled.test_threads import mark_worlds;"
        "threads.threading = types.SimpleNamespace(**vars(threading) | {'Thread':"
        " lambda target, args, **_: types.SimpleNamespace("
        "start=lambda: target(*args), join=lambda: None)});"
        "worlds = np.zeros((2, 64), int); mark_worlds(64, *worlds, threads=3);"
        "print((worlds[0] == 1).all())"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode, done.stdout) == (0, "True\n"), done.stderr


@compiled_only
def test_a_process_ends_while_its_helpers_wait():
    program = (
        "import numpy as np; from hav_env.compiled import threads; threads._cores = lambda: 3;"
        "from tests.compiled.test_threads import mark_worlds;"
        "mark_worlds(64, *np.zeros((2, 64), int), threads=3); print('done')"
    )
    command = [sys.executable, "-X", "faulthandler", "-c", program]
    done = subprocess.run(
        command, cwd=ROOT, capture_output=True, text=True, timeout=120, check=False
    )
    assert (done.returncode, done.stdout) == (0, "done\n"), done.stderr


def test_several_may_be_the_first_to_call_an_entry(monkeypatch):
    """One of them makes the loop, and the others wait for it."""
    network, made = random_network(), []
    loop = entry(forward_worlds.__wrapped__)

    def slow(**options):
        made.append(options)
        time.sleep(0.1)
        return numba.njit(**options)

    its_numba = types.SimpleNamespace(**vars(numba) | {"njit": slow})  # not the one of Numba itself
    monkeypatch.setattr(disk_cache, "numba", its_numba)
    rows = np.zeros((4, 200, 8))
    call = functools.partial(loop, 8, network)
    callers = [threading.Thread(target=call, args=(own,), kwargs={"threads": 1}) for own in rows]
    for caller in callers:
        caller.start()
    for caller in callers:
        caller.join()
    assert len(made) == 1
    assert (rows[:, :2] == rows[0, :2]).all()
    assert (rows[:, 0] != 0.0).all()
