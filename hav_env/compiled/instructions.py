"""This module adds instructions of LLVM that Python lacks, and the same bits in plain Python."""

import ctypes
import math
import os
import struct
import threading
from collections.abc import Callable

import numba
from llvmlite import ir
from numba.core import cgutils
from numba.extending import lower_builtin, type_callable


def _find_fma() -> Callable:
    if hasattr(math, "fma"):  # from Python 3.13 on
        return math.fma
    function = ctypes.CDLL("ucrtbase" if os.name == "nt" else None).fma
    function.restype, function.argtypes = ctypes.c_double, [ctypes.c_double] * 3
    return function


_fma = _find_fma()
_counting = threading.Lock()


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
    """Return ``array[..., first:]`` as an array of the same type.

    Compiled, only the address moves on: the shape stays, and the lanes that it has too many must
    not be touched.
    """
    return array[..., first:]


def contiguous(row):
    """Return an array of one axis whose elements lie together, as one that is known to do so.

    Elsewhere compiled code multiplies by the distance between elements wherever it reads one.
    """
    return row


def fixed(row):
    """Return the row of an array that the lane loops inside are to work on.

    Compiled, they take it as given. Otherwise LLVM tests once for all rounds of the loop outside
    whether what is written overlaps what is read; the rows of one array together do, and it would
    work on one lane at a time.
    """
    return row


def take(counter):
    """Return the number in an array of one, and count on: each thread gets another one."""
    with _counting:
        taken = counter[0]
        counter[0] = taken + 1
    return taken


type_callable(fma)(lambda context: lambda x, y, z: numba.float64)
type_callable(bits_of)(lambda context: lambda value: numba.int64)
type_callable(float_of)(lambda context: lambda bits: numba.float64)
type_callable(lanes_from)(lambda context: lambda array, first: array)
type_callable(contiguous)(lambda context: lambda row: row.copy(layout="C"))
type_callable(fixed)(lambda context: lambda row: numba.int64)
type_callable(take)(lambda context: lambda counter: numba.int64)


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
    if signature.args[0].layout == "C":
        view.data = builder.gep(view.data, [arguments[1]])
    else:
        stride = cgutils.unpack_tuple(builder, view.strides)[-1]
        offset = builder.mul(arguments[1], stride)
        view.data = cgutils.pointer_add(builder, view.data, offset)
    return view._getvalue()


@lower_builtin(contiguous, numba.types.Array)
def _lower_contiguous(context, builder, signature, arguments):
    (given,) = signature.args
    view = cgutils.create_struct_proxy(given)(context, builder, arguments[0])
    row = cgutils.create_struct_proxy(signature.return_type)(context, builder)
    for field in ("meminfo", "parent", "nitems", "itemsize", "data", "shape"):
        setattr(row, field, getattr(view, field))
    row.strides = cgutils.pack_array(builder, [view.itemsize])
    return row._getvalue()


@lower_builtin(fixed, numba.types.Integer)
def _lower_fixed(context, builder, signature, arguments):
    word = ir.IntType(64)
    return builder.asm(ir.FunctionType(word, [word]), "", "=r,0", arguments, side_effect=False)


@lower_builtin(take, numba.types.Array)
def _lower_take(context, builder, signature, arguments):
    view = cgutils.create_struct_proxy(signature.args[0])(context, builder, arguments[0])
    one = ir.Constant(ir.IntType(64), 1)
    return builder.atomic_rmw("add", view.data, one, "monotonic")
