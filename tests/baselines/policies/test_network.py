"""A network acts as the one that was trained: the same outputs, or none."""

import itertools

import numpy as np
import pytest
import torch

from baselines.policies.network import pack_layers
from hav_env import (
    Batch,
    Limited,
    Observation,
    OffAxle,
    OnAxle,
    RandomFleet,
    RandomPoses,
    Rectangles,
    Task,
)
from hav_env.envs.stable_baselines3 import HAVVecEnv
from hav_env.evaluation.rollout import rollout
from hav_env.mdp.advance import to_command
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.observation import name_columns
from hav_env.policies.checks import check_policy
from hav_env.policies.driver import PolicyDriver
from hav_env.policies.interface import allocate_memory, decide
from hav_env.world.arrays import SPEED, STEERING
from tests.support.budgets import budget
from tests.support.networks import actions_of, forward, random_network
from train.export import network_of

SHAPES = [(), (1,), (3,), (4,), (7,), (16,), (5, 9), (64, 64), (13, 6, 10), (2, 3, 4, 5)]


def torch_layers(inputs, hidden, seed):
    """Return linear layers of PyTorch with weights that make units saturate here and there."""
    sizes = [inputs, *hidden, 2]
    generator = torch.Generator().manual_seed(seed)
    layers = [torch.nn.Linear(*pair) for pair in itertools.pairwise(sizes)]
    with torch.no_grad():
        for parameter in (p for layer in layers for p in layer.parameters()):
            parameter.copy_(0.5 * torch.randn(parameter.shape, generator=generator))
    return layers


def by_torch(layers, values):
    """Return PyTorch's outputs for rows (W, D), in the precision of its layers."""
    values = torch.as_tensor(values, dtype=torch.float32)
    with torch.no_grad():
        for layer in layers[:-1]:
            values = torch.tanh(layer(values))
        return layers[-1](values).numpy().astype(float)


# outputs


@pytest.mark.parametrize("hidden", SHAPES, ids=str)
@pytest.mark.parametrize(("neighbors", "max_trailers"), [(0, 1), (0, 2), (1, 3), (2, 10)])
def test_the_layers_are_those_of_torch(hidden, neighbors, max_trailers):
    """Numbers of columns, 25 to 76, are multiples of four and others, as are those of units."""
    scenario = RandomPoses(neighbors + 1, fleet=RandomFleet(max_trailers=max_trailers))
    process = DecisionProcess(1, scenario=scenario)
    rng, columns = np.random.default_rng(0), len(process.columns)
    layers = torch_layers(columns, hidden, sum(hidden) + columns)
    mean, variance = rng.normal(size=columns), rng.uniform(0.1, 4.0, columns)
    network = network_of(layers, process, mean, variance, 3.0)
    rows = rng.normal(0.0, 3.0, (budget(37, 9), columns))
    normalized = np.clip((rows - mean) / np.sqrt(variance), -3.0, 3.0)
    assert forward(network, rows) == pytest.approx(by_torch(layers, normalized), abs=1e-5)
    exact = np.clip(forward(network, rows), -1.0, 1.0)
    assert exact == pytest.approx(actions_of(network, rows), abs=1e-12)


@pytest.mark.parametrize("lanes", [1, 2, 7, 8, 9, 16, 33])
def test_a_row_is_worked_out_alike_alone_and_among_others(lanes):
    network = random_network(1, (5, 6))
    rows = np.random.default_rng(lanes).normal(size=(lanes, network.sizes[0]))
    alone = np.concatenate([forward(network, rows[k : k + 1]) for k in range(lanes)])
    assert forward(network, rows).tobytes() == alone.tobytes()


def test_units_saturate_without_an_overflow():
    network = random_network(2, (6, 6), limit=1e9)
    network = network._replace(weights=1e6 * network.weights)
    rows = 1e6 * np.random.default_rng(0).normal(size=(20, network.sizes[0]))
    with np.errstate(over="raise", invalid="raise"):
        found = forward(network, rows)
    assert np.isfinite(found).all()
    assert np.clip(found, -1.0, 1.0) == pytest.approx(actions_of(network, rows), abs=1e-9)


