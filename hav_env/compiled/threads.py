"""Threads for loops that are free of the GIL."""

import concurrent.futures
import functools
import os
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
    """Run a loop over worlds on threads, each of which takes a range of them; this one, too."""
    share = -(-count // (threads * VECTOR)) * VECTOR
    if count <= share:
        loop(0, count, *args)
        return
    spans = [(first, min(first + share, count)) for first in range(0, count, share)]
    _team(os.getpid(), threads).run(loop, spans, args)


class _Helper(threading.Thread):
    """A thread that waits for something to do.

    It is at hand in a few microseconds. An executor takes a hundred to hand on a job and to hear of
    its end, which is as long as a thousand worlds take for a step.
    """

    def __init__(self) -> None:
        super().__init__(name="hav_env", daemon=True)
        self._begun, self._done = threading.Lock(), threading.Lock()
        self._begun.acquire()
        self._done.acquire()
        self._job: Callable[[], None] | None = None
        self._error: BaseException | None = None
        self.start()

    def begin(self, job: Callable[[], None]) -> None:
        """Run a job; ``end`` must follow."""
        self._job = job
        self._begun.release()

    def end(self) -> BaseException | None:
        """Wait for the end of the job; return what it raised."""
        self._done.acquire()
        return self._error

    def run(self) -> None:
        """Run one job after the other."""
        while True:
            self._begun.acquire()
            assert self._job is not None
            try:
                self._job()
                self._error = None
            except BaseException as error:  # it is raised where the job came from
                self._error = error
            self._job = None  # lets go of the arrays
            self._done.release()


class _Team:
    """Helpers that work on one loop at a time, with whoever asks for it."""

    def __init__(self, size: int) -> None:
        self._helpers = [_Helper() for _ in range(size)]
        self._busy = threading.Lock()

    def run(self, loop: Callable, spans: list[tuple[int, int]], args: tuple) -> None:
        """Run a loop over all spans, the first one on this thread."""
        begun: list[_Helper] = []
        errors: list[BaseException] = []
        with self._busy:
            try:
                for helper, span in zip(self._helpers, spans[1:], strict=False):
                    begun.append(helper)
                    helper.begin(functools.partial(loop, *span, *args))
                loop(*spans[0], *args)
            finally:  # do not leave the arrays to loops that still write
                errors = [error for helper in begun if (error := helper.end()) is not None]
        for error in errors:
            raise error


def run_on_threads(function: Callable, items: Iterable, threads: int | None = None) -> list:
    """Return ``[function(item) for item in items]``, computed on threads as they become free.

    Worth it when the function spends its time in entries, which it must call with ``threads=1``.
    Two threads that write into neighbouring elements of an array wait for each other, so each item
    should have arrays of its own.
    """
    threads = threads or default_threads()
    if threads == 1:
        return [function(item) for item in items]
    jobs = [_pool(os.getpid(), threads).submit(function, item) for item in items]
    try:
        return [job.result() for job in jobs]
    finally:
        for job in jobs:  # after an interrupt: do not start what has not begun, ...
            job.cancel()
        concurrent.futures.wait(jobs)  # ... nor leave the arrays to loops that still write


@functools.cache
def _team(process: int, threads: int) -> _Team:
    """One team per process, for a forked child has no threads of its parent's."""
    return _Team(threads - 1)


@functools.cache
def _pool(process: int, threads: int) -> concurrent.futures.ThreadPoolExecutor:
    """One pool per process, so that a forked child does not wait for its parent's threads."""
    return concurrent.futures.ThreadPoolExecutor(threads, thread_name_prefix="hav_env")
