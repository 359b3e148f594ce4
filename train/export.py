"""This module exports what a training stack has learned, as a policy that runs anywhere."""

import numpy as np
import torch

from baselines.policies.network import Network, pack_layers
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.vehicles import Lines, bodies_of, needs_hitches


def network_of(
    layers: list[torch.nn.Linear],
    process: DecisionProcess,
    mean: np.ndarray | None = None,
    variance: np.ndarray | None = None,
    limit: float = np.inf,
) -> Network:
    """Return layers, with tanh between them, as a policy.

    Args:
        layers: from the observation (D,) to the means of both actions.
        process: decision process of the training, which states the observation, ``frame_skip`` and
            the vehicle.
        mean: (D,) by which observations are normalized; none by default.
        variance: (D,), likewise.
        limit: to which normalized observations are cut.
    """
    sizes, weights = pack_layers(
        [(layer.weight.detach().numpy(), layer.bias.detach().numpy()) for layer in layers]
    )
    columns = len(process.columns)
    mean = np.zeros(columns) if mean is None else np.array(mean, float)
    scale = np.ones(columns) if variance is None else 1.0 / np.sqrt(np.array(variance, float))
    return Network(
        sizes,
        weights,
        mean,
        scale,
        float(min(limit, np.finfo(float).max)),
        process.frame_skip,
        process.observation,
        process.batch.scenario.max_trailers,
        hitched=needs_hitches(process.batch.vehicle),
        rectangles=not isinstance(bodies_of(process.batch.vehicle), Lines),
    )
