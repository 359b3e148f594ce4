"""The table matches the records; mistakes of callers are errors that name them."""

import math
from typing import NamedTuple

import numpy as np
import pytest

from baselines.policies.avoid_jack import AvoidJack
from baselines.policies.dubins_pursuit import DubinsPursuit
from baselines.policies.random import Random
from hav_env import Batch, OffAxle, PlacementError, RandomPoses, Rectangles
from hav_env.evaluation.episode_table import tabulate
from hav_env.evaluation.rollout import rollout
from hav_env.policies.checks import check_policy
from hav_env.policies.interface import allocate_memory, memory_size
from hav_env.world import arrays as columns
from hav_env.world.arrays import allocate_worlds
from tests.support.worlds import catalogue_like

LENGTHS = {  # by world and HAV
    (0, 0): [4.0, 6.0, 2.0, 8.0],
    (0, 1): [10.0, 5.0],
    (1, 0): [3.0, 3.0, 3.0],
    (1, 1): [2.0, 11.0, 7.0, 4.0],
}


@pytest.fixture
def records():
    """Return two worlds of two HAVs with two goals, to which nothing has happened."""
    worlds = allocate_worlds(2, 2, 5, 2)
    for (w, agent), lengths in LENGTHS.items():
        worlds.fleet.num_trailers[agent, w] = len(lengths) - 1
        worlds.fleet.length[agent, :, w] = 1.0
        worlds.fleet.length[agent, : len(lengths), w] = lengths
        worlds.fleet.radius[agent, :, w] = sum(lengths[1:]), math.hypot(*lengths)
    record = worlds.record
    record.first[:] = -1
    record.goal[:] = math.nan
    record.goal[:, :, columns.HIT_STEP] = -1
    record.miss[:] = math.nan
    record.miss[:, :, :, columns.MISS_COUNT] = 0
    worlds.state.clock[columns.EPISODE] = 30, 31
    worlds.state.clock[columns.STEP] = 500, 600
    return worlds


def table(worlds, policy=AvoidJack(), start=None):
    start = np.zeros((2, 3, 2)) if start is None else start
    return tabulate(worlds, start, policy).to_pylist()


def test_rows_come_by_episode_and_hav_and_describe_the_vehicle(records):
    start = np.arange(12.0).reshape(2, 3, 2)
    records.goals[:] = 100.0 + np.arange(24).reshape(2, 2, 3, 2)
    records.record.total[:, columns.PATH] = [[1.0, 2.0], [3.0, 4.0]]
    records.record.total[:, columns.MOVED] = [[10, 20], [30, 40]]
    records.record.total[:, columns.LARGEST] = [[0.5, math.pi], [3.2, 0.0]]
    rows = table(records, start=start)
    assert [(row["episode"], row["hav"], row["steps"]) for row in rows] == [
        (30, 0, 500),
        (30, 1, 500),
        (31, 0, 600),
        (31, 1, 600),
    ]
    for row, ((w, agent), lengths) in zip(rows, LENGTHS.items(), strict=True):
        assert row["num_trailers"] == len(lengths) - 1
        assert row["truck_length"] == lengths[0]
        assert row["trailer_lengths"] == lengths[1:]
        assert row["vehicle_length"] == sum(lengths)
        assert row["footprint_radius"] == sum(lengths[1:])
        assert row["stable_radius"] == math.hypot(*lengths)
        for k, part in enumerate(("x", "y", "heading")):
            assert row[f"start_{part}"] == start[agent, k, w]
            for g in range(2):
                assert row[f"goal_{g + 1}_{part}"] == records.goals[agent, g, k, w]
    assert [row["path_length"] for row in rows] == [1.0, 3.0, 2.0, 4.0]
    assert [row["moving_steps"] for row in rows] == [10, 30, 20, 40]
    assert [row["folded_through"] for row in rows] == [False, True, False, False]


EVENTS = ["jackknife_step", "jackknife_joint", "joint_position", "joint_length_difference"]
EVENTS += [f"{kind}_collision_{what}" for kind in ("potential", "actual") for what in ("step",)]
EVENTS += ["potential_collision_partner", "actual_collision_partner"]
HITS = ["step", "distance", "heading_difference", "driven_length", "length_ratio"]
MISSES = ["distance", "heading_difference", "jackknife_weight"]


