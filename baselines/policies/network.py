"""This module is a trained policy: a multilayer perceptron from observations to actions."""

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from baselines.policies.layers import normalize, propagate
from hav_env.compiled import VECTOR, kernel
from hav_env.mdp.advance import to_command
from hav_env.models.quantities import Skipped, Trailers
from hav_env.observation import (
    CHAIN_ROWS,
    SCRATCH_ROWS,
    Observation,
    Scratch,
    name_columns,
    observe,
    plan_route,
    settle,
)
from hav_env.policies.interface import act_lanes, check_parameters, check_rules, memory_size
from hav_env.vehicles import Lines, bodies_of, is_instant, needs_hitches
from hav_env.world.sensing import episode_key, limits

MOST_LAYERS, WIDEST_LAYER, MOST_WEIGHTS = 32, 8_192, 1 << 22
MOST_OBSERVED_TRAILERS, MOST_COLUMNS = 1_000, 1 << 14
LARGEST_WEIGHT = 1e12  # so that no sum of products overflows, and no action is NaN
EVERY_COLUMN = np.zeros(0, np.int64)  # the inputs of a network that reads a whole row


class Network(NamedTuple):
    """Layers of tanh units and a linear one on top; what is written by training, and read here.

    The observation is normalized, (observation - mean) * scale, and cut to ``limit``; the two
    outputs are cut to [-1, 1] and mean what an environment's actions mean.
    """

    sizes: np.ndarray
    """(L + 1,) int64: the number of inputs, units of each layer; the last are 2."""
    weights: np.ndarray
    """float64, of one layer after the other: its weights (outputs, inputs), then its biases."""
    mean: np.ndarray
    """(I,) float64, of the inputs."""
    scale: np.ndarray
    """(I,) float64."""
    limit: float
    frame_skip: Skipped
    """For how many steps an action is held; new ones are taken at its multiples."""
    observation: Observation
    """The observation it reads; settled, so that it tells the number of neighbours."""
    max_trailers: Trailers
    """Largest number of trailers in the observation."""
    inputs: np.ndarray = EVERY_COLUMN
    """(I,) int64: which columns of the observation are read, in the order of the first layer; with
    none, all columns are read in their order."""
    hitched: bool = False
    """Whether it was trained on vehicles whose trailers may be hitched off the axles."""
    rectangles: bool = False
    """Whether it was trained on bodies with a width."""


# A HAV remembers its command [m/s, rad]. While it decides, it also holds what is worked out of its
# observation, the lanes in which to decide, and the inputs. Behind them stand the columns of the
# observation, and once these have been read, two areas for the layers by turns.
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
    names = name_columns(policy.observation, policy.max_trailers)
    return tuple(names[k] for k in policy.inputs) if policy.inputs.size else names


def find_inputs(
    names: Sequence[str], observation: Observation, max_trailers: int
) -> tuple[np.ndarray, list[str]]:
    """Find columns by their names.

    Args:
        names: of the columns that a network reads.
        observation: observation of now; settled.
        max_trailers: of the observation.

    Returns:
        The inputs of the network; the names that no column has.
    """
    places = {name: k for k, name in enumerate(name_columns(observation, max_trailers))}
    missing = [name for name in names if name not in places]
    if list(names) == list(places):
        return EVERY_COLUMN, missing
    return np.array([places.get(name, 0) for name in names], np.int64), missing


@memory_size.register
def _(policy: Network) -> int:
    columns = count_columns(policy.observation, policy.max_trailers)
    return _INPUTS + int(policy.sizes[0]) + max(columns, 2 * int(max(policy.sizes[1:])))


@check_parameters.register
def _(policy: Network, scenario) -> None:
    seen = settle(policy.observation, scenario.num_havs), scenario.max_trailers
    if seen != (policy.observation, policy.max_trailers):
        raise ValueError(
            f"the policy was trained to observe {_say(policy.observation, policy.max_trailers)},"
            f" but the scenario offers {_say(*seen)}"
        )
    check_network(policy)


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


