"""This module makes kernels: functions that are compiled into the entries that call them."""

import functools
from collections.abc import Callable
from typing import Any

from numba.extending import overload

from hav_env.compiled.compiler import LoopPart, Part, RarePart, Whole, compiler_into
from hav_env.compiled.digests import KERNELS

# Kernels allocate nothing, so Numba's reference counting of arrays is off: it would take most of
# the time.
_KERNEL_OPTIONS = {"error_model": "numpy", "nogil": True, "_nrt": False}
ENTERED = _KERNEL_OPTIONS | {"pipeline_class": compiler_into(Whole)}
_CALLED = _KERNEL_OPTIONS | {
    "pipeline_class": compiler_into(Part),
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
}
_INLINED = _CALLED | {"forceinline": True}
# explicit, because Numba otherwise inherits the caller's flags
RARE = _CALLED | {"forceinline": False, "pipeline_class": compiler_into(RarePart)}
LOOPED = RARE | {"pipeline_class": compiler_into(LoopPart)}


def kernel(function: Callable) -> Callable:
    """Mark a function to be compiled into the kernels and entries that call it.

    In Python it remains an ordinary function. Loops over lanes run several worlds at once only if
    all their callees are inlined and free of branches. LLVM does the inlining: Numba's own
    (``inline="always"``) takes ten times as long to compile and miscompiles returns out of loops.
    """
    KERNELS[function] = "inlined"
    overload(function, strict=False, jit_options=_INLINED)(lambda *args: function)
    return function


def rare_kernel(function: Callable) -> Callable:
    """Mark a function to be compiled but not inlined, because it is seldom needed."""
    KERNELS[function] = "called"
    overload(function, strict=False, jit_options=RARE)(lambda *args: function)
    return function


def loop_kernel(function: Callable) -> Callable:
    """Mark a function as the loop of an entry that passes on ``Held`` arguments.

    LLVM must assume that addresses read from a table may belong to one array. For arguments of a
    separate function, it assumes that arrays do not overlap.
    """
    KERNELS[function] = "loop"
    overload(function, strict=False, jit_options=LOOPED)(lambda *args: function)
    return function


def generic(stub: Callable) -> Any:
    """Dispatch kernels like ``functools.singledispatch``: the first argument's type selects code.

    Register a kernel with ``@stub.register(ModelClass)``; ``stub.table`` maps classes to kernels.
    ``@stub.otherwise`` registers the kernel for all other classes. The selection happens when a
    caller is compiled, so it costs nothing at run time.
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
            KERNELS.setdefault(function, "inlined")
            table[model_class] = function
            return function

        return decorate

    def otherwise(function: Callable) -> Callable:
        KERNELS.setdefault(function, "inlined")
        others.append(function)
        return function

    functools.update_wrapper(dispatch, stub)
    del dispatch.__wrapped__  # type: ignore[attr-defined]  # Numba would read the stub's signature
    dispatch.register, dispatch.table = register, table  # type: ignore[attr-defined]
    dispatch.otherwise, dispatch.others = otherwise, others  # type: ignore[attr-defined]
    overload(dispatch, strict=False, jit_options=_INLINED)(choose)
    return dispatch
