"""This module sets the number of examples of a run: plain Python is a hundred times slower."""

import numba

COMPILED = not numba.config.DISABLE_JIT


COMPARED = "the compiled suite runs both ways and compares them"


def budget(compiled: int, pure: int) -> int:
    """Return how many examples to run: pure Python is a hundred times slower."""
    return compiled if COMPILED else pure
