"""This module makes entries: loops that Python calls, cached on disk and spread over threads."""

import contextlib
import functools
import gc
import logging
import threading
import typing
from collections.abc import Callable, Iterator
from typing import Any

import numba
import numpy as np
from numba.core.errors import NumbaError

from hav_env.compiled.digests import KERNELS, classes_in, digest_code
from hav_env.compiled.disk_cache import DiskCache, cached
from hav_env.compiled.errors import explain
from hav_env.compiled.held import Held
from hav_env.compiled.kernels import LOOPED
from hav_env.compiled.sharing import VECTOR, spread
from hav_env.compiled.threads import NO_HELPERS, crew_of, default_threads
from hav_env.models.annotations import kinds_of, split_range

_log = logging.getLogger(__name__)
_SILENT_SECONDS = 1.0  # compilations shorter than that are not announced
_PER_SECOND = 2_700.0  # bytes of bytecode compiled per second
_ALLOCATIONS = 200_000  # between collections of garbage while Numba compiles


class _Compiled:
    """The two compiled forms of an entry's loop.

    Attributes:
        function: The loop over worlds, ``function(first, last, *args)``.
        loop: Its compiled form, a part of ``call``.
        call: ``call(crew, count, args)``, which runs the loop on the threads of a crew.
    """

    def __init__(self, function: Callable, portion: int) -> None:
        """Store the functions; they are compiled at their first use."""
        self.function, self.loop = function, numba.njit(**LOOPED)(function)
        loop = self.loop

        def call(crew, count, args):
            spread(loop, args, count, portion, crew)

        for name in ("__module__", "__name__", "__qualname__"):  # symbols of compiled code have it
            setattr(call, name, getattr(function, name))
        self.call = cached(call, function)

    def for_types_of(self, args: tuple) -> Callable:
        """Return ``call`` for the types of these arguments, compiled or loaded if necessary."""
        named_twice = _ensure_compiled(self, args)
        if not hasattr(self.call, "compile"):
            return self.call
        # Numba's dispatch knows classes by name: it would choose the code of the first such class
        return self.call.compile(_signature(args)) if named_twice else self.call


def entry(function: Callable, portion: int = VECTOR) -> Any:
    """Make ``loop(first, last, *args)`` over worlds callable as ``loop(count, *args)``.

    The loop is compiled at its first call, when models are registered. The disk cache stores it
    under the digest of the code that it reaches, because Numba does not notice edits in other
    files. ``threads`` threads (default: ``default_threads()``) share the worlds evenly, in
    multiples of a portion. The threads are Python threads, and the loop is serial and releases the
    GIL. Numba's ``prange`` loses writes to fields of tuples (numba#7135) and does not survive a
    fork.

    ``loop.prepare(*args)`` returns the compiled form ``call(crew, count, args)`` without dispatch
    on argument types, which takes longer than stepping one world; ``crew_of`` returns the crew.
    Later calls must pass the same types; for arrays, the same number of axes, order and element
    type.
    """
    KERNELS[function] = f"loop over multiples of {portion}"
    made: list[_Compiled] = []

    def compiled() -> _Compiled:
        if not made:
            with _compiling:
                if not made:
                    made.append(_Compiled(function, portion))
        return made[0]

    @functools.wraps(function)
    def call(count: int, *args: Any, threads: int | None = None) -> None:
        compiled().for_types_of(args)(crew_of(threads or default_threads()), count, args)

    def prepare(*args: Any) -> Callable[..., None]:
        call(0, *args, threads=1)
        found = compiled().call
        return found.compile(_signature(args)) if hasattr(found, "compile") else found

    call.prepare = prepare  # type: ignore[attr-defined]
    return call


def _signature(args: tuple) -> tuple:
    return numba.typeof(NO_HELPERS), numba.int64, numba.typeof(args)


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


_ready: dict[tuple, bool] = {}
_first_classes: dict[str, type] = {}  # of models, by name
_compiling = threading.Lock()


def _ensure_compiled(compiled: _Compiled, args: tuple) -> bool:
    """Compile (or load) a loop for these arguments; announce it if it takes a while.

    Returns:
        Whether a model has the name of another class: of another module, or one loaded anew.

    Raises:
        TypeError: If Numba cannot compile a model's code; the message names file and line.
    """
    plain = [part for arg in args for part in (arg.arguments if isinstance(arg, Held) else (arg,))]
    call, name = compiled.call, compiled.function.__name__
    kinds = (id(call), *map(_kind_of, plain))
    if kinds in _ready or not hasattr(call, "compile"):
        return _ready.get(kinds, False)
    signature = _signature(args)
    with _compiling:
        cache = call._cache
        stored = isinstance(cache, DiskCache) and cache.holds(signature, call.targetctx)
        if not stored:
            _announce(compiled.function, plain)
        try:
            with _rare_collection():
                if not stored:  # apart, because an error in a nested compilation tells less
                    compiled.loop.compile((numba.int64, numba.int64, *signature[-1].types))
                call.compile(signature)
        except NumbaError as error:
            raise TypeError(explain(name, error)) from None
        except Exception as error:  # Numba fails internally, as on a NamedTuple's defaults
            raise TypeError(explain(name, error)) from error
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
