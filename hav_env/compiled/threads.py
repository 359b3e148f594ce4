"""This module runs loops that release the GIL on a pool of threads."""

import collections
import concurrent.futures
import functools
import itertools
import os
import queue
import threading
from collections.abc import Callable, Iterable

VECTOR = 16  # lanes of one block of whole vectors; threads share worlds in such portions


def default_threads() -> int:
    """Return the number of threads of an entry: ``HAV_THREADS``, or the cores of this process.

    Raises:
        ValueError: If ``HAV_THREADS`` is not a whole number of at least 1.
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
    """Run a loop over worlds on threads, including this one; each takes ranges of worlds.

    An interrupt (Ctrl-C) is raised after the loop has ended in all threads. No world is left
    behind, and no thread writes into the arrays any more.
    """
    _finish_interrupted()
    share = -(-count // (threads * VECTOR)) * VECTOR
    if count <= share:
        loop(0, count, *args)
        return
    spans = [(first, min(first + share, count), *args) for first in range(0, count, share)]
    _run(_Batch(loop, spans), _helpers(os.getpid(), threads))


class _Batch:
    """A loop and the ranges of worlds over which it runs, each of them once.

    An interrupt may come between any two Python instructions of the main thread, but not within a C
    call. Operations that must not be split are therefore single C calls: taking, running and
    recording a range; passing the batch to helpers and recording their number.
    """

    def __init__(self, loop: Callable, spans: list[tuple]) -> None:
        self._loop, self._left = loop, iter(spans)
        self._others = len(spans) - 1
        self._done: collections.deque[None] = collections.deque()
        self._seats: list[threading.Lock] = []
        self._taken: list[None] = []  # as long as the number of seats passed to helpers
        self.errors: list[BaseException] = []

    def hand_on(self, helpers: queue.SimpleQueue) -> None:
        """Pass the batch to helpers."""
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
            except BaseException as error:  # the thread that passed the batch raises it
                self.errors.append(error)

    def finish(self) -> None:
        """Run the remaining ranges and wait for the helpers; callable again after an interrupt."""
        self.work()
        for seat in self._seats[: len(self._taken)]:
            with seat:  # released when its helper has finished
                pass


_running: dict[int, _Batch] = {}  # by the thread that runs the batch
if hasattr(os, "register_at_fork"):
    # a child process has no helpers of its parent
    os.register_at_fork(after_in_child=_running.clear)


def _run(batch: _Batch, helpers: queue.SimpleQueue) -> None:
    """Run a batch with helpers, and raise its error, if any."""
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
    """Finish the interrupted batch of this thread before other code uses the arrays."""
    batch = _running.get(threading.get_ident())
    if batch is not None:
        batch.finish()
        _running.pop(threading.get_ident(), None)


def _help(helpers: queue.SimpleQueue) -> None:
    """Take part in one batch after another."""
    while True:
        batch, seat = helpers.get()
        batch.work()
        del batch  # releases the arrays
        seat.release()


@functools.cache
def _helpers(process: int, threads: int) -> queue.SimpleQueue:
    """Return the queue on which threads wait for batches; a forked child has its own.

    They respond within a few microseconds. An executor takes a hundred to submit a job and to
    report its end, which is as long as a step of a thousand worlds.
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

    It pays if the function spends its time in entries, which it must call with ``threads=1``. Two
    threads that write to neighbouring elements of an array slow each other down, so each item
    should have its own arrays.

    Args:
        function: Function to compute, on any thread.
        items: Arguments of the function, one per call.
        threads: Number of threads, by default ``default_threads()``.
        stop: Function called at the end, also after an interrupt: it ends running work early.
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
        for job in jobs:  # after an interrupt: do not start waiting jobs, ...
            job.cancel()
        if stop is not None:
            stop()
        concurrent.futures.wait(jobs)  # ... and do not leave the arrays to loops that still write


@functools.cache
def _pool(process: int, threads: int) -> concurrent.futures.ThreadPoolExecutor:
    """Return the pool of a process, so a forked child does not wait for its parent's threads."""
    return concurrent.futures.ThreadPoolExecutor(threads, thread_name_prefix="hav_env")
