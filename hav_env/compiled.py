"""How the project compiles: the only module that imports Numba.

Three tiers. A ``kernel`` is compiled into its callers: scalar (floats in, floats out) or a loop
over the lanes of a block of worlds. A ``generic`` picks a kernel by the type of a model. An
``entry`` is what Python calls: it alone is cached on disk, its worlds are spread over threads.
"""

import concurrent.futures
import ctypes
import functools
import hashlib
import logging
import math
import os
import pathlib
import struct
import tempfile
import threading
import weakref
from collections.abc import Callable, Iterable
from typing import Any

import numba
from llvmlite import ir
from numba.core import cgutils
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import AnalysisPass, register_pass
from numba.core.untyped_passes import IRProcessing
from numba.extending import lower_builtin, overload, type_callable

_log = logging.getLogger(__name__)
_sources: set[pathlib.Path] = set()  # packages and files whose code ends up in compiled loops
VECTOR = 16  # lanes to work on whole vectors: worlds are shared out in such portions
_SILENT_SECONDS = 1.0  # loading from the cache takes less, compiling takes more
# Kernels allocate nothing, so Numba's reference counting of arrays is switched off: it would take
# most of the time. A kernel must therefore not return an array to Python.
_OPTIONS = {"error_model": "numpy", "nogil": True, "_nrt": False}


class _Code(JITCodeLibrary):
    """Code for the widest vectors: LLVM would halve those of 512 bits."""

    def add_ir_module(self, ir_module):
        for function in ir_module.functions:
            set.add(function.attributes, '"prefer-vector-width"="512"')
        super().add_ir_module(ir_module)


class _Part(_Code):
    """The code of one kernel: linked into entries, and optimised and made executable there only.

    Numba would do both for every kernel, with all that it calls: five times the work.
    """

    def _optimize_final_module(self):
        pass

    def _finalize_final_module(self):
        self._finalize_dynamic_globals()
        self._final_module.__library = weakref.proxy(self)
        self._finalized = True

    def get_pointer_to_function(self, name):
        return 0

    @property
    def codegen(self):
        return self  # Numba asks it for ``set_env`` alone

    def set_env(self, name, environment):
        pass


def _compiler(library_class: type) -> type:
    """Return Numba's compiler, but for where the code goes."""

    @register_pass(mutates_CFG=False, analysis_only=True)
    class ChooseLibrary(AnalysisPass):
        _name = f"choose_{library_class.__name__}"

        def __init__(self):
            super().__init__()

        def run_pass(self, state):
            state.library = library_class(state.targetctx.codegen(), state.func_id.func_qualname)
            state.library.enable_object_caching()
            return False

    class Compiler(CompilerBase):
        def define_pipelines(self):
            passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
            passes.add_pass_after(ChooseLibrary, IRProcessing)
            passes.finalize()
            return [passes]

    return Compiler


_CALLED = _OPTIONS | {
    "pipeline_class": _compiler(_Part),
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
}
_ENTERED = _OPTIONS | {"pipeline_class": _compiler(_Code), "cache": True}
_INLINED = _CALLED | {"forceinline": True}


def kernel(function: Callable) -> Callable:
    """Let a function be compiled into the kernels and entries that call it.

    It stays what it is when Python calls it. Loops over lanes run several worlds at once only if
    all that they call is inlined and free of branches. The inlining is LLVM's: Numba's own
    (``inline="always"``) compiles ten times as long and miscompiles returns out of loops.
    """
    _note_sources(function)
    overload(function, strict=False, jit_options=_INLINED)(lambda *args: function)
    return function


def rare_kernel(function: Callable) -> Callable:
    """Let a function be compiled, but called: what seldom happens need not be repeated."""
    _note_sources(function)
    overload(function, strict=False, jit_options=_CALLED)(lambda *args: function)
    return function


