"""This module adds LLVM instructions that Python lacks, with bit-equal versions in plain Python."""

import ctypes
import math
import os
import struct
import threading
from collections.abc import Callable

import numba
import numpy as np
from llvmlite import ir
from numba.core import cgutils
from numba.core.registry import CPUDispatcher
from numba.extending import lower_builtin, type_callable

TILE_SIDE = 16  # number of float32 in a vector of 512 bits
_SQRT_HALF = math.sqrt(0.5)


def _find_in_libm(name: str, kind: type) -> Callable:
    """Return a function of the C library that takes and returns floats of one kind."""
    function = getattr(ctypes.CDLL("ucrtbase" if os.name == "nt" else None), name)
    function.restype, function.argtypes = kind, [kind] * 3
    return function


# Python 3.13 and later have math.fma
_fma = getattr(math, "fma", None) or _find_in_libm("fma", ctypes.c_double)
_fma_of_singles = _find_in_libm("fmaf", ctypes.c_float)
_counting = threading.Lock()


def fma(x, y, z):
    """Return x * y + z, rounded once: one instruction, bit-equal on all machines.

    The result is a float32 if all three are, apart from constants.
    """
    kinds = type(x), type(y), type(z)
    if np.float32 in kinds and all(kind is np.float32 or kind is float for kind in kinds):
        return np.float32(_fma_of_singles(x, y, z))
    return _fma(x, y, z)


def split_power(x):
    """Return k and m of x = 2**k m with m from sqrt(1/2) to sqrt(2), both floats of the type of x.

    x must be positive and normal.
    """
    kind, real, whole, fraction = (
        (np.float32, "<f", "<i", 23) if type(x) is np.float32 else (float, "<d", "<q", 52)
    )
    bits, half = (struct.unpack(whole, struct.pack(real, y))[0] for y in (x, _SQRT_HALF))
    power = (bits - half) >> fraction
    (mantissa,) = struct.unpack(real, struct.pack(whole, bits - (power << fraction)))
    return kind(power), kind(mantissa)


def transpose_tile(columns, column, lane, rows, row, place):
    """Write rows[row + i, place + j] = columns[column + j, lane + i] for i, j below ``TILE_SIDE``.

    Both arrays are of float32. In compiled code, a whole tile stays in registers. Reading along one
    axis and writing along the other would move one number at a time.
    """
    tile = columns[column : column + TILE_SIDE, lane : lane + TILE_SIDE]
    rows[row : row + TILE_SIDE, place : place + TILE_SIDE] = tile.T


def lanes_from(array, first):
    """Return ``array[..., first:]`` as an array of the same type.

    In compiled code only the address changes. The shape does not, so code must not access the
    surplus lanes.
    """
    return array[..., first:]


def of_width(array, width):
    """Return an array of two axes, the last of length ``width``, with that length as a constant.

    The width must be a constant. Compiled code then knows the distance between rows, and that lanes
    of different rows do not overlap. If it has to test this, it often gives up vectorising.
    """
    return array


def contiguous(row):
    """Return an array of one axis with adjacent elements as one whose type is contiguous.

    For other arrays, compiled code multiplies by the stride at every access.
    """
    return row


def fixed(row):
    """Return the row of an array on which the inner lane loops work.

    Compiled inner loops treat the row as a constant. Otherwise LLVM tests once, for all iterations
    of the outer loop, whether written memory overlaps read memory. All rows of one array together
    do overlap, so the loop would work on one lane at a time.
    """
    return row


def lowest_bit(bits):
    """Return the place of the lowest 1 among the bits of a whole number, which must not be 0."""
    number = int(bits)  # NumPy's integers overflow
    return (number & -number).bit_length() - 1


def take(counter):
    """Return the number in an array of one, and increment it: each thread gets another number."""
    with _counting:
        taken = counter[0]
        counter[0] = taken + 1
    return taken


type_callable(fma)(lambda context: _type_fma)
type_callable(split_power)(lambda context: lambda x: numba.types.UniTuple(x, 2))
type_callable(transpose_tile)(
    lambda context: lambda columns, column, lane, rows, row, place: numba.types.none
)
type_callable(lanes_from)(lambda context: lambda array, first: array)
type_callable(of_width)(lambda context: lambda array, width: array)
type_callable(contiguous)(lambda context: lambda row: row.copy(layout="C"))
type_callable(fixed)(lambda context: lambda row: numba.int64)
type_callable(lowest_bit)(lambda context: lambda bits: numba.int64)
type_callable(take)(lambda context: lambda counter: numba.int64)


def _type_fma(x, y, z):
    return numba.float32 if x == y == z == numba.float32 else numba.float64


