"""After an interrupt at any moment, the next step and the next reset equal those without one."""

import os
import signal
import threading
import time
from unittest import mock

import numpy as np
import pytest

import hav_env
from hav_env.compiled import VECTOR, run_on_threads, share_out
from hav_env.mdp import decision_process
from hav_env.mdp.decision_process import DecisionProcess
from tests.support.budgets import budget

# Python reports an interrupt in a finalizer or in a callback of the garbage collector, and does not
# raise it
pytestmark = pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")

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


@pytest.mark.parametrize("own_takes", [0.0, 0.05, 0.4])
@pytest.mark.parametrize("helper_takes", [0.0, 0.05, 0.4])
def test_an_interrupt_waits_until_every_world_is_done_once(own_takes, helper_takes):
    main, done = threading.get_ident(), []

    def loop(first, last):
        time.sleep(own_takes if threading.get_ident() == main else helper_takes)
        done.append(first)

    expected = [k * VECTOR for k in range(THREADS)]
    interrupted(lambda: share_out(loop, THREADS * VECTOR, (), THREADS), 0.1)
    share_out(lambda first, last: None, 1, (), THREADS)  # finishes the remaining work
    # an interrupt can split only a loop in Python: compiled ones are one call
    assert len(done) == len(set(done)) >= THREADS - 1
    done.clear()
    share_out(loop, THREADS * VECTOR, (), THREADS)
    assert sorted(done) == expected


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
    began = time.perf_counter()
    for _ in range(3):
        twin.step(actions)
    begin(twin, 3)
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
def test_a_child_that_was_forked_in_a_step_has_helpers_of_its_own():
    share_out(lambda first, last: None, THREADS * VECTOR, (), THREADS)
    child = os.fork()
    if child == 0:
        done = []
        share_out(lambda first, last: done.append(first), THREADS * VECTOR, (), THREADS)
        os._exit(0 if len(done) == THREADS else 1)
    assert os.waitpid(child, 0)[1] == 0
