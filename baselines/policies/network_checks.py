"""This module checks networks, which may come from untrusted files, before they are compiled."""

import itertools
from typing import Any

import numpy as np

from baselines.policies.pooling import Encoder, pooled_size
from hav_env.observation import Observation, name_columns

MOST_LAYERS, WIDEST_LAYER, MOST_WEIGHTS = 32, 8_192, 1 << 22
MOST_OBSERVED_TRAILERS, MOST_COLUMNS = 1_000, 1 << 14
LARGEST_WEIGHT = 1e12  # up to it no sum of products overflows, and no action is NaN
_NUM_ACTIONS = 2


def check_network(policy: Any) -> None:
    """Check a ``Network``, for any scenario, before the allocation of its memory.

    Compiled code reads and writes its layers without bounds checks.

    Raises:
        ValueError: If a field is invalid; the message names the field, its value and the rule.
    """
    columns = count_columns(policy.observation, policy.max_trailers)
    pooling = policy.pooling
    if isinstance(pooling, Encoder):
        own, each = split_columns(policy.observation, policy.max_trailers)
        if (pooling.first, pooling.each) != (len(own), len(each)):
            found, rule = (pooling.first, pooling.each), (len(own), len(each))
            raise ValueError(f"policy pooling reads columns {found}, but they must be {rule}")
        columns = len(own)
        read = _count_inputs("pooling inputs", pooling.inputs, pooling.each)
        if pooling.limit != policy.limit:
            raise ValueError(f"policy pooling limit is {pooling.limit}, but must be {policy.limit}")
        if pooling.inputs.size == 0:
            raise ValueError("policy pooling inputs is empty, but must name columns")
        _check_layers("pooling ", pooling, read, read, None)
    columns = _count_inputs("inputs", policy.inputs, columns)
    _check_layers("", policy, columns, columns + pooled_size(pooling), _NUM_ACTIONS)


def _check_layers(of: str, layers: Any, columns: int, first: int, outputs: int | None) -> None:
    """Check layers that lead from ``first`` inputs, of which ``columns`` are normalized."""
    shape = layers.sizes.shape
    if len(shape) != 1 or not 2 <= shape[0] <= MOST_LAYERS + 1 or layers.sizes.dtype.kind != "i":
        raise ValueError(
            f"policy {of}sizes is {layers.sizes.dtype} of shape {shape}, which does not fit any"
            f" layers: it must be whole numbers of 1 to {MOST_LAYERS} layers"
        )
    sizes: list[int] = layers.sizes.tolist()  # integers of Python do not overflow
    last = sizes[-1] if outputs is None else outputs
    if min(sizes) < 1 or max(sizes[1:]) > WIDEST_LAYER or (sizes[0], sizes[-1]) != (first, last):
        raise ValueError(
            f"policy {of}sizes is {sizes}, which does not fit: it must lead from {first} columns to"
            f" {last} outputs, with 1 to {WIDEST_LAYER} units in between"
        )
    weights = sum((inputs + 1) * outputs for inputs, outputs in itertools.pairwise(sizes))
    if weights > MOST_WEIGHTS:
        rule = f"but must be of at most {MOST_WEIGHTS} weights"
        raise ValueError(f"policy {of}sizes is {sizes}, {rule}")
    for name, length in (("weights", weights), ("mean", columns), ("scale", columns)):
        array = getattr(layers, name)
        if array.shape != (length,) or array.dtype.kind != "f":
            found = f"{array.dtype} of shape {array.shape}"
            rule = f"it must be real numbers ({length},)"
            raise ValueError(f"policy {of}{name} is {found}, which does not fit: {rule}")
        large = ~(np.abs(array) <= LARGEST_WEIGHT)  # also true for NaN
        if large.any():
            rule = f"but must hold numbers from -{LARGEST_WEIGHT:g} to {LARGEST_WEIGHT:g}"
            raise ValueError(f"policy {of}{name} holds {array[large][0]:g}, {rule}")
    if not 0.0 < layers.limit < np.inf:
        raise ValueError(f"policy {of}limit is {layers.limit}, but must be finite and above 0")


def _count_inputs(name: str, inputs: np.ndarray, columns: int) -> int:
    """Return the number of columns that a network reads.

    Raises:
        ValueError: If an input is no column.
    """
    if inputs.ndim != 1 or inputs.dtype != np.int64 or inputs.size > MOST_COLUMNS:
        found = f"{inputs.dtype} of shape {inputs.shape}"
        rule = f"must be at most {MOST_COLUMNS} places of columns, int64"
        raise ValueError(f"policy {name} is {found}, but {rule}")
    outside = inputs[(inputs < 0) | (inputs >= columns)]
    if outside.size:
        raise ValueError(f"policy {name} holds {outside[0]}, but must be from 0 to {columns - 1}")
    return inputs.size or columns


def count_columns(observation: Observation, max_trailers: int) -> int:
    """Return the number of columns of an observation, without making their names.

    Raises:
        ValueError: If there are more columns than a policy may have.
    """
    if not 0 <= max_trailers <= MOST_OBSERVED_TRAILERS:
        rule = f"but must be from 0 to {MOST_OBSERVED_TRAILERS}"
        raise ValueError(f"policy max_trailers is {max_trailers}, {rule}")
    own, each = split_columns(observation, max_trailers)
    columns = len(own) + max(observation.neighbors, 0) * len(each)
    if columns > MOST_COLUMNS:
        raise ValueError(
            f"policy observation is of {observation.neighbors} neighbors, {columns} columns,"
            f" but must be of at most {MOST_COLUMNS} columns"
        )
    return columns


def split_columns(
    observation: Observation, max_trailers: int
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the names of the columns of the HAV itself, and of those of each neighbour.

    The names of the latter are without their prefix, as in ``present``.
    """
    own, one = (name_columns(observation._replace(neighbors=k), max_trailers) for k in (0, 1))
    return own, tuple(name.removeprefix("neighbor_0_") for name in one[len(own) :])


_WHAT = "chains", "fronts", "motion"


def describe_observation(observation: Observation, max_trailers: int) -> str:
    """Return an observation in words, for errors."""
    more = "".join(f" with {what}" for what in _WHAT if getattr(observation, what))
    return f"{observation.neighbors} neighbors{more} and up to {max_trailers} trailers"