def test_what_has_not_happened_is_null(records):
    for row in table(records):
        flags = ("jackknifed", "potential_collision", "actual_collision")
        assert not any(row[flag] for flag in flags)
        empty = EVENTS[:]
        for goal in ("goal_1", "goal_2"):
            assert row[f"{goal}_hit"] is False
            empty += [f"{goal}_{part}" for part in (*HITS, "closest", "dubins_length")]
            for kind in ("heading_miss", "euclidean_miss"):
                assert row[f"{goal}_{kind}_steps"] == 0
                empty += [f"{goal}_{kind}_{part}" for part in MISSES]
        assert {row[name] for name in empty} == {None}


def test_the_length_difference_metric_is_the_sum_over_all_joints_by_vehicle_length(records):
    found = [row["length_difference"] for row in table(records)]
    assert found == pytest.approx([(2 + 4 + 6) / 20, 5 / 15, 0.0, (9 + 4 + 3) / 24])


@pytest.mark.parametrize(
    ("w", "agent", "joint", "position", "difference"),
    [
        (0, 0, 1, 4 / 20, 2 / 20),
        (0, 0, 3, 12 / 20, 6 / 20),
        (0, 1, 1, 10 / 15, 5 / 15),
        (1, 1, 2, 13 / 24, 4 / 24),
    ],
)
def test_the_joint_position_metric_is_the_share_of_the_vehicle_ahead_of_the_joint(
    records, w, agent, joint, position, difference
):
    records.record.first[agent, columns.JACKKNIFE, :, w] = 123, joint
    rows = table(records)
    row = rows.pop(2 * w + agent)
    assert row["jackknifed"]
    assert (row["jackknife_step"], row["jackknife_joint"]) == (123, joint)
    assert row["joint_position"] == pytest.approx(position)
    assert row["joint_length_difference"] == pytest.approx(difference)
    assert not any(other["jackknifed"] for other in rows)


def test_hitches_off_the_axles_move_the_joints_of_a_vehicle():
    """Seen from the front axle of a straight HAV; behind the last one nothing is hitched."""
    worlds = catalogue_like(OffAxle(bodies=Rectangles())).worlds
    worlds.fleet.joints.offset[0, 3:] = 7.0
    places = np.array([4.5 + 1.0, 8.0, 8.0 + 6.0 - 0.6])
    for joint in (1, 2, 3):
        worlds.record.first[:, columns.JACKKNIFE, :, 0] = [[12, joint], [-1, -1]]
        row, _ = tabulate(worlds, np.zeros((2, 3, 1)), AvoidJack()).to_pylist()
        assert row["vehicle_length"] == pytest.approx(20.4)
        assert row["joint_position"] == pytest.approx(places[joint - 1] / 20.4)


def test_collisions_name_step_and_partner(records):
    records.record.first[0, columns.POTENTIAL, :, 1] = 0, 1
    records.record.first[1, columns.ACTUAL, :, 0] = 77, 0
    rows = table(records)
    assert [row["potential_collision"] for row in rows] == [False, False, True, False]
    assert [row["potential_collision_step"] for row in rows] == [None, None, 0, None]
    assert [row["potential_collision_partner"] for row in rows] == [None, None, 1, None]
    assert [row["actual_collision"] for row in rows] == [False, True, False, False]
    assert [row["actual_collision_step"] for row in rows] == [None, 77, None, None]
    assert [row["actual_collision_partner"] for row in rows] == [None, 0, None, None]


def test_a_hit_is_compared_with_the_dubins_length_from_the_assignment(records):
    goal = records.record.goal
    goal[0, 0, :, 0] = 200, 0.4, 0.05, 60.0, 40.0, 0.4
    goal[0, 1, :, 0] = 450, 0.3, 0.01, 90.0, 25.0, 0.2
    goal[1, 0, [columns.DUBINS, columns.CLOSEST], 0] = 70.0, 1.5  # under way when time was up
    hit, under_way, *_ = table(records)
    first = {name: hit[f"goal_1_{name}"] for name in HITS}
    assert list(first.values()) == pytest.approx([200, 0.4, 0.05, 60.0, 1.5])
    second = {name: hit[f"goal_2_{name}"] for name in HITS}
    assert list(second.values()) == pytest.approx([450, 0.3, 0.01, 30.0, 1.2])
    assert hit["goal_2_closest"] == 0.2
    assert under_way["goal_1_hit"] is False
    assert under_way["goal_1_dubins_length"] == 70.0
    assert under_way["goal_1_closest"] == 1.5
    assert under_way["goal_1_length_ratio"] is None
    assert under_way["goal_2_dubins_length"] is None


