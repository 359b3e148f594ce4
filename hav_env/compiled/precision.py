"""This module derives single-precision kernels from double-precision kernels: one source for both.

Rows of learners are float32. Computing them in single precision takes half as long, because a
vector holds twice as many numbers. State, motion and events stay in double precision.
"""

import functools
import math
import types
from collections.abc import Callable
from typing import Any

import numpy as np

from hav_env.compiled.digests import KERNELS
from hav_env.compiled.kernels import kernel, rare_kernel

single = np.float32

_MATHS = types.ModuleType("single_math", "The part of ``math`` that kernels use, for float32.")
vars(_MATHS).update(sqrt=np.sqrt, pi=single(math.pi), inf=single(math.inf))


@functools.cache
def in_single(function: Callable) -> Callable:
    """Return the single-precision version of a double-precision kernel.

    Its constants, and those of all kernels that it calls, are float32. If the arguments are
    float32, so is all arithmetic, compiled or not. A module lists constants with another value in
    single precision by name in its ``_IN_SINGLE``.

    Args:
        function: Kernel of scalars, or a function that only calls kernels; generic kernels and
            kernels on bits are not allowed.

    Raises:
        TypeError: If the function is a generic kernel.
    """
    if hasattr(function, "table"):
        raise TypeError(f"{function.__name__} is generic, but must be one kernel")
    code, known = function.__code__, function.__globals__
    others = known.get("_IN_SINGLE", {})
    names = {
        name: single(others[name]) if name in others else _convert(known[name])
        for name in code.co_names
        if name in known
    }
    code = code.replace(co_consts=tuple(map(_convert, code.co_consts)))
    twin = types.FunctionType(
        code, {"__name__": function.__module__} | names, function.__name__, function.__defaults__
    )
    twin.__qualname__, twin.__doc__ = f"{function.__qualname__} in single", function.__doc__
    return rare_kernel(twin) if KERNELS.get(function) == "called" else kernel(twin)


def _convert(value: Any) -> Any:
    """Return the single-precision counterpart of a constant, a function or a module."""
    if isinstance(value, float):
        return single(value)
    if isinstance(value, types.FunctionType) and value in KERNELS:
        return in_single(value)
    return _MATHS if value is math else value
