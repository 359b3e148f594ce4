"""This module derives kernels in single precision from those in double precision: one text of both.

Rows of learners are float32. What is worked out for them alone takes half as long in single
precision, for a vector holds twice as many numbers. State, motion and events stay in double.
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

_MATHS = types.ModuleType("single_math", "What kernels use of ``math``, for float32.")
vars(_MATHS).update(sqrt=np.sqrt, pi=single(math.pi), inf=single(math.inf))


@functools.cache
def in_single(function: Callable) -> Callable:
    """Return the kernel that does in single precision what another does in double.

    Its constants, and those of all kernels that it calls, are float32: where the arguments are, so
    is all arithmetic, compiled or not. A constant of a module that is to be another number then is
    listed by name in the module's ``_IN_SINGLE``.

    Args:
        function: a kernel of scalars, or a function that only calls kernels; none that is generic
            or works on bits.

    Raises:
        TypeError: when the function is a generic kernel.
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
    """Return what stands for a constant, a function or a module in single precision."""
    if isinstance(value, float):
        return single(value)
    if isinstance(value, types.FunctionType) and value in KERNELS:
        return in_single(value)
    return _MATHS if value is math else value
