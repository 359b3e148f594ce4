"""This module pools the memory of large arrays, and reuses memory that no array or view holds.

Allocating the outcome of an action in thousands of worlds takes half as long as the action.
However, a returned array must never change. An array, a view of it or a buffer therefore keeps its
memory. The pool does not count references. Its arrays are views of a loan object, and Python frees
the loan with the last view. Every NumPy view holds a reference to its base.
"""

import collections
from collections.abc import Sequence
from typing import Any

import numpy as np

_ALIGNED = 64  # bytes: a cache line
_LARGE = 1 << 18  # bytes from which on the pool lends memory; smaller arrays are faster to allocate
_KEPT = 2  # pieces kept for the next loans

# pieces of memory, each with its array interface, which NumPy would otherwise rebuild
_Free = collections.deque[tuple[np.ndarray, dict[str, Any]]]


class _Loan:
    """Memory of arrays; it lives as long as one of them, or one of their views."""

    def __init__(self, memory: np.ndarray, interface: dict[str, Any], free: _Free) -> None:
        self._memory, self._free = memory, free
        self.__array_interface__ = interface

    def __del__(self) -> None:
        self._free.append((self._memory, self.__array_interface__))


class Recycler:
    """Lends memory of one size to arrays of fixed shapes and types; a copy lends its own memory."""

    def __init__(self, layout: Sequence[tuple[tuple[int, ...], type]]) -> None:
        """Store the shapes and types of the arrays that belong together."""
        self._layout, self._places = tuple(layout), []
        self._size = 0
        for shape, kind in self._layout:
            length = int(np.prod(shape)) * np.dtype(kind).itemsize
            self._places.append(self._size)
            self._size += -(-length // _ALIGNED) * _ALIGNED
        self._free: _Free = collections.deque(maxlen=_KEPT)

    def __reduce__(self) -> tuple:
        """Copy the layout alone: the original keeps its memory."""
        return Recycler, (self._layout,)

    def arrays(self) -> tuple[np.ndarray, ...]:
        """Return uninitialised arrays that share no memory with others in use."""
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