@pytest.mark.parametrize("policy", [AvoidJack(b=0.2, c=1.0), DubinsPursuit(), Random()])
def test_a_close_miss_reports_the_jackknife_weight_of_all_joints(records, policy):
    bends = [0.3, -1.2, 0.7]
    miss = records.record.miss[0, 1, columns.EUCLIDEAN_MISS, :, 0]
    miss[:3] = 4, 0.6, 0.05
    miss[3:6] = bends
    row = table(records, policy)[0]
    b, c = (0.2, 1.0) if isinstance(policy, AvoidJack) else (AvoidJack().b, AvoidJack().c)
    assert row["goal_2_euclidean_miss_steps"] == 4
    found = [row[f"goal_2_euclidean_miss_{part}"] for part in MISSES]
    expected = sum(1 + math.tanh(b - c * math.cos(bend)) for bend in bends)
    assert found == pytest.approx([0.6, 0.05, expected])
    assert row["goal_2_heading_miss_steps"] == 0


class Unregistered(NamedTuple):
    gain: float = 1.0


@pytest.mark.parametrize("policy", [Unregistered(), None, 5])
def test_what_is_no_policy_is_an_error(policy):
    with pytest.raises(TypeError, match="is not a policy"):
        rollout(policy, RandomPoses(), 0, np.arange(2))


@pytest.mark.parametrize(
    ("model", "field"),
    [(model, field) for model in (AvoidJack, DubinsPursuit, Random) for field in model._fields],
)
@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_a_parameter_that_is_not_finite_is_named(model, field, value):
    with pytest.raises(ValueError, match=f"policy {field} is {value}"):
        check_policy(model()._replace(**{field: value}), RandomPoses())


def test_memory_is_as_large_as_a_policy_asks_and_empty_at_first():
    assert memory_size(DubinsPursuit()) == memory_size(Random()) == 0
    memory = allocate_memory(AvoidJack(), 3, 4)
    assert memory.shape == (3, memory_size(AvoidJack()), 4)
    assert not memory.any()


@pytest.mark.parametrize("seed", [-1, 2**32])
def test_a_rollout_refuses_seeds_beyond_32_bits(seed):
    with pytest.raises(ValueError, match=f"seed is {seed}"):
        rollout(Random(), RandomPoses(), seed, np.arange(2))


def test_a_rollout_without_room_is_an_error():
    crowded = RandomPoses(num_havs=20, area_factor=0.3, pose_attempts=5, world_attempts=1)
    with pytest.raises(PlacementError, match="worlds have no space for 20 HAVs"):
        rollout(Random(), crowded, 0, np.arange(2))


@pytest.mark.parametrize("num_worlds", [0, -3])
def test_a_batch_needs_a_world(num_worlds):
    with pytest.raises(ValueError, match=f"num_worlds is {num_worlds}"):
        Batch(RandomPoses(), num_worlds)


@pytest.mark.parametrize("shape", [(), (2,), (3, 2), (2, 3, 1), (2, 1)])
@pytest.mark.parametrize("which", ["speed", "steering"])
def test_actions_of_a_wrong_shape_are_an_error(which, shape):
    batch = Batch(RandomPoses(num_havs=2), 3)
    batch.reset(0)
    actions = {"speed": np.zeros((2, 3)), "steering": np.zeros((2, 3))} | {which: np.zeros(shape)}
    with pytest.raises(ValueError, match=rf"{which} has shape .*\(2, 3\)"):
        batch.step(**actions)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("which", ["speed", "steering"])
def test_actions_that_are_not_finite_are_an_error_and_change_nothing(which, value):
    batch = Batch(RandomPoses(num_havs=2), 3)
    batch.reset(0)
    actions = {"speed": np.ones((2, 3)), "steering": np.zeros((2, 3))}
    actions[which][1, 2] = value
    before = batch.worlds.state.x.tobytes()
    with pytest.raises(ValueError, match=f"{which} holds a number that is not finite"):
        batch.step(**actions)
    assert batch.worlds.state.x.tobytes() == before


@pytest.mark.parametrize("form", [list, np.float32, np.int64, np.asfortranarray])
def test_actions_may_be_any_array_of_numbers(form):
    def moved(values):
        batch = Batch(RandomPoses(num_havs=2), 3)
        batch.reset(0)
        batch.step(values, values)
        return batch.worlds.state.heading.tobytes()

    ones = np.ones((2, 3))
    same = ones.tolist() if form is list else form(ones)
    assert moved(same) == moved(ones)