def generic(stub: Callable) -> Any:
    """``functools.singledispatch`` for kernels: the type of the first argument picks the code.

    Register a kernel with ``@stub.register(ModelClass)``; ``stub.table`` maps classes to kernels.
    ``@stub.otherwise`` is for all other classes. The choice is made when a caller is compiled, so
    it costs nothing when it runs.
    """
    table: dict[type, Callable] = {}
    others: list[Callable] = []

    def find(model_class: Any) -> Any:
        return table.get(model_class) or (others[-1] if others else None)

    def dispatch(model, *args):
        return find(type(model))(model, *args)

    def choose(model, *args):
        return find(getattr(model, "instance_class", object))

    def register(model_class: type) -> Callable:
        def decorate(function: Callable) -> Callable:
            _note_sources(function)
            table[model_class] = function
            return function

        return decorate

    def otherwise(function: Callable) -> Callable:
        _note_sources(function)
        others.append(function)
        return function

    functools.update_wrapper(dispatch, stub)
    del dispatch.__wrapped__  # type: ignore[attr-defined]  # Numba would read the stub's signature
    dispatch.register, dispatch.table = register, table  # type: ignore[attr-defined]
    dispatch.otherwise = otherwise  # type: ignore[attr-defined]
    overload(dispatch, strict=False, jit_options=_INLINED)(choose)
    return dispatch


def _find_fma() -> Callable:
    if hasattr(math, "fma"):  # from Python 3.13 on
        return math.fma
    function = ctypes.CDLL("ucrtbase" if os.name == "nt" else None).fma
    function.restype, function.argtypes = ctypes.c_double, [ctypes.c_double] * 3
    return function


_fma = _find_fma()


def fma(x, y, z):
    """Return x * y + z, rounded once: one instruction, the same on all machines."""
    return _fma(x, y, z)


def bits_of(value):
    """Return the 64 bits of a float as a signed whole number."""
    return struct.unpack("<q", struct.pack("<d", value))[0]


def float_of(bits):
    """Return the float that has these 64 bits."""
    return struct.unpack("<d", struct.pack("<Q", bits & 0xFFFFFFFFFFFFFFFF))[0]


def lanes_from(array, first):
    """Return ``array[..., first:]``, whose last axis compiled code knows to be contiguous.

    Compiled, only the address moves on: the shape stays, and the lanes that it has too many must
    not be touched.
    """
    return array[..., first:]


def fixed(row):
    """Return the row of an array that the lane loops inside are to work on.

    Compiled, they take it as given. Otherwise LLVM tests once for all rounds of the loop outside
    whether what is written overlaps what is read; the rows of one array together do, and it would
    work on one lane at a time.
    """
    return row


type_callable(fma)(lambda context: lambda x, y, z: numba.float64)
type_callable(bits_of)(lambda context: lambda value: numba.int64)
type_callable(float_of)(lambda context: lambda bits: numba.float64)
type_callable(lanes_from)(lambda context: lambda array, first: array)
type_callable(fixed)(lambda context: lambda row: numba.int64)


@lower_builtin(fma, numba.types.Float, numba.types.Float, numba.types.Float)
def _lower_fma(context, builder, signature, arguments):
    return builder.fma(*arguments)


@lower_builtin(bits_of, numba.types.Float)
def _lower_bits_of(context, builder, signature, arguments):
    return builder.bitcast(arguments[0], ir.IntType(64))


@lower_builtin(float_of, numba.types.Integer)
def _lower_float_of(context, builder, signature, arguments):
    return builder.bitcast(arguments[0], ir.DoubleType())


@lower_builtin(lanes_from, numba.types.Array, numba.types.Integer)
def _lower_lanes_from(context, builder, signature, arguments):
    view = cgutils.create_struct_proxy(signature.args[0])(context, builder, arguments[0])
    view.data = builder.gep(view.data, [arguments[1]])
    return view._getvalue()


