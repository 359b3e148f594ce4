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
    """Give a function that lets a thread run through iterables, one after the other.

    The function returns a future: the list of what the iterable gave, or the error that it raised.
    At the end of the context, all is done. After an error or an interrupt in the context, the
    thread ends what is under way and takes no further element.

    Args:
        name: Begins the name of the thread.
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
