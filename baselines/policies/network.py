"""This module has the policy of trainings: a multilayer perceptron from columns to actions."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from baselines.policies.layers import normalize, propagate
from baselines.policies.network_checks import (
    check_network,
    count_columns,
    describe_observation,
    split_columns,
)
from baselines.policies.pooling import (
    Encoder,
    NoPooling,
    pool_neighbors,
    pooling_rows,
)
from hav_env.compiled import VECTOR, kernel
from hav_env.mdp.advance import to_command
from hav_env.models.quantities import Skipped, Trailers
from hav_env.observation import (
    CHAIN_ROWS,
    SCRATCH_ROWS,
    Observation,
    Scratch,
    check_observation,
    name_columns,
    observe,
    plan_route,
    settle,
)
from hav_env.policies.checks import check_parameters, check_rules
from hav_env.policies.demands import guidance_of
from hav_env.policies.interface import act_lanes, memory_size
from hav_env.vehicles import Lines, bodies_of, is_instant, needs_hitches
from hav_env.world.sensing import episode_key, limits

EVERY_COLUMN = np.zeros(0, np.int64)  # the inputs of a network that reads a whole row


class Network(NamedTuple):
    """A policy with layers of tanh units and a linear output layer.

    The policy normalizes the observation, (observation - mean) * scale, and clips it to ``limit``.
    It clips its two outputs to [-1, 1]; they are the actions of an environment.
    """

    sizes: np.ndarray
    """(L + 1,) int64: number of inputs, then the units of each layer; the last layer has 2."""
    weights: np.ndarray
    """float64: for each layer, its weights (outputs, inputs), then its biases."""
    mean: np.ndarray
    """(I,) float64, mean of each input."""
    scale: np.ndarray
    """(I,) float64, factor of each input."""
    limit: float
    frame_skip: Skipped
    """Number of steps that an action is held; steps of its multiples take new actions."""
    observation: Observation
    """Observation of the policy, settled: its number of neighbours is final."""
    max_trailers: Trailers
    """Largest number of trailers in the observation."""
    inputs: np.ndarray = EVERY_COLUMN
    """(I,) int64: columns of the observation in the order of the first layer; empty for all columns
    in their order."""
    hitched: bool = False
    """Whether the training had vehicles with off-axle hitching."""
    rectangles: bool = False
    """Whether the training had bodies with a width."""
    guidance: str = ""
    """Name of the guidance that the policy needs; without a name it accepts any."""
    pooling: Any = NoPooling()
    """``Encoder`` of the neighbours. With it ``mean``, ``scale`` and ``inputs`` are those of the
    HAV's own columns, and the pooled outputs follow them in the first layer."""


# The memory of a HAV holds its command [m/s, rad]. During a decision it also holds the scratch of
# its observation, the lanes that are due, and the inputs. Behind them are the columns of the
# observation. The layers later overwrite these columns with two alternating buffers.
_CHAIN = SCRATCH_ROWS
_PATH_LEFT, _HELD_SPEED, _HELD_STEERING, _DUE, _INPUTS = range(
    SCRATCH_ROWS + CHAIN_ROWS, SCRATCH_ROWS + CHAIN_ROWS + 5
)


