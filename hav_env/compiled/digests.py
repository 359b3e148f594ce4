"""This module digests all functions that compiled code, or a table of results, depends on.

The digest covers bytecode, constants and the values of global names, function by function, wherever
the code leads. It does not depend on comments, docstrings, line numbers or functions that the code
does not reach. Of a generic kernel only the implementations for the models at hand count.
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
"""Options of each kernel; code that calls one is followed into it, wherever it is from."""

_PROJECT = "hav_env"
# threads, checks and trials change no result
_ASIDE = (
    *("hav_env.compiled.", "hav_env.models."),
    *("hav_env.simulator.trial", "hav_env.simulator.names_used"),
)
_HAS_DOCSTRING = 0x4000000  # flag CO_HAS_DOCSTRING of Python 3.14
_DEEPEST = 4  # modules in modules, as in a.b.c.function
# how kernels are compiled: a change here changes all compiled code
_MACHINERY = ("compiler.py", "held.py", "instructions.py", "kernels.py", "precision.py")


class Code(NamedTuple):
    """The findings on the way through the code."""

    digest: str
    """SHA-256 of all of it, in hexadecimal."""
    models: tuple[str, ...]
    """Names of the given classes of models that choose implementations of generic kernels."""
    size: int
    """Number of bytes of bytecode, by which the time to compile it is estimated."""


def digest_code(functions: Iterable[Callable], models: Iterable[type] = ()) -> Code:
    """Digest functions, and the functions of the project that they lead to.

    Args:
        functions: kernels, entries or any functions of Python.
        models: classes of the models that the functions are given.
    """
    walk = _Walk(set(models))
    for function in functions:
        walk.enter(function)
    walk.finish()
    facts = sorted(walk.facts)
    digest = hashlib.sha256("\n".join([numba.__version__, machinery_digest(), *facts]).encode())
    return Code(digest.hexdigest(), tuple(sorted(walk.chosen)), walk.size)


def classes_in(*values: Any) -> set[type]:
    """Return the classes of models in values, those in fields of models among them."""
    found: set[type] = set()
    for value in values:
        if isinstance(value, type):
            found.add(value)
        elif is_model(value):
            found |= {type(value)} | classes_in(*values_of(value).values())
    return found


@functools.cache
def machinery_digest() -> str:
    """Return a digest of the files that say how kernels are compiled."""
    here = pathlib.Path(__file__).parent
    content = b"".join((here / name).read_bytes() for name in _MACHINERY)
    return hashlib.sha256(content).hexdigest()


# parts of the world have types that select code, as models do; they follow from the models
_PARTS = f"{_PROJECT}.world."


class _Walk:
    """A way through functions; every one of them is visited once."""

    def __init__(self, models: set[type]) -> None:
        self.models, self.given, self.chosen = models, frozenset(models), set[str]()
        self.facts: set[str] = set()
        self.size = 0
        self._packages = {_PROJECT, *map(_package_of, models)}
        self._seen: set[int] = set()
        self._kept: list[Any] = []  # so that no other object gets an identity that was seen
        self._open: list[types.FunctionType] = []
        self._generics: list[Any] = []

    def enter(self, function: Any) -> None:
        """Begin at a function, whose package is followed."""
        self._packages.add(_package_of(getattr(function, "func", function)))
        self._note(function)

    def finish(self) -> None:
        """Visit all that can be reached."""
        while True:
            while self._open:
                self._visit(self._open.pop())
            if not self._choose():
                return

    def _choose(self) -> bool:
        """Follow the implementations for the models known by now; tell whether there are any."""
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
        elif hasattr(value, "py_func"):  # somebody's own numba.njit
            self._packages.add(_package_of(value.py_func))
            self._note(value.py_func)
        elif isinstance(value, tuple | list | set | frozenset | dict):
            self._note_inside(value)
        elif is_model(value):  # a dataclass
            self._note_inside(values_of(value))
            self._note(type(value))

    def _note_inside(self, value: Any) -> None:
        """Follow what a container holds: functions in the entries of tables, for example."""
        self._see(value)
        if hasattr(value, "_fields"):
            self._note(type(value))
        for part in value.values() if isinstance(value, dict) else value:
            self._note(part)

    def _note_function(self, function: types.FunctionType) -> None:
        wrapped = getattr(function, "__wrapped__", None)
        if hasattr(function, "table") or hasattr(function, "registry"):
            self._generics.append(function)
        elif wrapped is not None:  # an entry, or what a decorator made: what it wraps counts
            self._packages.add(_package_of(wrapped))
            self._note(wrapped)
        elif function in KERNELS or self._is_followed(function):
            self._open.append(function)

    def _is_followed(self, function: types.FunctionType) -> bool:
        """Tell whether a function of Python matters to what a table holds."""
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
        """Add the facts of a function, and follow what it refers to."""
        facts, size, values = _read(function)
        self.facts.add(facts)
        self.size += size
        for value in values:
            self._note(value)


@functools.cache
def _read(function: types.FunctionType) -> tuple[str, int, tuple[Any, ...]]:
    """Return the facts of a function, the size of its bytecode and the values it refers to."""
    told = [function.__module__, function.__qualname__, KERNELS.get(function, "")]
    size, values = 0, []
    for code in codes_in(function.__code__):
        size += len(code.co_code)
        told += [
            code.co_code.hex(),
            repr((code.co_argcount, code.co_kwonlyargcount, code.co_flags)),
            repr((code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars)),
            *map(stable_text, _constants_of(code)),
        ]
        for name, value in _names_in(function.__globals__, code, ""):
            if _is_state(name, value):
                told.append(f"{name} = {name_of(type(value))}")
                continue
            told.append(f"{name} = {stable_text(value)}")
            values.append(value)
    cells = [cell.cell_contents for cell in function.__closure__ or () if _is_filled(cell)]
    defaults = *(function.__defaults__ or ()), *(function.__kwdefaults__ or {}).values()
    for value in (*cells, *defaults):
        told.append(stable_text(value))
        values.append(value)
    return "\t".join(told), size, tuple(values)


def _is_state(name: str, value: Any) -> bool:
    """Tell whether a global name holds what a process remembers: no constant, but a container."""
    return isinstance(value, list | dict | set) and not name.rpartition(".")[2].isupper()


def _names_in(
    known: dict[str, Any], code: types.CodeType, prefix: str
) -> Iterable[tuple[str, Any]]:
    """Give the global names of a code, and attributes of modules, with their values."""
    for name in code.co_names:
        if name in known:
            value = known[name]
            yield prefix + name, value
            if isinstance(value, types.ModuleType) and prefix.count(".") < _DEEPEST:
                yield from _names_in(vars(value), code, f"{prefix}{name}.")


def codes_in(code: types.CodeType) -> Iterable[types.CodeType]:
    """Give a code and those of the functions, lambdas and comprehensions inside."""
    yield code
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield from codes_in(constant)


def _constants_of(code: types.CodeType) -> Iterable[Any]:
    """Give the constants of a code but its docstring and what is inside."""
    first = 1 if _has_docstring(code) else 0
    return (value for value in code.co_consts[first:] if not isinstance(value, types.CodeType))


def _has_docstring(code: types.CodeType) -> bool:
    """Tell whether the first constant is a docstring: that of "def" is, or it is None."""
    if sys.version_info >= (3, 14):  # functions without one have no None in its place there
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
