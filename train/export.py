"""This module exports the layers of any training stack as a policy that runs without PyTorch."""

from typing import Any

import numpy as np
import torch

from baselines.policies.network import Network, pack_layers
from baselines.policies.network_checks import split_columns
from baselines.policies.pooling import Encoder, NoPooling
from hav_env.guidance import Dubins
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.vehicles import Lines, bodies_of, needs_hitches


def network_of(
    layers: list[torch.nn.Linear],
    process: DecisionProcess,
    mean: np.ndarray | None = None,
    variance: np.ndarray | None = None,
    limit: float = np.inf,
    encoder: list[torch.nn.Linear] | None = None,
) -> Network:
    """Return layers with tanh between them as a policy.

    Args:
        layers: Layers from the observation (D,) to the means of both actions; with an encoder, from
            the HAV's own columns, and means and maxima over neighbours.
        process: Decision process of the training, with the observation, ``frame_skip`` and the
            vehicle.
        mean: (D,) Mean that normalizes observations, 0 by default.
        variance: (D,) Variance that normalizes observations, 1 by default.
        limit: Largest absolute value of normalized observations; larger ones are clipped.
        encoder: Layers with tanh units from the columns of a neighbour, for pooled neighbours; the
            mean and the variance of the first neighbour are those of all.
    """
    sizes, weights = _pack(layers)
    columns, guidance = len(process.columns), process.batch.guidance
    mean = np.zeros(columns) if mean is None else np.array(mean, float)
    scale = np.ones(columns) if variance is None else 1.0 / np.sqrt(np.array(variance, float))
    limit = float(min(limit, np.finfo(float).max))
    pooling: Any = NoPooling()
    if encoder is not None:
        own, each = map(
            len, split_columns(process.observation, process.batch.scenario.max_trailers)
        )
        one = slice(own, own + each)
        pooling = Encoder(*_pack(encoder), mean[one], scale[one], limit, np.arange(each), own, each)
        mean, scale = mean[:own], scale[:own]
    return Network(
        sizes,
        weights,
        mean,
        scale,
        limit,
        process.frame_skip,
        process.observation,
        process.batch.scenario.max_trailers,
        hitched=needs_hitches(process.batch.vehicle),
        rectangles=not isinstance(bodies_of(process.batch.vehicle), Lines),
        guidance="" if guidance == Dubins() else type(guidance).__name__.lower(),
        pooling=pooling,
    )


def _pack(layers: list[torch.nn.Linear]) -> tuple[np.ndarray, np.ndarray]:
    return pack_layers(
        [(layer.weight.detach().numpy(), layer.bias.detach().numpy()) for layer in layers]
    )
