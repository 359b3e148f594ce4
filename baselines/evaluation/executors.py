"""This module runs episodes on this machine or on a Ray cluster.

The tables do not depend on where the episodes ran. An example of a cluster:

python -m baselines evaluate avoid_jack --episodes 100000 --engine ray --address auto
"""

import contextlib
import functools
import itertools
from collections.abc import Callable, Generator, Iterable, Iterator
from typing import Any

import pyarrow as pa

from baselines.evaluation.ray_cluster import connect
from hav_env.compiled import classes_in, digest_code

Done = Generator[tuple[range, pa.Table], None, None]
Part = Callable[[range, int | None], pa.Table]
"""Runs a span of episodes on a number of threads."""
Engine = Callable[[Part, Iterable[range], int | None], Done]
"""Yields the tables of spans, in any order, as they are completed."""

ENGINES = ("local", "ray")
_TASKS_AHEAD = 64  # smallest number of tasks submitted to a cluster before others are completed


@contextlib.contextmanager
def open_engine(name: str = "local", address: str | None = None) -> Iterator[Engine]:
    """Yield the engine of a name.

    Args:
        name: One of ``ENGINES``.
        address: Address of the Ray cluster; None starts one on this machine.

    Raises:
        ValueError: If there is no such engine, or it has no address.
        ImportError: If Ray is not installed.
        ConnectionError: If the address does not respond.
    """
    if name not in ENGINES:
        raise ValueError(f"unknown engine {name!r}; known: {', '.join(ENGINES)}")
    if name == "local":
        if address is not None:
            raise ValueError(f"address is {address!r}, but the engine local has none: use ray")
        yield run_here
        return
    with connect(address) as ray:
        yield functools.partial(run_on_cluster, ray)


def run_here(part: Part, spans: Iterable[range], threads: int | None) -> Done:
    """Run spans one after another."""
    for span in spans:
        yield span, part(span, threads)


def run_on_cluster(ray: Any, part: Part, spans: Iterable[range], threads: int | None) -> Done:
    """Run spans as tasks of a cluster, each with one core per thread, by default one.

    Raises:
        ValueError: If a machine of the cluster has other code; also any error that a task raises.
        OSError: If the cluster cannot run a task.
    """
    threads = threads or 1
    cores = [int(node["Resources"].get("CPU", 0)) for node in ray.nodes() if node["Alive"]]
    # a task that requests more cores than any machine has would never start
    task = ray.remote(num_cpus=min(threads, max(cores, default=0) or threads))(_run_there)
    shared = ray.put((part, _digest(part)))  # Ray sends it to each machine once
    left = iter(spans)
    waiting: dict[Any, range] = {}
    try:
        while True:
            for span in itertools.islice(left, max(_TASKS_AHEAD, 4 * sum(cores)) - len(waiting)):
                waiting[task.remote(shared, span, threads)] = span
            if not waiting:
                return
            (done,), _ = ray.wait(list(waiting))
            span = waiting.pop(done)
            yield span, _table_of(ray, done)
    finally:
        for unwanted in waiting:
            ray.cancel(unwanted)


def _table_of(ray: Any, done: Any) -> pa.Table:
    try:
        return ray.get(done)
    except ray.exceptions.RayError as error:
        cause = getattr(error, "cause", error)  # the error of the task
        if not isinstance(cause, ray.exceptions.RayError):
            raise cause from None
        message = str(cause).partition("\n")[0]  # without the traceback
        raise OSError(f"the Ray cluster cannot run episodes: {message}") from None


def _run_there(shared: tuple[Part, str], span: range, threads: int) -> pa.Table:
    part, digest = shared
    if _digest(part) != digest:
        raise ValueError(
            "a machine of the cluster has another version of this project or of Numba: install"
            " the one that is here"
        )
    return part(span, threads)


def _digest(part: Part) -> str:
    """Return the digest of the code that runs a part, and of its models."""
    arguments = part.args if isinstance(part, functools.partial) else ()
    models = set().union(*(classes_in(*value) for value in arguments if isinstance(value, tuple)))
    return digest_code([part], models).digest