@lower_builtin(fixed, numba.types.Integer)
def _lower_fixed(context, builder, signature, arguments):
    word = ir.IntType(64)
    return builder.asm(ir.FunctionType(word, [word]), "", "=r,0", arguments, side_effect=False)


def entry(function: Callable) -> Callable:
    """Make ``loop(first, last, *args)`` over worlds callable as ``loop(count, *args)``.

    The loop is compiled at its first call, once models are registered, and kept on disk under the
    digest of all sources, for Numba itself does not see edits in other files. The worlds are shared
    out evenly among ``threads`` (default: ``default_threads()``). The threads are Python's and the
    loop is serial and free of the GIL: Numba's ``prange`` loses writes to fields of tuples
    (numba#7135) and does not survive a fork.
    """
    _note_sources(function)
    compiled: dict[frozenset, Callable] = {}

    @functools.wraps(function)
    def call(count: int, *args: Any, threads: int | None = None) -> None:
        sources = frozenset(_sources)
        if sources not in compiled:
            compiled[sources] = _cached(function, sources)
        loop = compiled[sources]
        _ensure_compiled(loop, function.__name__, args)
        threads = threads or default_threads()
        share = -(-count // (threads * VECTOR)) * VECTOR
        if count <= share:
            loop(0, count, *args)
            return
        spans = [(first, min(first + share, count)) for first in range(0, count, share)]
        run_on_threads(lambda span: loop(*span, *args), spans, threads)

    return call


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


def canonical(model: Any) -> Any:
    """Return a model whose ``float`` fields are floats: an int is another type, compiled anew."""
    kinds = type(model).__annotations__
    whole = {f: float(v) for f, v in model._asdict().items() if kinds[f] is float}
    return model._replace(**whole)


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


def _note_sources(function: Callable) -> None:
    _sources.add(source_of(function))


def source_of(function: Any) -> pathlib.Path:
    """Return the outermost package that a function or kernel belongs to, or its file if in none."""
    path = pathlib.Path(function.__code__.co_filename)
    while (path.parent / "__init__.py").exists():
        path = path.parent
    return path


def source_digest(sources: Iterable[pathlib.Path]) -> str:
    """Return a digest of the code in packages and files, and of Numba's version."""
    digest = hashlib.sha256(numba.__version__.encode())
    for source in sorted(set(sources)):
        for path in sorted(source.rglob("*.py")) if source.is_dir() else [source]:
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def _cached(function: Callable, sources: frozenset) -> Callable:
    previous = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(_writable_home() / source_digest(sources))
    try:
        return numba.njit(**_ENTERED)(function)
    finally:
        numba.config.CACHE_DIR = previous


def _writable_home() -> pathlib.Path:
    home = pathlib.Path(os.environ.get("NUMBA_CACHE_DIR") or "~/.cache/hav_env").expanduser()
    try:
        home.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=home):
            return home
    except OSError:
        return pathlib.Path(tempfile.gettempdir()) / f"hav_env-{os.getuid()}"


_ready: set[tuple] = set()
_compiling = threading.Lock()


def _ensure_compiled(loop: Any, name: str, args: tuple) -> None:
    """Compile (or load) the loop for these arguments first, and say so when it takes a while."""
    kinds = (id(loop), *map(type, args))
    if kinds in _ready or not hasattr(loop, "compile"):
        return
    message = f"hav_env compiles {name} (once for this version on this machine) ..."
    with _compiling:
        notice = threading.Timer(_SILENT_SECONDS, _log.warning, (message,))
        notice.daemon = True
        notice.start()
        try:
            loop.compile((numba.int64, numba.int64, *map(numba.typeof, args)))
        finally:
            notice.cancel()
        _ready.add(kinds)


@functools.cache
def _pool(process: int, threads: int) -> concurrent.futures.ThreadPoolExecutor:
    """One pool per process, so that a forked child does not wait for its parent's threads."""
    return concurrent.futures.ThreadPoolExecutor(threads, thread_name_prefix="hav_env")
