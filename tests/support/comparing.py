"""This module takes nested values apart, so that tests compare types and bits."""

import numpy as np


def leaves(value, name="") -> dict:
    """Return the leaves of nested dictionaries and sequences, by their path."""
    if isinstance(value, dict):
        parts = value.items()
    elif isinstance(value, tuple | list):
        parts = enumerate(value)
    elif isinstance(value, np.ndarray) and value.dtype == object:
        parts = enumerate(value.tolist())
    else:
        return {name: value}
    return {k: v for key, part in parts for k, v in leaves(part, f"{name}/{key}").items()}


def exactly(value) -> dict:
    """Return the same as types and bits, for comparison."""
    return {
        name: (type(part), getattr(part, "dtype", None), np.asarray(part).tobytes())
        for name, part in leaves(value).items()
    }
