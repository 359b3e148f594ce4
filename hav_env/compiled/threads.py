"""This module has the threads on which loops run that release the GIL."""

import atexit
import concurrent.futures
import functools
import os
import threading
from collections.abc import Callable, Iterable
from typing import Any

import numba
import numpy as np

from hav_env.compiled.disk_cache import cached
from hav_env.compiled.held import Held
from hav_env.compiled.sharing import dismiss, make_crew, serve

NO_HELPERS = make_crew(0)
"""The crew that has no helpers."""


def default_threads() -> int:
    """Return the number of threads of an entry: ``HAV_THREADS``, or the cores of this process.

    Raises:
        ValueError: If ``HAV_THREADS`` is not a whole number of at least 1.
    """
    wish = os.environ.get("HAV_THREADS")
    if not wish:
        return _cores()
    if not wish.isdigit() or int(wish) < 1:
        raise ValueError(f"HAV_THREADS is {wish!r}, but must be a whole number of at least 1")
    return int(wish)


def _cores() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def crew_of(threads: int) -> Held:
    """Return the crew with which an entry runs on a number of threads, one of them its caller's.

    There are no more threads than cores: a thread that tries for work would keep others from it.
    The threads of a process that call entries at the same time share a crew: one of them works with
    it, and the others alone.
    """
    if threads == 1:
        return NO_HELPERS
    process = os.getpid()
    return _crews.get((process, threads)) or _find_crew(process, threads)


_crews: dict[tuple[int, int], Held] = {}
"""Crews by process and number of threads: a forked child has none of its parent's threads."""


def _find_crew(process: int, threads: int) -> Held:
    """Return the crew of a process, also for more threads than it has cores."""
    # in plain Python, other threads would only wait
    size = min(threads, _cores()) if hasattr(_work(), "compile") else 1
    if (process, size) not in _crews:
        _gather(process, size)
    return _crews.setdefault((process, threads), _crews[process, size])


def _gather(process: int, size: int) -> None:
    """Start the helpers of a crew, and keep it, unless another caller has been faster."""
    made, caller = make_crew(size - 1), threading.get_native_id()
    helpers = [
        threading.Thread(target=_help, args=(mailbox, caller), name="hav_env", daemon=True)
        for mailbox in made.arguments[-1]
    ]
    try:
        for helper in helpers:
            helper.start()
        _crews.setdefault((process, size), made)
    finally:  # an interrupt may have come, or the system may have no more threads
        if _crews.get((process, size)) is not made:
            dismiss(made)
    atexit.register(_end, process, made, helpers)


def _help(mailbox: np.ndarray, caller: int) -> None:
    """Work on a thread of one's own: those of gevent share their caller's, which would hang."""
    if threading.get_native_id() != caller:
        _work()(mailbox)


@functools.cache
def _work() -> Any:
    """Return the work of helpers, compiled.

    Numba compiles under a lock. A child that was forked while another thread held the lock would
    hang there, so it must not compile what its parent has compiled.
    """
    work = cached(serve, serve)
    if hasattr(work, "compile"):
        work.compile((numba.int64[::1],))
    return work


def _end(process: int, crew: Held, helpers: list[threading.Thread]) -> None:
    """End helpers before Python removes the compiled code that they run."""
    if process == os.getpid() and dismiss(crew):
        for helper in helpers:
            helper.join()


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
