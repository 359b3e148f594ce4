"""This module keeps coverage's tracer out of Numba's compiler, which it slows by half."""

import functools
import sys
from collections.abc import Callable
from typing import Any

from numba.core.dispatcher import _FunctionCompiler


def untraced(function: Callable) -> Callable:
    """Return a function that runs without the tracer of its thread, which continues after it."""

    @functools.wraps(function)
    def call(*args: Any, **options: Any) -> Any:
        tracer = sys.gettrace()
        sys.settrace(None)
        try:
            return function(*args, **options)
        finally:
            sys.settrace(tracer)

    return call


def leave_compiler_untraced() -> None:
    """Let no tracer follow Numba's compiler; the cache of compiled code, around it, is traced."""
    _FunctionCompiler.compile = untraced(_FunctionCompiler.compile)
