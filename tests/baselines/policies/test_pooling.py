"""Pooled neighbours: the compiled network is PyTorch's, for any number and order of neighbours."""

import numpy as np
import pytest
import torch

from baselines.policies.files import load_policy, save_policy
from baselines.policies.network import check_network, with_neighbors
from baselines.policies.pooling import pool_neighbors
from hav_env import Observation, RandomPoses
from hav_env.compiled import entry, lanes_from
from hav_env.envs.stable_baselines3 import HAVVecEnv
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.policies.checks import check_policy
from hav_env.policies.interface import allocate_memory, decide
from hav_env.world.arrays import SPEED, STEERING
from tests.support.networks import doctor, random_network
from train.export import network_of
from train.loops.networks import Body, Row, linear_layers

FOUR = Observation(neighbors=4, fronts=True)


@entry
def pool_worlds(first, last, pooling, neighbors, chosen, due, columns, pooled):
    """Pool the neighbours of a range of rows, which the columns of lanes hold."""
    lanes = last - first
    own = lanes_from(columns, first), lanes_from(pooled, first)
    pool_neighbors(pooling, neighbors, chosen[:lanes], due, *own, lanes)


def trained(neighbors=4, seed=0):
    """Return a body with an output layer, its normalizer and its process, all random."""
    torch.manual_seed(seed)
    process = DecisionProcess(
        1, scenario=RandomPoses(neighbors + 1), observation=FOUR._replace(neighbors=neighbors)
    )
    own = len(process.columns) - len([n for n in process.columns if n.startswith("neighbor_")])
    row = Row(own, neighbors, (len(process.columns) - own) // neighbors)
    body = Body("pooled", row, (12, 7), (16, 9))
    output = torch.nn.Linear(9, 2)
    rng = np.random.default_rng(seed)
    of_one = rng.normal(0.0, 0.3, row.each), rng.uniform(0.3, 2.0, row.each)
    of_one[0][0], of_one[1][0] = 0.0, 1.0
    mean, variance = (
        np.concatenate([of_own, np.tile(one, neighbors)])
        for of_own, one in zip(
            (rng.normal(0.0, 0.3, own), rng.uniform(0.3, 2.0, own)), of_one, strict=True
        )
    )
    return body, output, mean, variance, process


def by_torch(body, output, mean, variance, rows):
    """Return PyTorch's outputs for rows (B, D) of any number of neighbours."""
    more = (rows.shape[1] - len(mean)) // body.pool.row.each
    one = slice(body.pool.row.own, body.pool.row.own + body.pool.row.each)
    if more >= 0:
        mean, variance = (np.concatenate([n, np.tile(n[one], more)]) for n in (mean, variance))
    mean, variance = mean[: rows.shape[1]], variance[: rows.shape[1]]
    values = np.clip((rows - mean) / np.sqrt(variance), -10.0, 10.0)
    with torch.no_grad():
        return output(body(torch.from_numpy(values).float())).numpy().astype(float)


def exported(body, output, mean, variance, process):
    layers = [*linear_layers(body.hidden), output]
    encoder = linear_layers(body.pool.encoder)
    return network_of(layers, process, mean, variance, 10.0, encoder)


def random_rows(row, neighbors, count, seed=0):
    """Return rows in which any of the neighbours are absent, in any places."""
    rng = np.random.default_rng(seed)
    own, others = rng.normal(size=(count, row.own)), rng.normal(size=(count, neighbors, row.each))
    others[..., 0] = rng.random((count, neighbors)) < 0.6
    others[others[..., 0] == 0.0] = 0.0
    return np.concatenate([own, others.reshape(count, -1)], axis=1)


def pooled_by_lanes(policy, rows, order=None, due=None):
    """Return the pooled outputs (B, 2 E) for rows of observations, as compiled code has them.

    Only the first ``due`` rows of an order are read, and their outputs are the first ones; all rows
    in their own order by default.
    """
    scratch = 100
    columns = np.concatenate([rows.T, np.full((scratch, len(rows)), np.nan)])
    pooled = np.full((2 * policy.pooling.sizes[-1], len(rows)), np.nan)
    lanes = np.arange(len(rows), dtype=float) if order is None else order.astype(float)
    due, neighbors = len(rows) if due is None else due, policy.observation.neighbors
    args = policy.pooling, neighbors, lanes, due, columns, pooled
    pool_worlds(len(rows), *args, threads=1)
    return pooled.T


@pytest.mark.parametrize("neighbors", [1, 4, 7])
def test_pooled_outputs_are_those_of_torch_in_any_order_and_number(neighbors):
    body, output, mean, variance, process = trained()
    policy = with_neighbors(exported(body, output, mean, variance, process), neighbors)
    row = body.pool.row
    rows = random_rows(row, neighbors, 37)
    one = slice(row.own, row.own + row.each)
    values = (rows[:, row.own :].reshape(37, neighbors, row.each) - mean[one]) / np.sqrt(
        variance[one]
    )
    normalized = np.concatenate([rows[:, : row.own], values.clip(-10, 10).reshape(37, -1)], axis=1)
    with torch.no_grad():
        expected = body.pool(torch.from_numpy(normalized).float())[:, row.own :].numpy()
    found = pooled_by_lanes(policy, rows)
    assert found == pytest.approx(expected, abs=1e-5)
    assert (found[rows[:, row.own :: row.each].sum(1) == 0.0] == 0.0).all()
    order = np.random.default_rng(1).permutation(neighbors)
    others = rows[:, row.own :].reshape(37, neighbors, row.each)
    shuffled = np.concatenate([rows[:, : row.own], others[:, order].reshape(37, -1)], axis=1)
    assert pooled_by_lanes(policy, shuffled) == pytest.approx(found, abs=1e-12)
    absent = np.concatenate([rows, np.zeros((37, 3 * row.each))], axis=1)
    more = with_neighbors(policy, neighbors + 3)
    assert pooled_by_lanes(more, absent).tobytes() == found.tobytes()
    order = np.random.default_rng(2).permutation(37)
    for due in (37, 19):  # the HAVs of the other rows wait, and nothing of them is read
        given = rows.copy()
        given[order[due:]] = np.nan
        part = pooled_by_lanes(policy, given, order, due)
        assert part[:due] == pytest.approx(found[order[:due]], abs=1e-12)
        assert (part[due:] == 0.0).all()


def test_a_file_of_four_neighbours_drives_any_number_of_havs_as_torch_does(tmp_path):
    body, output, mean, variance, process = trained()
    path = tmp_path / "pooled.policy"
    save_policy(exported(body, output, mean, variance, process), path, {})
    kept = load_policy(path)
    for havs, neighbors in ((1, 4), (2, 4), (5, 4), (5, 2), (9, 7)):
        scenario = RandomPoses(havs)
        env = HAVVecEnv(3, scenario=scenario, observation=FOUR._replace(neighbors=neighbors))
        env.seed(havs)
        rows = env.reset()
        policy = with_neighbors(kept, neighbors)
        check_policy(policy, scenario)
        speed, steering = decide(policy, allocate_memory(policy, havs, 3), env.process.batch)
        if havs == 1:  # a lone HAV observes none, which is to have the same effect as an absent one
            rows = np.pad(rows, ((0, 0), (0, body.pool.row.each)))
        actions = np.clip(by_torch(body, output, mean, variance, rows), -1.0, 1.0)
        shares = actions.reshape(3, havs, 2).transpose(2, 1, 0)
        limit = env.process.batch.worlds.fleet.limit
        assert speed == pytest.approx(0.5 * (1.0 + shares[0]) * limit[:, SPEED], abs=1e-5)
        assert steering == pytest.approx(shares[1] * limit[:, STEERING], abs=1e-5)


def test_encoders_that_do_not_fit_are_named(tmp_path):
    policy = exported(*trained())
    pooling = policy.pooling
    for wrong, message in (
        (pooling._replace(first=3), "pooling reads columns"),
        (pooling._replace(sizes=np.array([5, 3])), "pooling sizes"),
        (pooling._replace(weights=pooling.weights[1:]), "pooling weights"),
        (pooling._replace(mean=np.full(pooling.each, np.nan)), "pooling mean"),
        (pooling._replace(inputs=pooling.inputs + 1), "pooling inputs"),
        (pooling._replace(limit=3.0), "pooling limit"),
    ):
        with pytest.raises(ValueError, match=message):
            check_network(policy._replace(pooling=wrong))
    with pytest.raises(ValueError, match="must be an Encoder"):
        with_neighbors(random_network(neighbors=1), 3)
    path = tmp_path / "one.policy"
    save_policy(policy, path, {})
    for told in (3, {"columns": ["present"]}, {"columns": ["nothing"] * 2}):
        doctor(path, encoder=told)
        with pytest.raises(ValueError, match="no policy file, or a broken one"):
            load_policy(path)
