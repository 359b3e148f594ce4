"""This module adds arrays on the stack, and numbers that move from lane to lane in registers."""

import math

import numba
import numpy as np
from llvmlite import ir
from numba.core import cgutils
from numba.extending import lower_builtin, type_callable
from numba.np.arrayobj import populate_array

_SHIFTED = 8  # number of doubles in a vector of 512 bits


def local_array(units, rows, lanes):
    """Return an array of three axes with void values, which lasts until its kernel returns.

    The kernel must be a ``rare_kernel``, and the lengths constants. In compiled code the array is
    on the stack, and overlaps no other array.
    """
    return np.zeros((units, rows, lanes))


def local_singles(rows, lanes):
    """Return an array of two axes of float32: otherwise ``local_array``."""
    return np.zeros((rows, lanes), np.float32)


def shift_up(rows, row, place, value):
    """Move the eight numbers rows[row, place : place + 8] up one place, and put a value first.

    In compiled code they stay in a register. Reading at one place and writing at the next would
    wait for the memory.

    Returns:
        The number that had the last place.
    """
    moved = rows[row, place : place + _SHIFTED]
    last = moved[-1]
    moved[1:] = moved[:-1].copy()
    moved[0] = value
    return last


@type_callable(local_array)
def _type_local_array(context):
    return lambda units, rows, lanes: numba.types.Array(numba.float64, 3, "C")


@type_callable(local_singles)
def _type_local_singles(context):
    return lambda rows, lanes: numba.types.Array(numba.float32, 2, "C")


@type_callable(shift_up)
def _type_shift_up(context):
    return lambda rows, row, place, value: numba.float64


@lower_builtin(local_array, *(numba.types.Integer,) * 3)
@lower_builtin(local_singles, *(numba.types.Integer,) * 2)
def _lower_local_array(context, builder, signature, arguments):
    word, kind = ir.IntType(64), signature.return_type
    real = context.get_value_type(kind.dtype)
    size = 4 if kind.dtype == numba.float32 else 8
    shape = [length.constant for length in arguments]
    with builder.goto_entry_block():  # ``alloca_once`` would write zeros at every call
        memory = builder.alloca(ir.ArrayType(real, math.prod(shape)))
    memory.align = 64
    view = context.make_array(kind)(context, builder)
    populate_array(
        view,
        data=builder.bitcast(memory, real.as_pointer()),
        shape=[word(length) for length in shape],
        strides=[word(size * math.prod(shape[axis:])) for axis in range(1, len(shape) + 1)],
        itemsize=word(size),
        meminfo=None,
    )
    return view._getvalue()


@lower_builtin(
    shift_up,
    *(numba.types.Array, numba.types.Integer, numba.types.Integer, numba.types.Float),
)
def _lower_shift_up(context, builder, signature, arguments):
    rows, row, place, value = arguments
    real, half = ir.DoubleType(), ir.IntType(32)
    view = cgutils.create_struct_proxy(signature.args[0])(context, builder, rows)
    across, along = cgutils.unpack_tuple(builder, view.strides)
    address = builder.add(builder.mul(row, across), builder.mul(place, along))
    address = cgutils.pointer_add(builder, view.data, address)
    address = builder.bitcast(address, ir.VectorType(real, _SHIFTED).as_pointer())
    moved = builder.load(address, align=8)
    order = [half(0), *map(half, range(_SHIFTED - 1))]
    mask = ir.Constant(ir.VectorType(half, _SHIFTED), order)
    shifted = builder.insert_element(builder.shuffle_vector(moved, moved, mask), value, half(0))
    builder.store(shifted, address, align=8)
    return builder.extract_element(moved, half(_SHIFTED - 1))