def test_without_a_normalizer_rows_are_taken_as_they_are():
    process = DecisionProcess(1, scenario="paper-single")
    layers = torch_layers(len(process.columns), (8,), 0)
    rows = 100.0 * np.random.default_rng(0).normal(size=(10, len(process.columns)))
    outputs = forward(network_of(layers, process), rows)
    assert outputs == pytest.approx(by_torch(layers, rows), rel=1e-4, abs=1e-4)


@pytest.mark.parametrize("scenario", ["paper-single", "paper-pair", "crossing-8"])
@pytest.mark.parametrize("worlds", [1, 13])
def test_what_a_row_of_the_environment_leads_to_is_decided_in_its_world(scenario, worlds):
    env = HAVVecEnv(worlds, scenario=scenario)
    batch, columns = env.process.batch, len(env.process.columns)
    rng, layers = np.random.default_rng(0), torch_layers(columns, (16, 16), 5)
    mean, variance = rng.uniform(-1, 1, columns), rng.uniform(0.1, 1.0, columns)
    policy = network_of(layers, env.process, mean, variance, 10.0)
    env.seed(3)
    rows = env.reset()
    limit = batch.worlds.fleet.limit
    for _ in range(budget(60, 3)):
        actions = np.clip(by_torch(layers, (rows - mean) / np.sqrt(variance)), -1.0, 1.0)
        shares = actions.reshape(worlds, -1, 2).transpose(2, 1, 0)
        memory = allocate_memory(policy, env.process.num_havs, worlds)
        speed, steering = decide(policy, memory, batch)
        assert not batch.worlds.state.waiting.any()
        assert speed == pytest.approx(0.5 * (1.0 + shares[0]) * limit[:, SPEED], abs=2e-5)
        assert steering == pytest.approx(shares[1] * limit[:, STEERING], abs=2e-5)
        rows, *_ = env.step(rng.uniform(-1, 1, (env.num_envs, 2)))


@pytest.mark.parametrize(
    ("faster", "turned", "speed", "steering"),
    [
        (-1.0, 0.0, 0.0, 0.0),
        (0.0, 1.0, 1.5, 0.8),
        (1.0, -1.0, 3.0, -0.8),
        (0.5, 0.5, 2.25, 0.4),
        (7.0, -9.0, 3.0, -0.8),
        (-1e300, 1e300, 0.0, 0.8),
    ],
)
def test_actions_are_shares_of_the_limits_and_cut(faster, turned, speed, steering):
    assert to_command(faster, turned, 3.0, 0.8) == pytest.approx((speed, steering), abs=1e-15)


# invalid networks


def sizes(*numbers):
    return np.array(numbers, np.int64)


PAIR, SINGLE = RandomPoses(2), RandomPoses()
COLUMNS = 52  # of a HAV with up to ten trailers that observes no neighbour


