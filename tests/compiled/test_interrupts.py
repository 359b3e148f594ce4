"""After an interrupt at any moment, the next step and the next reset equal those without one."""

import functools
import os
import signal
import threading
import time
from unittest import mock

import numpy as np
import pytest
from numba.core.compiler_lock import global_compiler_lock

import hav_env
from hav_env.compiled import VECTOR, crew_of, entry, run_on_threads
from hav_env.mdp import decision_process
from hav_env.mdp.decision_process import DecisionProcess
from tests.support.budgets import COMPILED, budget

# Python reports an interrupt in a finalizer or in a callback of the garbage collector, and does not
# raise it
pytestmark = [
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.usefixtures("eight_cores"),
]

THREADS = 4


def interrupted(call, delay):
    """Call a function, and interrupt it after a delay [s]; return whether it was interrupted."""
    kept = signal.signal(signal.SIGALRM, signal.default_int_handler)
    try:
        try:
            signal.setitimer(signal.ITIMER_REAL, max(delay, 1e-6))
            call()
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
    except KeyboardInterrupt:
        return True
    finally:
        signal.signal(signal.SIGALRM, kept)
    return False


@entry
def slow(first, last, rounds, done):
    """Count the visits of each world after some work."""
    for k in range(first, last):
        x = 1.0
        for _ in range(rounds):
            x = x * 1.0000001 + 1e-9
        done[k] += x > 0.0


@pytest.mark.skipif(not COMPILED, reason="plain Python can be interrupted within a loop")
@pytest.mark.parametrize("delay", [1e-6, 1e-4, 0.01, 0.05])
def test_an_interrupt_waits_until_every_world_is_done_once(delay):
    done = np.zeros(THREADS * VECTOR, int)
    call = functools.partial(slow, len(done), 4_000_000, done, threads=THREADS)
    call()
    for turn in range(2, 5):
        assert interrupted(call, delay)
        while done.max() < turn:  # the interrupt came before the loop
            call()
        assert (done == turn).all()
        time.sleep(0.01)
        assert (done == turn).all()  # no thread writes any more


def process():
    scenario = hav_env.RandomPoses(num_havs=2)
    with mock.patch.object(decision_process, "_HAVS_PER_THREAD", 1):
        return DecisionProcess(budget(1024, 40), scenario=scenario, threads=THREADS)


def begin(made, seed):
    w = made.num_worlds
    chosen = np.ones(w, np.bool_)
    told = made.outcome()
    made.begin(np.full(w, seed), np.arange(w), chosen, told)
    return told


def test_thirty_interrupts_at_random_moments_leave_every_world_in_step():
    """An interrupted step was taken in all worlds or in none, and nothing hangs."""
    random = np.random.default_rng(1)
    made, twin = process(), process()
    begin(made, 3), begin(twin, 3)
    actions = random.uniform(-1.0, 1.0, (made.num_worlds, 2, 2))
    made.step(actions), twin.step(actions)  # compiles
    began = time.perf_counter()
    for _ in range(3):
        twin.step(actions)
    begin(made, 3), begin(twin, 3)
    length = (time.perf_counter() - began) / 4
    hits = 0
    for _ in range(budget(30, 3)):
        steps = twin.batch.worlds.state.clock[0, 0]
        hits += interrupted(lambda: made.step(actions), random.uniform(0.0, 1.2 * length))
        clock = made.batch.worlds.state.clock[0]
        if made.num_worlds > 64:  # plain Python can be interrupted within a loop
            assert (clock == clock[0]).all()
            for _ in range(clock[0] - steps):
                twin.step(actions)
        else:
            begin(made, 3), begin(twin, 3)
        mine, theirs = made.step(actions), twin.step(actions)
        assert np.array_equal(mine.observation, theirs.observation)
        assert np.array_equal(mine.info, theirs.info, equal_nan=True)
        assert np.array_equal(mine.reward, theirs.reward)
    assert hits > 0
    assert np.array_equal(begin(made, 9).observation, begin(twin, 9).observation)


def test_an_interrupted_beginning_is_finished_too():
    random = np.random.default_rng(2)
    made, twin = process(), process()
    for turn in range(budget(10, 2)):
        interrupted(lambda turn=turn: begin(made, turn), random.uniform(0.0, 0.004))
        assert np.array_equal(begin(made, turn).observation, begin(twin, turn).observation)


def test_an_interrupt_lets_loops_on_threads_end_early():
    stopped, ended = threading.Event(), []

    def loop(item):
        assert stopped.wait(60.0)
        ended.append(item)

    assert interrupted(lambda: run_on_threads(loop, range(9), 2, stopped.set), 0.2)
    assert len(ended) == 2  # those that had begun, none of which still runs


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")
def test_a_child_has_helpers_of_its_own():
    done = np.zeros(THREADS * VECTOR, int)
    slow(len(done), 1, done, threads=THREADS)
    parents = crew_of(THREADS).address
    child = os.fork()
    if child == 0:
        for _ in range(100):
            slow(len(done), 1, done, threads=THREADS)
        os._exit(0 if (done == 101).all() and crew_of(THREADS).address != parents else 1)
    assert os.waitpid(child, 0)[1] == 0


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")
def test_a_child_has_helpers_even_if_a_thread_of_its_parent_compiles():
    done = np.zeros(THREADS * VECTOR, int)
    slow(len(done), 1, done, threads=THREADS)
    compiles, ends = threading.Event(), threading.Event()

    def compile_until_the_end():
        with global_compiler_lock:
            compiles.set()
            assert ends.wait(60.0)

    other = threading.Thread(target=compile_until_the_end)
    other.start()
    assert compiles.wait(60.0)
    child = os.fork()
    if child == 0:
        signal.alarm(20)  # ends a child that waits for the lock
        slow(len(done), 1, done, threads=THREADS)
        os._exit(0 if (done == 2).all() else 1)
    ends.set()
    other.join()
    assert os.waitpid(child, 0)[1] == 0
