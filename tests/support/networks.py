"""Networks for tests, and their outputs, computed again in double precision."""

import itertools
import json

import numpy as np

from baselines.policies.network import Network, normalize, pack_layers, propagate
from hav_env import Observation
from hav_env.compiled import entry, lanes_from
from hav_env.observation import name_columns


@entry
def forward_worlds(first, last, policy, rows):
    """Compute a network in a range of the lanes of ``rows`` (K, W), of which the first are inputs.

    Both outputs are moved to the first two rows.
    """
    own, lanes = lanes_from(rows, first), last - first
    normalize(policy, own[: policy.sizes[0]], lanes)
    outputs = propagate(policy, own, lanes)
    for k in range(lanes):
        own[0, k], own[1, k] = own[outputs, k], own[outputs + 1, k]


def forward(network: Network, observations) -> np.ndarray:
    """Return both outputs (W, 2) for observations (W, D), as compiled code computes them."""
    size = int(network.sizes[0]) + 2 * int(max(network.sizes[1:]))
    rows = np.zeros((size, len(observations)))
    rows[: network.sizes[0]] = np.transpose(observations)
    forward_worlds(len(observations), network, rows, threads=1)
    return rows[:2].T


def actions_of(network: Network, observations) -> np.ndarray:
    """Return the actions (..., 2) for observations (..., D), by matrices of doubles."""
    values = (np.asarray(observations, float) - network.mean) * network.scale
    values, at = np.clip(values, -network.limit, network.limit), 0
    for layer, (inputs, outputs) in enumerate(
        zip(network.sizes[:-1], network.sizes[1:], strict=True)
    ):
        values = values if layer == 0 else np.tanh(values)
        matrix = network.weights[at : at + inputs * outputs].reshape(outputs, inputs)
        at += inputs * outputs
        values = values @ matrix.T + network.weights[at : at + outputs]
        at += outputs
    assert at == network.weights.size
    return np.clip(values, -1.0, 1.0)


def random_network(
    seed=0, hidden=(8,), neighbors=0, max_trailers=10, chains=False, **fields
) -> Network:
    """Return a network that drives ahead, faster and slower, and steers to both sides.

    Its weights are those of single precision, as of networks that were trained.
    """
    rng, observation = np.random.default_rng(seed), Observation(neighbors, chains)
    columns = len(name_columns(observation, max_trailers))
    sizes = [columns, *hidden, 2]
    layers = [
        (rng.normal(0.0, inputs**-0.5, (outputs, inputs)), rng.normal(0.0, 0.3, outputs))
        for inputs, outputs in itertools.pairwise(sizes)
    ]
    layers[-1][1][0] += 0.5
    mean, scale = rng.uniform(-0.5, 0.5, columns), rng.uniform(0.5, 2.0, columns)
    sizes, weights = pack_layers([(m.astype(np.float32), b.astype(np.float32)) for m, b in layers])
    usual = {"limit": 2.0, "frame_skip": 5}
    return Network(
        sizes, weights, mean, scale, observation=observation, max_trailers=max_trailers,
        **usual | fields,
    )  # fmt: skip


def pursuing_network(neighbors=0, max_trailers=10, **fields) -> Network:
    """Return a network that follows the Dubins path to the goal at full speed.

    It has no hidden layer, and its outputs are clipped.
    """
    network = random_network(0, (), neighbors, max_trailers, **fields)
    columns = name_columns(network.observation, max_trailers)
    turn = np.array([name == "goal_path_turn" for name in columns], float)
    zeros = np.zeros(len(columns))
    sizes, weights = pack_layers([(np.stack([zeros, 9.0 * turn]), np.array([9.0, 0.0]))])
    return network._replace(sizes=sizes, weights=weights, mean=zeros, scale=zeros + 1.0, limit=10.0)


def doctor(path, **changes):
    """Write other arrays, or other entries of the layout, into a policy file."""
    with np.load(path) as kept:
        arrays = {name: kept[name] for name in kept.files}
    layout = json.loads(str(arrays["layout"]))
    for name, value in changes.items():
        if name in arrays:
            arrays[name] = np.array(value)
        else:
            layout[name] = value
    if "layout" not in changes:
        arrays["layout"] = np.array(json.dumps(layout))
    with open(path, "wb") as file:
        np.savez_compressed(file, **arrays)