@pytest.mark.parametrize(
    ("policy", "scenario", "message"),
    [
        (random_network(neighbors=1), SINGLE, "observe 1 neighbors .* the scenario offers 0 neigh"),
        (random_network(neighbors=3), PAIR, "observe 3 neighbors .* the scenario offers 1 neigh"),
        (
            random_network(neighbors=4),
            RandomPoses(4),
            "observe 4 neighbors .* the scenario offers 3 neighbors",
        ),
        (
            random_network(max_trailers=3),
            SINGLE,
            "up to 3 trailers, but the scenario offers 0 neighbors and up to 10 trailers",
        ),
        (random_network(frame_skip=0), SINGLE, "frame_skip is 0"),
        (random_network(limit=np.inf), SINGLE, "limit is inf"),
        (random_network()._replace(mean=np.zeros(3)), SINGLE, "does not fit"),
        (random_network()._replace(scale=np.zeros(0)), SINGLE, "does not fit"),
        (random_network()._replace(weights=np.zeros(7)), SINGLE, "does not fit"),
        (random_network()._replace(mean=np.full(COLUMNS, np.nan)), SINGLE, "mean is .*finite"),
        (random_network()._replace(sizes=sizes(COLUMNS, 7, 2)), SINGLE, "does not fit"),
        (random_network()._replace(sizes=sizes(COLUMNS)), SINGLE, "does not fit"),
        (random_network()._replace(sizes=sizes()), SINGLE, "does not fit"),
        (random_network()._replace(sizes=sizes([COLUMNS, 8, 2])), SINGLE, "does not fit"),
        (
            random_network()._replace(sizes=sizes(COLUMNS, 0, 2), weights=np.zeros(2)),
            SINGLE,
            "does not fit",
        ),
    ],
)
def test_a_network_that_does_not_fit_is_named(policy, scenario, message):
    for refuse in (check_policy, lambda *args: rollout(*args, 0, np.zeros(1, int))):
        with pytest.raises(ValueError, match=f"(?s)policy.*{message}"):
            refuse(policy, scenario)
    with pytest.raises(ValueError, match=f"(?s){message}"):
        PolicyDriver(policy, Batch(scenario))


def test_chains_that_are_not_observed_are_named():
    policy = random_network(neighbors=1)._replace(observation=Observation(1, chains=True))
    with pytest.raises(ValueError, match="does not fit"):
        check_policy(policy, PAIR)
    with pytest.raises(ValueError, match=r"observe 1 neighbors with chains .* offers 0 neighbors"):
        check_policy(policy, SINGLE)


@pytest.mark.parametrize(
    ("vehicle", "asked"),
    [
        (OffAxle(), {"hitched"}),
        (OnAxle(bodies=Rectangles()), {"rectangles"}),
        (OffAxle(bodies=Rectangles()), {"hitched", "rectangles"}),
    ],
)
def test_a_network_drives_what_it_was_trained_on_and_less(vehicle, asked):
    for flags in ([], ["hitched"], ["rectangles"], ["hitched", "rectangles"]):
        policy = random_network()._replace(**dict.fromkeys(flags, True))
        check_policy(policy, SINGLE, vehicle=OnAxle())
        if asked <= set(flags):
            check_policy(policy, SINGLE, vehicle=vehicle)
        else:
            with pytest.raises(ValueError, match=r"vehicle is O.*, but the policy was trained for"):
                check_policy(policy, SINGLE, vehicle=vehicle)


@pytest.mark.parametrize("vehicle", [OnAxle(), OffAxle(), OffAxle(bodies=Rectangles())])
def test_what_is_exported_says_what_it_was_trained_on(vehicle):
    process = DecisionProcess(scenario=SINGLE, vehicle=vehicle)
    layer = torch.nn.Linear(len(process.columns), 2)
    policy = network_of([layer], process)
    check_policy(policy, SINGLE, vehicle=vehicle)
    assert policy.hitched == (vehicle != OnAxle())
    assert policy.rectangles == (vehicle == OffAxle(bodies=Rectangles()))


@pytest.mark.exhaustive
def test_a_network_that_does_not_observe_its_motion_drives_instant_trucks_alone():
    policy, limited = random_network(), OnAxle(actuators=Limited())
    check_policy(policy, SINGLE, vehicle=OnAxle())
    with pytest.raises(ValueError, match="but the policy was trained for instant actuators"):
        check_policy(policy, SINGLE, vehicle=limited)
    seen = Observation(0, motion=True)
    columns = len(name_columns(seen, SINGLE.max_trailers))
    layers = [(np.full((2, columns), 0.01), np.zeros(2))]
    sizes, weights = pack_layers(layers)
    aware = policy._replace(
        observation=seen,
        sizes=sizes,
        weights=weights,
        mean=np.zeros(columns),
        scale=np.ones(columns),
    )
    table = rollout(aware, SINGLE, 0, np.arange(2), Task(max_steps=budget(200, 5)), limited)
    assert min(table["path_length"].to_pylist()) > 0.0
