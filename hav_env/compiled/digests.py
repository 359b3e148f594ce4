"""This module digests all functions that compiled code, or a table of results, depends on.

The digest covers bytecode, constants and the values of global names, function by function, for all
functions that the code reaches. It does not depend on comments, docstrings, line numbers or
functions that the code does not reach. For a generic kernel, only the implementations for the given
models count.
"""

import functools
import hashlib
import inspect
import pathlib
import sys
import types
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numba

from hav_env.compiled.stable_text import name_of, stable_text
from hav_env.models.annotations import is_model, values_of

KERNELS: dict[Callable, str] = {}
"""Options of each kernel; the digest follows calls to kernels of every package."""

_PROJECT = "hav_env"
# threads, checks and trial runs do not change results
_ASIDE = (
    *("hav_env.compiled.", "hav_env.models."),
    *("hav_env.simulator.trial", "hav_env.simulator.names_used"),
)
_HAS_DOCSTRING = 0x4000000  # flag CO_HAS_DOCSTRING of Python 3.14
_DEEPEST = 4  # most nested modules, as in a.b.c.function
# files that define how kernels are compiled: a change here changes all compiled code
_MACHINERY = (
    "compiler.py",
    "entries.py",
    "held.py",
    "instructions.py",
    "kernels.py",
    "precision.py",
    "registers.py",
    "sharing.py",
)


class Code(NamedTuple):
    """Results of the walk through the code."""

    digest: str
    """SHA-256 of all of it, in hexadecimal."""
    models: tuple[str, ...]
    """Names of the given model classes that select implementations of generic kernels."""
    size: int
    """Number of bytes of bytecode, for the estimate of the compile time."""


def digest_code(functions: Iterable[Callable], models: Iterable[type] = ()) -> Code:
    """Digest functions, and the functions of the project that they reach.

    Args:
        functions: Kernels, entries or any Python functions.
        models: Classes of the models that the functions receive.
    """
    walk = _Walk(set(models))
    for function in functions:
        walk.enter(function)
    walk.finish()
    facts = sorted(walk.facts)
    digest = hashlib.sha256("\n".join([numba.__version__, machinery_digest(), *facts]).encode())
    return Code(digest.hexdigest(), tuple(sorted(walk.chosen)), walk.size)


def classes_in(*values: Any) -> set[type]:
    """Return the classes of models in values, including those in fields of models."""
    found: set[type] = set()
    for value in values:
        if isinstance(value, type):
            found.add(value)
        elif is_model(value):
            found |= {type(value)} | classes_in(*values_of(value).values())
    return found


@functools.cache
def machinery_digest() -> str:
    """Return a digest of the files that define how kernels are compiled."""
    here = pathlib.Path(__file__).parent
    content = b"".join((here / name).read_bytes() for name in _MACHINERY)
    return hashlib.sha256(content).hexdigest()


# parts of the world have types that select code, as models do; the models determine them
_PARTS = f"{_PROJECT}.world."


class _Walk:
    """A walk through functions that visits each of them once."""

    def __init__(self, models: set[type]) -> None:
        self.models, self.given, self.chosen = models, frozenset(models), set[str]()
        self.facts: set[str] = set()
        self.size = 0
        self._packages = {_PROJECT, *map(_package_of, models)}
        self._seen: set[int] = set()
        # keeps objects alive, so no other object can get the identity of a visited one
        self._kept: list[Any] = []
        self._open: list[types.FunctionType] = []
        self._generics: list[Any] = []

    def enter(self, function: Any) -> None:
        """Begin at a function, and follow functions of its package."""
        self._packages.add(_package_of(getattr(function, "func", function)))
        self._note(function)

    def finish(self) -> None:
        """Visit all reachable functions."""
        while True:
            while self._open:
                self._visit(self._open.pop())
            if not self._choose():
                return

    def _choose(self) -> bool:
        """Follow the implementations for the models known so far; return whether there are any."""
        before = len(self._seen)
        for generic in list(self._generics):
            table = getattr(generic, "table", None)
            if table is None:  # functools.singledispatch
                for model in sorted(self.models, key=name_of):
                    self._note(generic.dispatch(model))
                continue
            found = [model for model in sorted(self.models, key=name_of) if model in table]
            for model in found:
                if model in self.given and not model.__module__.startswith(_PARTS):
                    self.chosen.add(model.__name__)
                self.facts.add(f"{generic.__qualname__} of {name_of(model)}")
                self._note(table[model])
            for other in generic.others:
                self._note(other)
        return bool(self._open) or len(self._seen) > before

    def _note(self, value: Any) -> None:
        """Follow a value that code refers to, if it is code."""
        if id(value) in self._seen:
            return
        if isinstance(value, types.FunctionType):
            self._see(value)
            self._note_function(value)
        elif isinstance(value, type):
            self._see(value)
            self._note_class(value)
        elif isinstance(value, functools.partial):
            for part in (value.func, *value.args, *value.keywords.values()):
                self._note(part)
        elif isinstance(value, classmethod | staticmethod | property):
            self._note(value.fget if isinstance(value, property) else value.__func__)
        elif hasattr(value, "py_func"):  # a function compiled by the user's own numba.njit
            self._packages.add(_package_of(value.py_func))
            self._note(value.py_func)
        elif isinstance(value, tuple | list | set | frozenset | dict):
            self._note_inside(value)
        elif is_model(value):  # a dataclass
            self._note_inside(values_of(value))
            self._note(type(value))

    def _note_inside(self, value: Any) -> None:
        """Follow the contents of a container: functions in the entries of tables, for example."""
        self._see(value)
        if hasattr(value, "_fields"):
            self._note(type(value))
        for part in value.values() if isinstance(value, dict) else value:
            self._note(part)

    def _note_function(self, function: types.FunctionType) -> None:
        wrapped = getattr(function, "__wrapped__", None)
        if hasattr(function, "table") or hasattr(function, "registry"):
            self._generics.append(function)
        # an entry or another decorated function: the wrapped function counts
        elif wrapped is not None:
            self._packages.add(_package_of(wrapped))
            self._note(wrapped)
        elif function in KERNELS or self._is_followed(function):
            self._open.append(function)

    def _is_followed(self, function: types.FunctionType) -> bool:
        """Return whether a Python function affects the contents of a table."""
        aside = function.__module__.startswith(_ASIDE)
        return not aside and _package_of(function) in self._packages

    def _see(self, value: Any) -> None:
        self._seen.add(id(value))
        self._kept.append(value)

    def _note_class(self, kind: type) -> None:
        if hasattr(kind, "_fields") and kind not in self.models:
            self.models.add(kind)
        if _package_of(kind) in self._packages:
            for part in vars(kind).values():
                if isinstance(part, types.FunctionType | classmethod | staticmethod | property):
                    self._note(part)
            for parent in kind.__bases__:
                self._note(parent)

    def _visit(self, function: types.FunctionType) -> None:
        """Add the facts of a function, and follow the values that it refers to."""
        facts, size, values = _read(function)
        self.facts.add(facts)
        self.size += size
        for value in values:
            self._note(value)


