"""This module sets the number of examples of a run: plain Python is a hundred times slower."""

import os

import numba

COMPILED = not numba.config.DISABLE_JIT
AUDIT = os.environ.get("HAV_AUDIT") == "1"


COMPARED = "the compiled suite runs both ways and compares them"


def budget(compiled: int, pure: int) -> int:
    """Return how many examples to run: pure Python is a hundred times slower."""
    return compiled if COMPILED else pure


def audited(full: int, usual: int) -> int:
    """Return how many examples an audit has: all of them with HAV_AUDIT=1, else a sample."""
    return full if AUDIT else usual
