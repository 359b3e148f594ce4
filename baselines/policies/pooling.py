"""This module pools a network's neighbours: a shared encoder, and mean and maximum over neighbours.

The output depends neither on the order of the neighbours nor on those that are absent, and the
weights fit any number of neighbours (DeepSets, Zaheer et al. 2017).
"""

from typing import Any, NamedTuple

import numpy as np

from baselines.policies.layers import normalize, propagate
from hav_env.compiled import fixed, generic, kernel
from hav_env.maths.elementary import exp

POOLS = 2  # mean and maximum
_PRESENT, _COUNT, _LAYERS = range(3)  # scratch rows of the encoder


class NoPooling(NamedTuple):
    """No encoder: the first layer reads the columns of each neighbour."""


class Encoder(NamedTuple):
    """Layers that encode one neighbour, the same for all neighbours.

    All layers have tanh units. The first layer behind the encoder reads the HAV's own columns, the
    mean of each output over the present neighbours, and the maximum. Without neighbours both are 0.
    """

    sizes: np.ndarray
    """(L + 1,) int64: number of columns that are read of a neighbour, then the units of each layer.
    """
    weights: np.ndarray
    """float64: for each layer, its weights (outputs, inputs), then its biases."""
    mean: np.ndarray
    """(C,) float64, mean of each column."""
    scale: np.ndarray
    """(C,) float64, factor of each column."""
    limit: float
    """Largest absolute value of a normalized column."""
    inputs: np.ndarray
    """(C,) int64: columns of a neighbour that the first layer reads."""
    first: int
    """Number of columns of an observation ahead of those of the first neighbour."""
    each: int
    """Number of columns of each neighbour in an observation; the first one is ``present``."""


@generic
def pool_neighbors(
    pooling: Any,
    neighbors: int,
    chosen: np.ndarray,
    due: int,
    columns: np.ndarray,
    pooled: np.ndarray,
    lanes: int,
) -> None:
    """Write the pooled outputs of an encoder in the first lanes.

    Args:
        pooling: ``NoPooling`` or an ``Encoder``; its type selects the code.
        neighbors: Number of neighbours in the observation.
        chosen: (L,) lanes of the observation; the first ``due`` of them are read.
        due: Number of lanes that are read.
        columns: (K, L) columns of the observation, then the scratch of ``pooling_rows``.
        pooled: (2 E, L) to write: means and maxima of the E outputs.
        lanes: Number of lanes to write.
    """


@pool_neighbors.register(NoPooling)
def pool_nothing(pooling, neighbors, chosen, due, columns, pooled, lanes):
    """Do nothing: there is no encoder."""


@pool_neighbors.register(Encoder)
def pool_encoded(pooling, neighbors, chosen, due, columns, pooled, lanes):
    """Encode the neighbours one after the other, each in all lanes at once."""
    scratch = columns[pooling.first + neighbors * pooling.each :]
    size = pooling.sizes[pooling.sizes.size - 1]
    for number in range(size):
        mean, most = fixed(number), fixed(size + number)
        for k in range(lanes):
            pooled[mean, k], pooled[most, k] = 0.0, -1.0  # tanh is above -1
    for k in range(lanes):
        scratch[_COUNT, k] = 0.0
    for neighbor in range(neighbors):
        first = pooling.first + neighbor * pooling.each
        present = 0.0
        for k in range(lanes):
            scratch[_PRESENT, k] = columns[first, int(chosen[k])] if k < due else 0.0
            scratch[_COUNT, k] += scratch[_PRESENT, k]
            present += scratch[_PRESENT, k]
        if present > 0.0:
            _encode(pooling, first, chosen, due, columns, scratch, pooled, size, lanes)
    for number in range(size):
        mean, most = fixed(number), fixed(size + number)
        for k in range(lanes):
            count = scratch[_COUNT, k]
            pooled[mean, k] = pooled[mean, k] / max(count, 1.0)
            pooled[most, k] = pooled[most, k] if count > 0.0 else 0.0


@kernel
def _encode(pooling, first, chosen, due, columns, scratch, pooled, size, lanes):
    """Add the outputs for the neighbour whose columns begin at ``first``."""
    rows = scratch[_LAYERS:]
    for number in range(pooling.inputs.size):
        column, row = first + pooling.inputs[number], fixed(number)
        for k in range(lanes):
            rows[row, k] = columns[column, int(chosen[k])] if k < due else 0.0
    normalize(pooling, rows[: pooling.inputs.size], lanes)
    outputs = propagate(pooling, rows, lanes)
    for number in range(size):
        mean, most, output = fixed(number), fixed(size + number), fixed(outputs + number)
        for k in range(lanes):
            present = scratch[_PRESENT, k]
            value = 1.0 - 2.0 / (1.0 + exp(2.0 * rows[output, k]))  # tanh
            pooled[mean, k] += present * value
            pooled[most, k] = max(pooled[most, k], present * (value + 1.0) - 1.0)


def pooled_size(pooling: Any) -> int:
    """Return the number of pooled outputs; 0 without an encoder."""
    return POOLS * int(pooling.sizes[-1]) if isinstance(pooling, Encoder) else 0


def pooling_rows(pooling: Any) -> int:
    """Return the number of scratch rows behind the columns of an observation."""
    if not isinstance(pooling, Encoder):
        return 0
    return _LAYERS + int(pooling.sizes[0]) + 2 * int(max(pooling.sizes[1:]))
