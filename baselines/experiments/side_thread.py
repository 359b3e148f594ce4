"""This module runs work on one thread in the background, and stops it after an interrupt."""

import concurrent.futures
import contextlib
import itertools
import threading
from collections.abc import Callable, Iterable, Iterator
from typing import Any

Submit = Callable[[Iterable[Any]], "concurrent.futures.Future[list[Any]]"]


@contextlib.contextmanager
def side_thread(name: str) -> Iterator[Submit]:
    """Yield a function that lets a thread run through iterables, one after another.

    The function returns a future of the list of the iterable's elements, or of its error. At the
    end of the context, all work is complete. After an error or an interrupt in the context, the
    thread completes the present element and takes no other.

    Args:
        name: Beginning of the thread's name.
    """
    stop = threading.Event()

    def run_through(steps: Iterable[Any]) -> list[Any]:
        return list(itertools.takewhile(lambda _: not stop.is_set(), steps))

    with concurrent.futures.ThreadPoolExecutor(1, name) as pool:
        try:
            yield lambda steps: pool.submit(run_through, steps)
        except BaseException:
            stop.set()
            pool.shutdown(wait=False, cancel_futures=True)
            raise