@lower_builtin(fma, numba.types.Float, numba.types.Float, numba.types.Float)
def _lower_fma(context, builder, signature, arguments):
    kind = signature.return_type
    pairs = zip(arguments, signature.args, strict=True)
    return builder.fma(*(context.cast(builder, value, given, kind) for value, given in pairs))


@lower_builtin(split_power, numba.types.Float)
def _lower_split_power(context, builder, signature, arguments):
    (x,), (kind,) = arguments, signature.args
    size, fraction = (32, 23) if kind == numba.float32 else (64, 52)
    whole, real = ir.IntType(size), x.type
    bits = builder.bitcast(x, whole)
    half = builder.bitcast(real(_SQRT_HALF), whole)
    power = builder.ashr(builder.sub(bits, half), whole(fraction))
    mantissa = builder.bitcast(builder.sub(bits, builder.shl(power, whole(fraction))), real)
    # added to 1.5 * 2**fraction, a whole number is in the lowest bits: AVX2 vectorises this, but
    # not the conversion of 64 bits
    rounder = real(1.5 * 2.0**fraction)
    shifted = builder.add(builder.bitcast(rounder, whole), power)
    exponent = builder.fsub(builder.bitcast(shifted, real), rounder)
    return context.make_tuple(builder, signature.return_type, (exponent, mantissa))


@lower_builtin(
    transpose_tile,
    *(numba.types.Array, numba.types.Integer, numba.types.Integer),
    *(numba.types.Array, numba.types.Integer, numba.types.Integer),
)
def _lower_transpose_tile(context, builder, signature, arguments):
    word, half = ir.IntType(64), ir.IntType(32)
    vector = ir.VectorType(ir.FloatType(), TILE_SIDE)

    def places(first: int):
        """Yield the addresses of the tile's rows in an array."""
        given = arguments[first], signature.args[first]
        view = cgutils.create_struct_proxy(given[1])(context, builder, given[0])
        across, along = cgutils.unpack_tuple(builder, view.strides)
        start = builder.ptrtoint(view.data, word)
        start = builder.add(start, builder.mul(arguments[first + 1], across))
        start = builder.add(start, builder.mul(arguments[first + 2], along))
        for k in range(TILE_SIDE):
            address = builder.add(start, builder.mul(across, word(k)))
            yield builder.inttoptr(address, vector.as_pointer())

    rows = [builder.load(place, align=4) for place in places(0)]
    distance = 1
    while distance < TILE_SIDE:  # exchanges blocks across the diagonal
        own, other = [], []
        for j in range(TILE_SIDE):
            own.append(TILE_SIDE + j - distance if j & distance else j)
            other.append(TILE_SIDE + j if j & distance else j + distance)
        masks = [
            ir.Constant(ir.VectorType(half, TILE_SIDE), [half(j) for j in order])
            for order in (own, other)
        ]
        for i in range(TILE_SIDE):
            if not i & distance:
                pair = rows[i], rows[i + distance]
                rows[i], rows[i + distance] = (
                    builder.shuffle_vector(*pair, mask) for mask in masks
                )
        distance *= 2
    for row, place in zip(rows, places(3), strict=True):
        builder.store(row, place, align=4)
    return context.get_dummy_value()


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


@lower_builtin(of_width, numba.types.Array, numba.types.Integer)
def _lower_of_width(context, builder, signature, arguments):
    given = signature.args[0]
    if given.layout != "C" or given.ndim != 2:
        return arguments[0]
    view = cgutils.create_struct_proxy(given)(context, builder, arguments[0])
    height, _ = cgutils.unpack_tuple(builder, view.shape)
    view.shape = cgutils.pack_array(builder, [height, arguments[1]])
    apart = builder.mul(arguments[1], view.itemsize)
    view.strides = cgutils.pack_array(builder, [apart, view.itemsize])
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


@lower_builtin(lowest_bit, numba.types.Integer)
def _lower_lowest_bit(context, builder, signature, arguments):
    return builder.cttz(arguments[0], ir.Constant(ir.IntType(1), 1))


@lower_builtin(take, numba.types.Array)
def _lower_take(context, builder, signature, arguments):
    view = cgutils.create_struct_proxy(signature.args[0])(context, builder, arguments[0])
    one = ir.Constant(ir.IntType(64), 1)
    return builder.atomic_rmw("add", view.data, one, "monotonic")


def _compile_fma() -> Callable:
    """Return ``fma`` of doubles as a function of C that Python calls directly."""

    def fused(x, y, z):
        return fma(x, y, z)

    signature = (numba.float64,) * 3
    dispatcher = CPUDispatcher(fused, targetoptions={"nopython": True})
    dispatcher.compile(signature)
    return dispatcher.overloads[signature].entry_point


if numba.config.DISABLE_JIT and not hasattr(math, "fma"):
    # ctypes takes several times as long for a call, and sines are made of such calls
    _fma = _compile_fma()
