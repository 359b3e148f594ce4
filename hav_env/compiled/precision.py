"""This module makes kernels as precise as their arguments: one source for float64 and float32.

If all floats among the arguments of a kernel are float32, its constants are float32 too, and so is
all its arithmetic. In plain Python the same follows from NumPy's rules, by which a Python float
takes the precision of a ``numpy.float32``. Rows of learners are float32, and so are worlds with
``precision="single"``: a vector holds twice as many of these numbers.
"""

import math
import struct
from collections.abc import Callable, Iterable, Iterator
from typing import Any, NamedTuple

import numba
import numpy as np
from llvmlite import ir
from numba.core import ir as numba_ir
from numba.core.compiler_machinery import FunctionPass, register_pass
from numba.core.ir_utils import build_definitions
from numba.extending import lower_builtin, type_callable

single = np.float32


def zeros_in_single(shape: tuple[int, ...], kind: type = np.float64) -> np.ndarray:
    """Return zeros as ``numpy.zeros`` does, but float32 in place of float64."""
    return np.zeros(shape, single if kind is np.float64 else kind)


ZEROS: dict[str, Callable[..., np.ndarray]] = {"double": np.zeros, "single": zeros_in_single}
"""Functions that make arrays in each precision."""


def narrow(models: Any) -> Any:
    """Return models, as ``canonical`` returns them, with float32 in place of all floats."""
    if isinstance(models, tuple):
        parts = map(narrow, models)
        return type(models)(*parts) if hasattr(models, "_fields") else tuple(parts)
    return single(models) if isinstance(models, float) else models


def like(number, x):
    """Return a number in the precision of x."""
    return single(number) if type(x) is single else number


def either(x, double, in_single):
    """Return the constant for the precision of x: the first for doubles, the second for float32."""
    return single(in_single) if type(x) is single else double


def rounder_of(x):
    """Return 1.5 * 2**52, or 1.5 * 2**23 for a float32.

    Added to a smaller number, it leaves no bits for a fraction. The sum rounds to the nearest whole
    number, half to even, and that number is in the lowest bits.
    """
    return like(_form_of(x).rounder, x)


def whole_in(shifted):
    """Return the whole number n of a float ``rounder_of(shifted) + n``."""
    return _bits_of(shifted) - _bits_of(rounder_of(shifted))


def two_to(shifted):
    """Return 2**n for a float ``rounder_of(shifted) + n``."""
    form = _form_of(shifted)
    bits = (whole_in(shifted) + form.bias << form.fraction) % (1 << form.size)
    return form.kind(struct.unpack(form.real, struct.pack(form.whole.upper(), bits))[0])


class _Form(NamedTuple):
    """The form of a float in memory: type, codes of ``struct``, and numbers of bits."""

    kind: type
    real: str
    whole: str
    size: int
    fraction: int
    bias: int

    @property
    def rounder(self) -> float:
        return 1.5 * 2.0**self.fraction


_DOUBLE = _Form(float, "<d", "<q", 64, 52, 1_023)
_SINGLE = _Form(single, "<f", "<i", 32, 23, 127)


def _form_of(x: Any) -> _Form:
    return _SINGLE if type(x) is single else _DOUBLE


def _bits_of(x: Any) -> int:
    form = _form_of(x)
    return struct.unpack(form.whole, struct.pack(form.real, x))[0]


@register_pass(mutates_CFG=False, analysis_only=False)
class MatchConstants(FunctionPass):
    """Make the constants of a kernel float32 if all floats among its arguments are."""

    _name = "match_constants"

    def __init__(self):
        """Make the pass; Numba calls this without arguments."""
        super().__init__()

    def run_pass(self, state):
        """Replace constants; return whether there are any."""
        if {kind.bitwidth for kind in _floats_in(state.args)} != {_SINGLE.size}:
            return False
        blocks, maths, changed = state.func_ir.blocks, set(), False
        for block in blocks.values():
            for assigned in block.find_insts(numba_ir.Assign):
                value, known = assigned.value, None
                if isinstance(value, numba_ir.Const | numba_ir.Global | numba_ir.FreeVar):
                    known = value.value
                elif getattr(value, "op", "") == "getattr" and value.value.name in maths:
                    known = getattr(math, value.attr)
                if known is math:
                    maths.add(assigned.target.name)
                if isinstance(known, float):
                    assigned.value = numba_ir.Const(single(known), value.loc)
                    changed = True
        if changed:
            state.func_ir._definitions = build_definitions(blocks)
        return changed


def _floats_in(kinds: Iterable[Any]) -> Iterator[Any]:
    """Yield the types of floats among types, in arrays and tuples too."""
    for kind in kinds:
        if isinstance(kind, numba.types.Float):
            yield kind
        elif isinstance(kind, numba.types.Array):
            yield from _floats_in([kind.dtype])
        elif isinstance(kind, numba.types.BaseTuple):
            yield from _floats_in(kind.types)


type_callable(like)(lambda context: lambda number, x: x)
type_callable(either)(lambda context: lambda x, double, in_single: x)
type_callable(rounder_of)(lambda context: lambda x: x)
type_callable(whole_in)(lambda context: lambda shifted: numba.int64)
type_callable(two_to)(lambda context: lambda shifted: shifted)


def _form_at(kind: Any) -> _Form:
    return _SINGLE if kind == numba.float32 else _DOUBLE


def _offset(builder: Any, kind: Any, shifted: Any) -> Any:
    """Return the bits of a float above those of its rounder."""
    form, word = _form_at(kind), ir.IntType(_form_at(kind).size)
    rounder = builder.bitcast(shifted.type(form.rounder), word)
    return builder.sub(builder.bitcast(shifted, word), rounder)


@lower_builtin(like, numba.types.Number, numba.types.Float)
def _lower_like(context, builder, signature, arguments):
    return context.cast(builder, arguments[0], signature.args[0], signature.return_type)


@lower_builtin(either, numba.types.Float, numba.types.Float, numba.types.Float)
def _lower_either(context, builder, signature, arguments):
    place = 2 if signature.return_type == numba.float32 else 1
    return context.cast(builder, arguments[place], signature.args[place], signature.return_type)


@lower_builtin(rounder_of, numba.types.Float)
def _lower_rounder_of(context, builder, signature, arguments):
    return arguments[0].type(_form_at(signature.args[0]).rounder)


@lower_builtin(whole_in, numba.types.Float)
def _lower_whole_in(context, builder, signature, arguments):
    offset, word = _offset(builder, signature.args[0], arguments[0]), ir.IntType(64)
    return offset if offset.type == word else builder.sext(offset, word)


@lower_builtin(two_to, numba.types.Float)
def _lower_two_to(context, builder, signature, arguments):
    form, offset = _form_at(signature.args[0]), _offset(builder, signature.args[0], arguments[0])
    biased = builder.add(offset, offset.type(form.bias))
    return builder.bitcast(builder.shl(biased, offset.type(form.fraction)), arguments[0].type)
