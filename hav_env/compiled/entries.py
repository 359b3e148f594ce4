"""This module makes entries: loops that Python calls, cached on disk and spread over threads."""

import contextlib
import functools
import gc
import logging
import os
import threading
import typing
from collections.abc import Callable, Iterator
from typing import Any

import numba
import numpy as np
from numba.core.errors import NumbaError

from hav_env.compiled.cache_folder import find_home
from hav_env.compiled.digests import classes_in, digest_code
from hav_env.compiled.disk_cache import DiskCache
from hav_env.compiled.errors import explain
from hav_env.compiled.held import Held
from hav_env.compiled.kernels import ENTERED
from hav_env.compiled.threads import default_threads, share_out
from hav_env.models.annotations import kinds_of, split_range

_log = logging.getLogger(__name__)
_SILENT_SECONDS = 1.0  # compilations shorter than that are not announced
_PER_SECOND = 2_700.0  # bytes of bytecode compiled per second
_ALLOCATIONS = 200_000  # between collections of garbage while Numba compiles


def entry(function: Callable) -> Any:
    """Make ``loop(first, last, *args)`` over worlds callable as ``loop(count, *args)``.

    The loop is compiled at its first call, when models are registered. The disk cache stores it
    under the digest of the code that it reaches, because Numba does not notice edits in other
    files. ``threads`` threads (default: ``default_threads()``) share the worlds evenly. The threads
    are Python threads, and the loop is serial and releases the GIL. Numba's ``prange`` loses writes
    to fields of tuples (numba#7135) and does not survive a fork.

    ``loop.prepare(*args)`` returns the compiled loop over ``(first, last, *args)`` without dispatch
    on argument types, which takes longer than stepping one world. Later calls must pass the same
    types; for arrays, the same number of axes, order and element type.
    """
    compiled: list[Callable] = []

    def loop_of() -> Any:
        if not compiled:
            with _compiling:
                if not compiled:
                    compiled.append(_cached(function))
        return compiled[0]

    @functools.wraps(function)
    def call(count: int, *args: Any, threads: int | None = None) -> None:
        loop = loop_of()
        shared_name = _ensure_compiled(loop, args)
        # Numba's dispatch knows classes by name: it would choose the code of the first such class
        chosen = loop.compile(_signature(args)) if shared_name else loop
        share_out(chosen, count, args, threads or default_threads())

    def prepare(*args: Any) -> Callable[..., None]:
        call(0, *args, threads=1)
        loop = loop_of()
        return loop.compile(_signature(args)) if hasattr(loop, "compile") else loop

    call.prepare = prepare  # type: ignore[attr-defined]
    return call


def _signature(args: tuple) -> tuple:
    return numba.int64, numba.int64, *map(numba.typeof, args)


def canonical(model: Any) -> Any:
    """Return a model in the form that compiled code takes.

    Its numbers become Python numbers, because NumPy's numbers, and an int for a float, are other
    types that Numba compiles anew. Words of a ``Literal`` become their index in it.
    """
    model_class: Any = type(model)
    return model._make(
        convert(value) for convert, value in zip(_converters(model_class), model, strict=True)
    )


@functools.cache
def _converters(model_class: Any) -> tuple[Callable[[Any], Any], ...]:
    """Return the functions that convert each field of a model for compiled code."""
    kinds = kinds_of(model_class)
    return tuple(_converter(kinds.get(field)) for field in model_class._fields)


def _converter(kind: Any) -> Callable[[Any], Any]:
    base, _ = split_range(kind)
    if base in (int, float, bool):
        return base
    if typing.get_origin(base) is typing.Literal:
        words = typing.get_args(base)
        return lambda value: words.index(value) if isinstance(value, str) else value
    return lambda value: canonical(value) if hasattr(value, "_asdict") else value


def _cached(function: Callable) -> Callable:
    """Return the function in its compiled, or lazily compiled, form, cached on disk if possible."""
    loop = numba.njit(**ENTERED)(function)
    home = find_home(os.environ.get("NUMBA_CACHE_DIR", ""))
    if home is not None and hasattr(loop, "compile"):
        loop._cache = DiskCache(function, home)
    return loop


_ready: dict[tuple, bool] = {}
_first_classes: dict[str, type] = {}  # of models, by name
_compiling = threading.Lock()


def _ensure_compiled(loop: Any, args: tuple) -> bool:
    """Compile (or load) the loop for these arguments; announce it if it takes a while.

    Returns:
        Whether a model has the name of another class: of another module, or one loaded anew.

    Raises:
        TypeError: If Numba cannot compile a model's code; the message names file and line.
    """
    plain = [part for arg in args for part in (arg.arguments if isinstance(arg, Held) else (arg,))]
    kinds = (id(loop), *map(_kind_of, plain))
    if kinds in _ready or not hasattr(loop, "compile"):
        return _ready.get(kinds, False)
    signature = _signature(args)
    with _compiling:
        cache = loop._cache
        if not (isinstance(cache, DiskCache) and cache.holds(signature, loop.targetctx)):
            _announce(loop.py_func, plain)
        try:
            with _rare_collection():
                loop.compile(signature)
        except NumbaError as error:
            raise TypeError(explain(loop.py_func.__name__, error)) from None
        except Exception as error:  # Numba fails internally, as on a NamedTuple's defaults
            raise TypeError(explain(loop.py_func.__name__, error)) from error
        known = [_first_classes.setdefault(one.__name__, one) is one for one in _classes_of(kinds)]
        _ready[kinds] = not all(known)
    return _ready[kinds]


@contextlib.contextmanager
def _rare_collection() -> Iterator[None]:
    """Collect cyclic garbage rarely, because Numba keeps most of its objects until it has compiled.

    Python's usual collections would visit them again and again, for a seventh of the time.
    """
    usual = gc.get_threshold()
    if usual[0]:  # zero turns collections off
        gc.set_threshold(max(usual[0], _ALLOCATIONS), *usual[1:])
    try:
        yield
    finally:
        gc.set_threshold(*usual)


def _kind_of(value: Any) -> Any:
    """Return the type of an argument, with its precision if it is an array.

    Of a tuple, return the types of the tuples in it and of its first part: all arrays of a state
    have the same precision.
    """
    if not isinstance(value, tuple):
        return value.dtype.char if isinstance(value, np.ndarray) else type(value)
    parts = (_kind_of(part) for part in value[1:] if isinstance(part, tuple))
    return type(value), *map(_kind_of, value[:1]), *parts


def _classes_of(kinds: tuple) -> Iterator[type]:
    """Yield the classes of tuples with names among the types of arguments."""
    for kind in kinds:
        if isinstance(kind, tuple):
            yield from _classes_of(kind)
        elif hasattr(kind, "_fields"):
            yield kind


def _announce(function: Callable, args: list) -> None:
    """Log the function, the models and the approximate time of a compilation."""
    code = digest_code([function], classes_in(*args))
    seconds = code.size / _PER_SECOND
    if seconds < _SILENT_SECONDS:
        return
    models = f" for {', '.join(code.models)}" if code.models else ""
    message = "hav_env compiles %s%s: about %.0f s, once for this code on this machine ..."
    _log.warning(message, function.__name__, models, seconds)
