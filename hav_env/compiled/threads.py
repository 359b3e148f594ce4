"""This module runs loops that release the GIL on a pool of threads."""

import collections
import concurrent.futures
import functools
import itertools
import os
import queue
import threading
from collections.abc import Callable, Iterable

VECTOR = 16  # lanes to work on whole vectors: worlds are shared out in such portions


def default_threads() -> int:
    """Return how many threads an entry uses: ``HAV_THREADS``, or the cores this process may use.

    Raises:
        ValueError: when ``HAV_THREADS`` is not a whole number of at least 1.
    """
    wish = os.environ.get("HAV_THREADS")
    if not wish:
        return (
            len(os.sched_getaffinity(0))
            if hasattr(os, "sched_getaffinity")
            else os.cpu_count() or 1
        )
    if not wish.isdigit() or int(wish) < 1:
        raise ValueError(f"HAV_THREADS is {wish!r}, but must be a whole number of at least 1")
    return int(wish)


def share_out(loop: Callable, count: int, args: tuple, threads: int) -> None:
    """Run a loop over worlds on threads, each of which takes a range of them; this one, too.

    An interrupt (Ctrl-C) is raised when the loop is done everywhere: no world is left behind, and
    nobody writes into the arrays any more.
    """
    _finish_interrupted()
    share = -(-count // (threads * VECTOR)) * VECTOR
    if count <= share:
        loop(0, count, *args)
        return
    spans = [(first, min(first + share, count), *args) for first in range(0, count, share)]
    _run(_Batch(loop, spans), _helpers(os.getpid(), threads))


class _Batch:
    """A loop and the ranges of worlds that it is to run over, each of them once.

    An interrupt may come between any two instructions of the main thread's Python, but not within a
    call of C. So what must not be torn apart is one such call: to take a range, run it and note it;
    to hand the batch on to helpers and note to how many.
    """

    def __init__(self, loop: Callable, spans: list[tuple]) -> None:
        self._loop, self._left = loop, iter(spans)
        self._others = len(spans) - 1
        self._done: collections.deque[None] = collections.deque()
        self._seats: list[threading.Lock] = []
        self._taken: list[None] = []  # as long as seats were handed on
        self.errors: list[BaseException] = []

    def hand_on(self, helpers: queue.SimpleQueue) -> None:
        """Let helpers take part."""
        self._seats = [threading.Lock() for _ in range(self._others)]
        for seat in self._seats:
            seat.acquire()
        self._taken.extend(map(helpers.put, [(self, seat) for seat in self._seats]))

    def work(self) -> None:
        """Run the loop over ranges until none is left."""
        while True:
            try:
                self._done.extend(itertools.starmap(self._loop, self._left))
                return
            except KeyboardInterrupt:
                raise
            except BaseException as error:  # it is raised where the batch came from
                self.errors.append(error)

    def finish(self) -> None:
        """Run what is left, and wait for the helpers; may be called again after an interrupt."""
        self.work()
        for seat in self._seats[: len(self._taken)]:
            with seat:  # free when its helper is done
                pass


_running: dict[int, _Batch] = {}  # by the thread that wants it done
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_running.clear)  # its parent's helpers are none of its own


def _run(batch: _Batch, helpers: queue.SimpleQueue) -> None:
    """Run a batch with helpers, and raise what it raised."""
    here = threading.get_ident()
    _running[here] = batch
    try:
        batch.hand_on(helpers)
        batch.finish()
    except BaseException:
        _finish_interrupted()
        raise
    del _running[here]
    for error in batch.errors:
        raise error


def _finish_interrupted() -> None:
    """Finish what this thread was interrupted in before something else uses the arrays."""
    batch = _running.get(threading.get_ident())
    if batch is not None:
        batch.finish()
        _running.pop(threading.get_ident(), None)


def _help(helpers: queue.SimpleQueue) -> None:
    """Take part in one batch after the other."""
    while True:
        batch, seat = helpers.get()
        batch.work()
        del batch  # lets go of the arrays
        seat.release()


@functools.cache
def _helpers(process: int, threads: int) -> queue.SimpleQueue:
    """Return where threads wait for batches; a forked child has none of its parent's.

    They are at hand in a few microseconds. An executor takes a hundred to hand on a job and to hear
    of its end, which is as long as a thousand worlds take for a step.
    """
    waiting: queue.SimpleQueue = queue.SimpleQueue()
    for _ in range(threads - 1):
        threading.Thread(target=_help, args=(waiting,), name="hav_env", daemon=True).start()
    return waiting


def run_on_threads(
    function: Callable,
    items: Iterable,
    threads: int | None = None,
    stop: Callable[[], None] | None = None,
) -> list:
    """Return ``[function(item) for item in items]``, computed on threads as they become free.

    Worth it when the function spends its time in entries, which it must call with ``threads=1``.
    Two threads that write into neighbouring elements of an array wait for each other, so each item
    should have arrays of its own.

    Args:
        function: what to compute, on any thread.
        items: its arguments.
        threads: by default ``default_threads()``.
        stop: is called in the end, also after an interrupt: it lets what still runs end early.
    """
    threads = threads or default_threads()
    if threads == 1:
        return [function(item) for item in items]
    jobs: list[concurrent.futures.Future] = []
    try:
        for item in items:
            jobs.append(_pool(os.getpid(), threads).submit(function, item))
        return [job.result() for job in jobs]
    finally:
        for job in jobs:  # after an interrupt: do not start what has not begun, ...
            job.cancel()
        if stop is not None:
            stop()
        concurrent.futures.wait(jobs)  # ... nor leave the arrays to loops that still write


@functools.cache
def _pool(process: int, threads: int) -> concurrent.futures.ThreadPoolExecutor:
    """One pool per process, so that a forked child does not wait for its parent's threads."""
    return concurrent.futures.ThreadPoolExecutor(threads, thread_name_prefix="hav_env")