def check_network(policy: Network) -> None:
    """Check a network by itself, whatever the scenario, before memory is allocated for it.

    Compiled code reads and writes its layers without looking at the ends of arrays.

    Raises:
        ValueError: naming the field, its value and what is allowed.
    """
    columns = _count_inputs(policy)
    shape = policy.sizes.shape
    if len(shape) != 1 or not 2 <= shape[0] <= MOST_LAYERS + 1 or policy.sizes.dtype.kind != "i":
        raise ValueError(
            f"policy sizes is {policy.sizes.dtype} of shape {shape}, which does not fit any layers:"
            f" it must be whole numbers of 1 to {MOST_LAYERS} layers"
        )
    sizes: list[int] = policy.sizes.tolist()  # Python's numbers do not overflow
    if min(sizes) < 1 or max(sizes[1:]) > WIDEST_LAYER or (sizes[0], sizes[-1]) != (columns, 2):
        raise ValueError(
            f"policy sizes is {sizes}, which does not fit: it must lead from {columns} columns to 2"
            f" outputs, with 1 to {WIDEST_LAYER} units in between"
        )
    weights = sum((inputs + 1) * outputs for inputs, outputs in itertools.pairwise(sizes))
    if weights > MOST_WEIGHTS:
        raise ValueError(f"policy sizes is {sizes}, but must be of at most {MOST_WEIGHTS} weights")
    for name, length in (("weights", weights), ("mean", columns), ("scale", columns)):
        array = getattr(policy, name)
        if array.shape != (length,) or array.dtype.kind != "f":
            found = f"{array.dtype} of shape {array.shape}"
            rule = f"it must be real numbers ({length},)"
            raise ValueError(f"policy {name} is {found}, which does not fit: {rule}")
        large = ~(np.abs(array) <= LARGEST_WEIGHT)  # so is NaN
        if large.any():
            rule = f"but must hold numbers from -{LARGEST_WEIGHT:g} to {LARGEST_WEIGHT:g}"
            raise ValueError(f"policy {name} holds {array[large][0]:g}, {rule}")
    if not 0.0 < policy.limit < np.inf:
        raise ValueError(f"policy limit is {policy.limit}, but must be finite and above 0")


def _count_inputs(policy: Network) -> int:
    """Return how many columns a network reads.

    Raises:
        ValueError: when it reads columns that are none.
    """
    columns, inputs = count_columns(policy.observation, policy.max_trailers), policy.inputs
    if inputs.ndim != 1 or inputs.dtype != np.int64 or inputs.size > MOST_COLUMNS:
        found = f"{inputs.dtype} of shape {inputs.shape}"
        rule = f"must be at most {MOST_COLUMNS} places of columns, int64"
        raise ValueError(f"policy inputs is {found}, but {rule}")
    outside = inputs[(inputs < 0) | (inputs >= columns)]
    if outside.size:
        raise ValueError(f"policy inputs holds {outside[0]}, but must be from 0 to {columns - 1}")
    return inputs.size or columns


def count_columns(observation: Observation, max_trailers: int) -> int:
    """Return how many columns an observation has, before their names are made.

    Raises:
        ValueError: when there are more than any policy may have.
    """
    if not 0 <= max_trailers <= MOST_OBSERVED_TRAILERS:
        rule = f"but must be from 0 to {MOST_OBSERVED_TRAILERS}"
        raise ValueError(f"policy max_trailers is {max_trailers}, {rule}")
    none, one = (len(name_columns(observation._replace(neighbors=k), max_trailers)) for k in (0, 1))
    columns = none + max(observation.neighbors, 0) * (one - none)
    if columns > MOST_COLUMNS:
        raise ValueError(
            f"policy observation is of {observation.neighbors} neighbors, {columns} columns,"
            f" but must be of at most {MOST_COLUMNS} columns"
        )
    return columns


_WHAT = "chains", "fronts", "motion"


def _say(observation: Observation, max_trailers: int) -> str:
    more = "".join(f" with {what}" for what in _WHAT if getattr(observation, what))
    return f"{observation.neighbors} neighbors{more} and up to {max_trailers} trailers"


@act_lanes.register(Network)
def follow_network(policy, memory, world, agent, speed, steering):
    """Take an action in the lanes where one is due, and hold those of the others."""
    rows = memory[agent]
    due = _list_due(policy, rows, world, agent)
    if due > 0:
        scratch = Scratch(rows[:_CHAIN], rows[_CHAIN:])
        plan_route(world, agent, scratch, memory[:, _PATH_LEFT])
        inputs = rows[_INPUTS : _INPUTS + policy.sizes[0]]
        columns = rows[_INPUTS + policy.sizes[0] :]
        observe(policy.observation, world, agent, scratch, columns)
        padded = min((due + VECTOR - 1) // VECTOR * VECTOR, world.lanes)
        _gather(policy, rows, columns, inputs, due, padded)
        normalize(policy, inputs, padded)
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
    """List the lanes in which an action is to be taken; return how many there are."""
    due = 0
    for lane in range(world.lanes):
        _, _, step = episode_key(world, lane)
        if step % policy.frame_skip == 0 and not world.state.waiting[agent, lane]:
            rows[_DUE, due] = lane
            due += 1
    return due


@kernel
def _gather(policy, rows, columns, inputs, due, padded):
    """Move what is read in the lanes that are due to the first ones; fill up with zeros."""
    for number in range(inputs.shape[0]):
        column = policy.inputs[number] if policy.inputs.size > 0 else number
        for k in range(due):
            inputs[number, k] = columns[column, int(rows[_DUE, k])]
        for k in range(due, padded):
            inputs[number, k] = 0.0
