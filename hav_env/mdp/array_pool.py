"""This module pools the memory of large arrays, and reuses it once nobody holds any part of it.

Fresh memory for the outcome of an action in thousands of worlds takes half as long as the action.
A returned array must never change, though. So the holder of an array, of a view of it or of a
buffer keeps its memory. The pool does not count holders: the arrays stand on a loan, which comes
back when Python frees it. Every view in NumPy keeps its base.
"""

import collections
import weakref
from collections.abc import Sequence

import numpy as np

_ALIGNED = 64  # bytes: a line of the cache
_LARGE = 1 << 18  # bytes from which on memory is lent; small pieces are made faster than lent
_KEPT = 2  # pieces for the next loans


class _Loan:
    """Memory on which arrays stand as long as one of them, or of their views, is held."""

    def __init__(self, memory: np.ndarray) -> None:
        self._memory = memory
        self.__array_interface__ = memory.__array_interface__


class Recycler:
    """Lends memory of one size to arrays of fixed shapes and types; a copy lends its own."""

    def __init__(self, layout: Sequence[tuple[tuple[int, ...], type]]) -> None:
        """Take the shapes and types of the arrays that belong together."""
        self._layout, self._places = tuple(layout), []
        self._size = 0
        for shape, kind in self._layout:
            length = int(np.prod(shape)) * np.dtype(kind).itemsize
            self._places.append(slice(self._size, self._size + length))
            self._size += -(-length // _ALIGNED) * _ALIGNED
        self._free: collections.deque[np.ndarray] = collections.deque(maxlen=_KEPT)

    def __reduce__(self) -> tuple:
        """Copy the layout alone: memory is the original's."""
        return Recycler, (self._layout,)

    def arrays(self) -> tuple[np.ndarray, ...]:
        """Return arrays that nobody else holds; what is in them means nothing yet."""
        if self._size < _LARGE:
            return tuple(np.empty(shape, kind) for shape, kind in self._layout)
        memory = self._take()
        loan = _Loan(memory)
        weakref.finalize(loan, self._free.append, memory).atexit = False
        lent = np.asarray(loan)
        return tuple(
            lent[place].view(kind).reshape(shape)
            for place, (shape, kind) in zip(self._places, self._layout, strict=True)
        )

    def _take(self) -> np.ndarray:
        try:
            return self._free.pop()
        except IndexError:
            return np.empty(self._size, np.uint8)
