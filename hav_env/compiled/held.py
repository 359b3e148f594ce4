"""This module holds arguments of entries in a table, so a call passes a single address.

Numba unwraps each array and each number of nested tuples in every call. A decision process has
sixty of them, and unwrapping takes a quarter of the time of a step of one world.
"""

import struct
from collections.abc import Iterator
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba.extending import (
    NativeValue,
    lower_builtin,
    models,
    register_model,
    type_callable,
    typeof_impl,
    unbox,
)
from numba.np.arrayobj import populate_array


class Held:
    """Constant arguments of calls: numbers, arrays, and tuples of them.

    It keeps a reference to the arrays in its table, so their memory stays valid. It is immutable:
    make a new object for other arguments.
    """

    __slots__ = ("address", "arguments", "table")

    def __init__(self, *arguments: Any) -> None:
        """Write the table.

        Raises:
            TypeError: If an argument has another type.
        """
        self.arguments = arguments
        self.table = np.array([*_words_of(arguments)], np.int64)
        self.address = self.table.ctypes.data

    def __reduce__(self) -> tuple:
        """Copy the arguments: the copy has other addresses."""
        return Held, self.arguments


def arguments_of(held):
    """Return the held arguments, in kernels and entries."""
    return held.arguments


def _words_of(value: Any) -> Iterator[int]:
    """Yield the table's words for a value, in the order in which ``_read`` reads them."""
    if isinstance(value, tuple):
        for part in value:
            yield from _words_of(part)
    elif isinstance(value, np.ndarray):
        yield from (value.ctypes.data, *value.shape, *value.strides)
    elif isinstance(value, float | np.floating):
        yield from struct.unpack("q", struct.pack("d", value))
    elif isinstance(value, int | np.integer | np.bool_):
        yield int(value)
    elif value is not None:
        raise TypeError(f"{type(value).__name__} cannot be held, but numbers and arrays can")


class HeldType(numba.types.Type):
    """Type of ``Held``, by the types of its arguments."""

    def __init__(self, arguments: numba.types.BaseTuple) -> None:
        """Store the type of the arguments."""
        self.arguments = arguments
        super().__init__(f"Held({arguments})")


@register_model(HeldType)
class _Address(models.PrimitiveModel):
    def __init__(self, dmm: Any, kind: HeldType) -> None:
        super().__init__(dmm, kind, ir.IntType(64))


@typeof_impl.register(Held)
def _type_of(held: Held, context: Any) -> HeldType:
    return HeldType(numba.typeof(held.arguments))


@unbox(HeldType)
def _take_address(kind: HeldType, held: Any, context: Any) -> NativeValue:
    found = context.pyapi.object_getattr_string(held, "address")
    address = context.pyapi.long_as_longlong(found)
    context.pyapi.decref(found)
    return NativeValue(address)


@type_callable(arguments_of)
def _type_arguments(context: Any) -> Any:
    return lambda held: held.arguments


@lower_builtin(arguments_of, HeldType)
def _lower_arguments(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    word, place = ir.IntType(64), 0
    table = builder.inttoptr(arguments[0], word.as_pointer())

    def take() -> Any:
        nonlocal place
        place += 1
        return builder.load(builder.gep(table, [word(place - 1)]))

    def read(kind: Any) -> Any:
        if isinstance(kind, numba.types.BaseTuple):
            return context.make_tuple(builder, kind, [read(part) for part in kind.types])
        if isinstance(kind, numba.types.Array):
            return read_array(kind)
        if isinstance(kind, numba.types.NoneType):
            return context.get_dummy_value()
        wide = numba.float64 if isinstance(kind, numba.types.Float) else numba.int64
        number = builder.bitcast(take(), context.get_value_type(wide))
        return context.cast(builder, number, wide, kind)

    def read_array(kind: Any) -> Any:
        view = context.make_array(kind)(context, builder)
        data = builder.inttoptr(take(), view.data.type)
        shape, strides = ([take() for _ in range(kind.ndim)] for _ in range(2))
        size = word(context.get_abi_sizeof(context.get_data_type(kind.dtype)))
        populate_array(view, data, shape, strides, size, None)
        return view._getvalue()

    return read(signature.return_type)
