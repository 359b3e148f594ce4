"""This module pools the memory of large arrays, and reuses it once nobody holds any part of it.

Fresh memory for the outcome of an action in thousands of worlds takes half as long as the action.
A returned array must never change, though. So the holder of an array, of a view of it or of a
buffer keeps its memory. The pool does not count holders: the arrays stand on a loan, which comes
back when Python frees it. Every view in NumPy keeps its base.
"""

import collections
from collections.abc import Sequence
from typing import Any

import numpy as np

_ALIGNED = 64  # bytes: a line of the cache
_LARGE = 1 << 18  # bytes from which on memory is lent; small pieces are made faster than lent
_KEPT = 2  # pieces for the next loans

# pieces with the description of each, which NumPy would otherwise write anew
_Free = collections.deque[tuple[np.ndarray, dict[str, Any]]]


class _Loan:
    """Memory on which arrays stand as long as one of them, or of their views, is held."""

    def __init__(self, memory: np.ndarray, interface: dict[str, Any], free: _Free) -> None:
        self._memory, self._free = memory, free
        self.__array_interface__ = interface

    def __del__(self) -> None:
        self._free.append((self._memory, self.__array_interface__))


class Recycler:
    """Lends memory of one size to arrays of fixed shapes and types; a copy lends its own."""

    def __init__(self, layout: Sequence[tuple[tuple[int, ...], type]]) -> None:
        """Take the shapes and types of the arrays that belong together."""
        self._layout, self._places = tuple(layout), []
        self._size = 0
        for shape, kind in self._layout:
            length = int(np.prod(shape)) * np.dtype(kind).itemsize
            self._places.append(self._size)
            self._size += -(-length // _ALIGNED) * _ALIGNED
        self._free: _Free = collections.deque(maxlen=_KEPT)

    def __reduce__(self) -> tuple:
        """Copy the layout alone: memory is the original's."""
        return Recycler, (self._layout,)

    def arrays(self) -> tuple[np.ndarray, ...]:
        """Return arrays that nobody else holds; what is in them means nothing yet."""
        if self._size < _LARGE:
            return tuple(np.empty(shape, kind) for shape, kind in self._layout)
        lent = np.asarray(_Loan(*self._take(), self._free))
        return tuple(
            np.ndarray(shape, kind, lent, place)
            for place, (shape, kind) in zip(self._places, self._layout, strict=True)
        )

    def _take(self) -> tuple[np.ndarray, dict[str, Any]]:
        try:
            return self._free.pop()
        except IndexError:
            memory = np.empty(self._size, np.uint8)
            return memory, memory.__array_interface__