@functools.cache
def _read(function: types.FunctionType) -> tuple[str, int, tuple[Any, ...]]:
    """Return the facts of a function, the size of its bytecode and the values it refers to."""
    facts = [function.__module__, function.__qualname__, KERNELS.get(function, "")]
    size, values = 0, []
    for code in codes_in(function.__code__):
        size += len(code.co_code)
        facts += [
            code.co_code.hex(),
            repr((code.co_argcount, code.co_kwonlyargcount, code.co_flags)),
            repr((code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars)),
            *map(stable_text, _constants_of(code)),
        ]
        for name, value in _names_in(function.__globals__, code, ""):
            if _is_state(name, value):
                facts.append(f"{name} = {name_of(type(value))}")
                continue
            facts.append(f"{name} = {stable_text(value)}")
            values.append(value)
    cells = [cell.cell_contents for cell in function.__closure__ or () if _is_filled(cell)]
    defaults = *(function.__defaults__ or ()), *(function.__kwdefaults__ or {}).values()
    for value in (*cells, *defaults):
        facts.append(stable_text(value))
        values.append(value)
    return "\t".join(facts), size, tuple(values)


def _is_state(name: str, value: Any) -> bool:
    """Return whether a global name holds mutable state: a container that is not a constant."""
    return isinstance(value, list | dict | set) and not name.rpartition(".")[2].isupper()


def _names_in(
    known: dict[str, Any], code: types.CodeType, prefix: str
) -> Iterable[tuple[str, Any]]:
    """Yield the global names in a code object, and attributes of modules, with their values."""
    for name in code.co_names:
        if name in known:
            value = known[name]
            yield prefix + name, value
            if isinstance(value, types.ModuleType) and prefix.count(".") < _DEEPEST:
                yield from _names_in(vars(value), code, f"{prefix}{name}.")


def codes_in(code: types.CodeType) -> Iterable[types.CodeType]:
    """Yield a code object and those of the functions, lambdas and comprehensions inside."""
    yield code
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield from codes_in(constant)


def _constants_of(code: types.CodeType) -> Iterable[Any]:
    """Yield the constants of a code object except its docstring and nested code objects."""
    first = 1 if _has_docstring(code) else 0
    return (value for value in code.co_consts[first:] if not isinstance(value, types.CodeType))


def _has_docstring(code: types.CodeType) -> bool:
    """Return whether the first constant is a docstring: for "def" it is that or None."""
    # there, functions without a docstring have no None in its place
    if sys.version_info >= (3, 14):
        return bool(code.co_flags & _HAS_DOCSTRING)
    made_by_def = bool(code.co_flags & inspect.CO_NEWLOCALS) and code.co_name[0] != "<"
    return made_by_def and bool(code.co_consts) and isinstance(code.co_consts[0], str)


def _is_filled(cell: Any) -> bool:
    try:
        return cell.cell_contents is not cell
    except ValueError:  # a name that is not bound yet
        return False


def _package_of(value: Any) -> str:
    """Return the outermost package of a function, class or module."""
    name = value.__name__ if isinstance(value, types.ModuleType) else value.__module__
    return str(name).partition(".")[0]