def pack_layers(layers: list[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Return ``sizes`` and ``weights`` of layers (weights (outputs, inputs), biases (outputs,))."""
    sizes = [layers[0][0].shape[1], *(len(bias) for _, bias in layers)]
    packed = [np.ravel(array) for layer in layers for array in layer]
    return np.array(sizes, np.int64), np.concatenate(packed).astype(np.float64)


def unpack_layers(policy: Network) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return the weights (outputs, inputs) and the biases (outputs,) of each layer."""
    layers, first = [], 0
    for inputs, outputs in zip(policy.sizes[:-1], policy.sizes[1:], strict=True):
        biases = first + inputs * outputs
        weights = policy.weights[first:biases].reshape(outputs, inputs)
        layers.append((weights.copy(), policy.weights[biases : biases + outputs].copy()))
        first = biases + outputs
    return layers


def input_names(policy: Network) -> tuple[str, ...]:
    """Return the names of the columns that a network reads, in the order of its first layer."""
    names = _names_read(policy.observation, policy.max_trailers, policy.pooling)
    return tuple(names[k] for k in policy.inputs) if policy.inputs.size else names


def _names_read(observation: Observation, max_trailers: int, pooling: Any) -> tuple[str, ...]:
    """Return the names of the columns that the first layer of a network may read."""
    if isinstance(pooling, Encoder):
        return split_columns(observation, max_trailers)[0]
    return name_columns(observation, max_trailers)


def with_neighbors(policy: Network, neighbors: int) -> Network:
    """Return a network with an encoder that observes another number of neighbours.

    Raises:
        ValueError: If the network has no encoder, or there are too many columns.
    """
    if not isinstance(policy.pooling, Encoder):
        raise ValueError("policy pooling is NoPooling(), but must be an Encoder: train one")
    changed = policy._replace(observation=policy.observation._replace(neighbors=neighbors))
    check_observation(changed.observation)
    check_network(changed)
    return changed


def find_inputs(names: Sequence[str], columns: Sequence[str]) -> tuple[np.ndarray, list[str]]:
    """Find columns by their names.

    Args:
        names: Names of the columns that a network reads.
        columns: Names of the present columns.

    Returns:
        The inputs of the network; the names that no column has.
    """
    places = {name: k for k, name in enumerate(columns)}
    missing = [name for name in names if name not in places]
    if list(names) == list(places):
        return EVERY_COLUMN, missing
    return np.array([places.get(name, 0) for name in names], np.int64), missing


@memory_size.register
def _(policy: Network) -> int:
    columns = count_columns(policy.observation, policy.max_trailers) + pooling_rows(policy.pooling)
    return _INPUTS + int(policy.sizes[0]) + max(columns, 2 * int(max(policy.sizes[1:])))


@check_parameters.register
def _(policy: Network, scenario) -> None:
    seen = settle(policy.observation, scenario.num_havs), scenario.max_trailers
    if isinstance(policy.pooling, Encoder):  # absent neighbours have no effect
        seen = policy.observation, scenario.max_trailers
    if seen != (policy.observation, policy.max_trailers):
        raise ValueError(
            "the policy was trained to observe"
            f" {describe_observation(policy.observation, policy.max_trailers)},"
            f" but the scenario offers {describe_observation(*seen)}"
        )
    check_network(policy)


@guidance_of.register
def _(policy: Network) -> str:
    return policy.guidance


@check_rules.register
def _(policy: Network, scenario, task, vehicle) -> None:
    if not is_instant(vehicle) and not policy.observation.motion:
        raise ValueError(
            f"vehicle is {vehicle}, but the policy was trained for instant actuators: it does not"
            " observe its motion"
        )
    wide = not isinstance(bodies_of(vehicle), Lines)
    if needs_hitches(vehicle) > policy.hitched or wide > policy.rectangles:
        hitches = "anywhere" if policy.hitched else "on the axles"
        bodies = "rectangles" if policy.rectangles else "lines"
        raise ValueError(
            f"vehicle is {vehicle}, but the policy was trained for trailers that are hitched"
            f" {hitches} and bodies that are {bodies}"
        )


@act_lanes.register(Network)
def follow_network(policy, memory, world, agent, speed, steering):
    """Take an action in the lanes that are due, and hold the actions of the other lanes."""
    rows = memory[agent]
    due = _list_due(policy, rows, world, agent)
    if due > 0:
        scratch = Scratch(rows[:_CHAIN], rows[_CHAIN:])
        plan_route(world, agent, scratch, memory[:, _PATH_LEFT])
        inputs = rows[_INPUTS : _INPUTS + policy.sizes[0]]
        columns = rows[_INPUTS + policy.sizes[0] :]
        observe(policy.observation, world, agent, scratch, columns)
        padded = min((due + VECTOR - 1) // VECTOR * VECTOR, world.lanes)
        own = inputs[: policy.mean.size]
        _gather(policy, rows, columns, own, due, padded)
        normalize(policy, own, padded)
        pooled, neighbors = inputs[policy.mean.size :], policy.observation.neighbors
        pool_neighbors(policy.pooling, neighbors, rows[_DUE], due, columns, pooled, padded)
        actions = propagate(policy, rows[_INPUTS:], padded)
        for k in range(due):
            lane = int(rows[_DUE, k])
            speed_max, steering_max, _ = limits(world, agent, lane)
            rows[_HELD_SPEED, lane], rows[_HELD_STEERING, lane] = to_command(
                rows[_INPUTS + actions, k],
                rows[_INPUTS + actions + 1, k],
                speed_max,
                steering_max,
            )
    for lane in range(world.lanes):
        speed[agent, lane] = rows[_HELD_SPEED, lane]
        steering[agent, lane] = rows[_HELD_STEERING, lane]


@kernel
def _list_due(policy, rows, world, agent):
    """List the lanes that are due for an action; return their number."""
    due = 0
    for lane in range(world.lanes):
        _, _, step = episode_key(world, lane)
        if step % policy.frame_skip == 0 and not world.state.waiting[agent, lane]:
            rows[_DUE, due] = lane
            due += 1
    return due


@kernel
def _gather(policy, rows, columns, inputs, due, padded):
    """Copy the inputs of the lanes that are due to the first lanes; pad with zeros."""
    for number in range(inputs.shape[0]):
        column = policy.inputs[number] if policy.inputs.size > 0 else number
        for k in range(due):
            inputs[number, k] = columns[column, int(rows[_DUE, k])]
        for k in range(due, padded):
            inputs[number, k] = 0.0
