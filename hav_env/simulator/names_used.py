"""This module checks the names in a user's kernel before it runs: undefined or misspelt names.

It reads the bytecode, so it also covers branches that a trial run does not take.
"""

import builtins
import dis
import types
from collections.abc import Iterator
from typing import Any

from hav_env.compiled.digests import KERNELS, codes_in


def undefined_name(function: Any, package: str) -> tuple[str, str, int] | None:
    """Return the first undefined name in a function or in the kernels that it calls.

    Args:
        function: Kernel to check.
        package: Outermost package whose kernels are followed.

    Returns:
        A message that names it, the file and the line; None if all names are defined.
    """
    seen: set[Any] = set()
    left = [function]
    while left:
        one = left.pop()
        if one in seen:
            continue
        seen.add(one)
        for value, problem, line in _uses(one):
            if problem:
                return problem, one.__code__.co_filename, line
            own = isinstance(value, types.FunctionType) and value in KERNELS
            if own and value.__module__.partition(".")[0] == package:
                left.append(value)
    return None


def _uses(function: types.FunctionType) -> Iterator[tuple[Any, str, int]]:
    """Yield each global name, and each attribute of a module, that a function uses.

    Each item is a tuple: value, error message or "", line.
    """
    names = vars(builtins) | function.__globals__
    for code in codes_in(function.__code__):
        module: types.ModuleType | None = None
        line = code.co_firstlineno
        for step in dis.get_instructions(code):
            line = (step.positions.lineno if step.positions else None) or line
            value: Any = None
            if step.opname in ("LOAD_GLOBAL", "LOAD_NAME"):
                if step.argval not in names:
                    yield None, f"name {step.argval!r} is not defined", line
                value = names.get(step.argval)
                yield value, "", line
            elif step.opname in ("LOAD_ATTR", "LOAD_METHOD") and module is not None:
                if not hasattr(module, step.argval):
                    message = f"module {module.__name__!r} has no attribute {step.argval!r}"
                    yield None, message, line
                value = getattr(module, step.argval, None)
                yield value, "", line
            module = value if isinstance(value, types.ModuleType) else None
