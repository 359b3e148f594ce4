"""This module initializes the layers of learners with a start: a route, or a trained policy."""

import numpy as np
import torch

from baselines.policies.network import Network, input_names, unpack_layers
from baselines.policies.network_checks import split_columns
from baselines.policies.pooling import Encoder
from baselines.policies.shipped import find_trained
from hav_env.mdp.decision_process import DecisionProcess
from train.loops.moments import Normalizer
from train.loops.networks import Actor, linear_layers

ALONG_ROUTE = "route"  # a start without a policy
TRUSTED = 1e6  # count of observations of a normalizer that should change slowly
_SPEED_OUTPUT, _STEERING_OUTPUT = range(2)
_LINEAR = 0.15  # scale of a column that tanh passes on almost linearly
_QUIETER = 0.5  # multiplier of the noise of steering
LEAST_AT_START = 1e-2  # variance of a column that is constant at the start of episodes


def steer_along_route(layers: list[torch.nn.Linear], place: int, speed: float) -> None:
    """Initialize layers with weights that drive at one speed and steer along the route.

    One unit of each hidden layer passes on a column. The other units keep their weights.

    Args:
        layers: All layers from the columns to both actions.
        place: Number of the column ``goal_path_steering``.
        speed: Share of the full speed, from 0 to 1.
    """
    with torch.no_grad():
        for number, layer in enumerate(layers[:-1]):
            layer.weight[0] = 0.0
            layer.weight[0, 0 if number else place] = 1.0 if number else _LINEAR
            layer.bias[0] = 0.0
        layers[-1].weight[:, 0] = 0.0
        layers[-1].weight[_STEERING_OUTPUT, 0] = 1.0 / _LINEAR
        layers[-1].bias[_SPEED_OUTPUT] = 2.0 * speed - 1.0


def copy_layers(
    layers: list[torch.nn.Linear],
    theirs: list[tuple[np.ndarray, np.ndarray]],
    places: list[int],
) -> None:
    """Copy the layers of a policy; inputs that it does not read get weights of 0.

    Args:
        layers: Layers to write.
        theirs: Weights (outputs, inputs) and biases (outputs,) of each layer of the policy.
        places: Number of the input of ``layers`` for each input of the policy.

    Raises:
        ValueError: If the layers have other units.
    """
    wanted, found = [m.out_features for m in layers], [len(bias) for _, bias in theirs]
    if wanted != found:
        raise ValueError(f"the policy to begin with has layers {found}, but must have {wanted}")
    with torch.no_grad():
        for number, (layer, (weights, biases)) in enumerate(zip(layers, theirs, strict=True)):
            if number == 0:
                layer.weight.zero_()
                layer.weight[:, places] = torch.from_numpy(weights).float()
            else:
                layer.weight.copy_(torch.from_numpy(weights))
            layer.bias.copy_(torch.from_numpy(biases))


def begin_anew_with_speed(output: torch.nn.Linear) -> None:
    """Reset the output for speed to full speed.

    A lone HAV always drives at full speed, so the output for speed is far above 1, where it is
    clipped: noise of any size would have no effect there.
    """
    with torch.no_grad():
        output.weight[_SPEED_OUTPUT] = 0.0
        output.bias[_SPEED_OUTPUT] = 1.0


def quieten_steering(log_deviation: torch.Tensor) -> None:
    """Reduce the noise of steering (..., 2): the policy can steer already."""
    with torch.no_grad():
        log_deviation[..., _STEERING_OUTPUT] += np.log(_QUIETER)


def start_actor(name: str, actor: Actor, seen: Normalizer, process: DecisionProcess) -> None:
    """Initialize an actor and its normalizer with a start; the critic keeps its random weights.

    A policy that observes neighbours keeps its output for speed.

    Args:
        name: ``route``, or a trained policy by its name or file.
        actor: Actor to initialize.
        seen: Normalizer, which has seen the beginnings of episodes.
        process: Decision process of the training.

    Raises:
        ValueError: If there is no such policy, its layers differ, or it observes columns that the
            actor does not.
    """
    layers = [*linear_layers(actor.body.hidden), actor.output]
    quieten_steering(actor.log_deviation)
    for moments in (seen.own, seen.each):
        moments.variance = np.maximum(moments.variance, LEAST_AT_START)
        moments.count = TRUSTED
    if name == ALONG_ROUTE:
        place = process.columns.index("goal_path_steering")
        steer_along_route(layers, place, 1.0)
        seen.own.mean[place], seen.own.variance[place] = 0.0, 1.0
        return
    policy = find_trained(name, "begin_with", (ALONG_ROUTE,))
    pool, most = actor.body.pool, process.batch.scenario.max_trailers
    own, each = split_columns(process.observation, most)
    places = _places_of(input_names(policy), own if pool else process.columns)
    inputs = list(places)
    if isinstance(policy.pooling, Encoder):
        if pool is None:
            rule = "choose --network pooled, and observe at least one"
            raise ValueError(f"the policy to begin with pools neighbours: {rule}")
        of_each = _places_of(_encoder_names(policy), each)
        encoder = policy.pooling._asdict()
        theirs = unpack_layers(policy._replace(**{k: encoder[k] for k in ("sizes", "weights")}))
        copy_layers(linear_layers(pool.encoder), theirs, of_each)
        seen.each.mean[of_each] = encoder["mean"]
        seen.each.variance[of_each] = encoder["scale"] ** -2.0
        inputs += range(len(own), pool.outputs)
    copy_layers(layers, unpack_layers(policy), inputs)
    seen.own.mean[places], seen.own.variance[places] = policy.mean, policy.scale**-2.0
    if policy.observation.neighbors == 0:
        begin_anew_with_speed(actor.output)


def _encoder_names(policy: Network) -> list[str]:
    names = split_columns(policy.observation, policy.max_trailers)[1]
    return [names[k] for k in policy.pooling.inputs]


def _places_of(theirs: tuple[str, ...] | list[str], ours: tuple[str, ...]) -> list[int]:
    missing = sorted(set(theirs) - set(ours))
    if missing:
        raise ValueError(f"the policy to begin with observes {missing[0]}, which is not observed")
    return [ours.index(name) for name in theirs]
