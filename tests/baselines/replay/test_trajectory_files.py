"""A recorded episode: its contents, files that store all of it, and interpolated states."""

import contextlib
import zipfile

import numpy as np
import pytest

from baselines.policies.avoid_jack import AvoidJack
from baselines.policies.dubins_pursuit import DubinsPursuit
from baselines.replay.interpolation import frame_times, scene_at
from baselines.replay.trajectory import Trajectory, record_trajectory
from baselines.replay.trajectory_files import load_trajectory, save_trajectory
from hav_env import OffAxle, OnAxle, RandomPoses, Rectangles, Task
from hav_env.evaluation.rollout import rollout
from hav_env.world.arrays import ACTUAL, JACKKNIFE, NEVER, POTENTIAL, WHEN, WHERE
from tests.support.budgets import budget


@pytest.fixture(scope="module")
def trajectory() -> Trajectory:
    """Return a pair that evades each other, from step 330 on."""
    return record_trajectory(AvoidJack(), RandomPoses(num_havs=2), 0, 5, Task(max_steps=400))


def test_the_events_are_those_of_the_rollout():
    task, scenario = Task(max_steps=budget(1_500, 60)), RandomPoses(num_havs=10)
    table = rollout(AvoidJack(), scenario, 0, np.array([3]), task)
    found = record_trajectory(AvoidJack(), scenario, 0, 3, task)
    for event, name in ((JACKKNIFE, "jackknife"), (POTENTIAL, "potential_collision")):
        steps = table[f"{name}_step"].to_numpy(zero_copy_only=False)
        assert np.array_equal(found.first[:, event, WHEN], np.nan_to_num(steps, nan=NEVER))
    hits = table["goal_1_hit"].to_numpy(zero_copy_only=False).astype(bool)
    assert np.array_equal(found.hit_step[:, 0] != NEVER, hits)
    for event in (POTENTIAL, ACTUAL):  # a HAV that collides, collides with another one
        happened = found.first[:, event, WHEN] != NEVER
        partner = found.first[:, event, WHERE]
        assert np.array_equal(partner != NEVER, happened)
        assert (partner != np.arange(10)).all()


def test_a_pair_evades_each_other_while_their_circles_overlap(trajectory):
    distance = np.hypot(*(np.diff(axis)[:, 0] for axis in (trajectory.x, trajectory.y)))
    overlap = distance <= trajectory.footprint.sum()
    expected = np.where(overlap[:, None], [1, 0], NEVER)
    assert overlap[:-1].any()
    assert not overlap[0]
    assert np.array_equal(trajectory.evaded[:-1], expected[:-1])
    assert (trajectory.evaded[-1] == NEVER).all()


def test_a_policy_that_does_not_evade_evades_nobody():
    found = record_trajectory(
        DubinsPursuit(), RandomPoses(num_havs=2), 0, 5, Task(max_steps=budget(400, 20))
    )
    assert (found.evaded == NEVER).all()


# files


def packed(trajectory):
    """Return the arrays that an archive of an episode holds; lines have no numbers."""
    lines = np.zeros((*trajectory.length.shape, 0))
    shape = lines if trajectory.shape is None else trajectory.shape
    return trajectory._asdict() | {"shape": shape}


@pytest.mark.parametrize(
    "vehicle",
    [
        OnAxle(),
        pytest.param(OffAxle(bodies=Rectangles(2.5, 1.0, 0.5)), marks=pytest.mark.exhaustive),
    ],
)
def test_a_file_gives_the_same_episode_again(vehicle, tmp_path):
    task = Task(max_steps=budget(400, 20))
    trajectory = record_trajectory(AvoidJack(), RandomPoses(2), 0, 5, task, vehicle)
    save_trajectory(trajectory, tmp_path / "run.npz")
    loaded = load_trajectory(tmp_path / "run.npz")
    for field, value in trajectory._asdict().items():
        again = getattr(loaded, field)
        assert type(again) is type(value), field
        if isinstance(value, np.ndarray):
            assert again.dtype == value.dtype, field
            assert again.tobytes() == value.tobytes(), field
        else:
            assert again == value, field
    assert [path.name for path in tmp_path.iterdir()] == ["run.npz"]


def test_every_cut_and_every_flipped_byte_is_noticed(trajectory, tmp_path):
    thin = record_trajectory(AvoidJack(), RandomPoses(), 0, 0, Task(max_steps=4))
    save_trajectory(thin, tmp_path / "run.npz")
    whole = (tmp_path / "run.npz").read_bytes()
    path = tmp_path / "broken.npz"
    for cut in range(0, len(whole), len(whole) // 40):
        path.write_bytes(whole[:cut])
        with pytest.raises(ValueError, match=r"broken\.npz is not a whole recorded episode"):
            load_trajectory(path)
    for place in range(0, len(whole), len(whole) // 150):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 0xFF]) + whole[place + 1 :])
        # a byte that only archive tools read may change unnoticed, a number may not
        with contextlib.suppress(ValueError):
            again = load_trajectory(path)
            assert again.x.tobytes() == thin.x.tobytes()
            assert again.heading.tobytes() == thin.heading.tobytes()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"kind": "another"}, "another kind"),
        ({"version": 2}, "version 2"),
        ({"x": np.zeros((3, 2))}, "'x' is float64 of shape"),
        ({"x": np.array(["a"])}, "'x' is <U1"),
        ({"reserved": np.zeros((401, 2), np.int64)}, "an outline that there is not"),
        ({"outline": np.zeros((1, 23, 2))}, "'outline' is float64 of shape"),
        ({"max_steps": 399}, "a limit of time that has passed"),
        ({"dt": 0.0}, "duration"),
        ({"dt": np.nan}, "duration"),
        ({"seed": 0.5}, "'seed' is float64"),
        ({"footprint": np.array([1.0, np.nan])}, "not finite"),
        ({"footprint": np.array([1.0, -1.0])}, "footprint below 0"),
        ({"policy": "\x1b]0;pwned\x07"}, "cannot be shown"),
        ({"scenario": "\ud800"}, "cannot be shown"),
        ({"policy": "a" * 201}, "cannot be shown"),
        ({"num_trailers": np.array([0, 3])}, "number of trailers"),
        ({"articulation_max": np.full((2, 11), 4.0)}, "limit"),
        ({"offset": np.full((2, 11), np.nan)}, "not finite"),
        ({"shape": np.full((2, 11, 3), -1.0)}, "impossible body"),
        ({"shape": np.zeros((2, 11, 2))}, "'shape' is float64 of shape"),
        ({"shape": np.zeros((2, 11))}, "'shape' is float64 of shape"),
    ],
)
def test_contents_that_no_episode_has_are_named(changes, message, trajectory, tmp_path):
    path = tmp_path / "odd.npz"
    fields = {"kind": "hav_env trajectory", "version": 5, **packed(trajectory), **changes}
    np.savez_compressed(path, **fields)
    with pytest.raises(ValueError, match=message):
        load_trajectory(path)


def test_a_foreign_archive_and_a_missing_field_are_named(trajectory, tmp_path):
    path = tmp_path / "odd.npz"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("letter.txt", "hello")
    with pytest.raises(ValueError, match="another kind"):
        load_trajectory(path)
    fields = {"kind": "hav_env trajectory", "version": 5, **packed(trajectory)}
    del fields["evaded"]
    np.savez(path, **fields)
    with pytest.raises(ValueError, match="'evaded' is missing"):
        load_trajectory(path)


# moments


def test_a_scene_is_the_state_that_was_kept_and_lies_between_two(trajectory):
    for row in (0, 7, 350, 400):
        scene = scene_at(trajectory, trajectory.step[row] * trajectory.dt)
        assert np.allclose(scene.x, trajectory.x[row])
        assert np.allclose(scene.heading, trajectory.heading[row])
        assert np.array_equal(scene.potential, trajectory.evaded[row] >= 0) or row == 400
    middle = scene_at(trajectory, 10.1)
    assert np.allclose(middle.x, trajectory.x[50:52].mean(axis=0))
    before, after = (scene_at(trajectory, 0.2 * step) for step in (329, 330))
    assert not before.potential.any()
    assert after.potential.all()


@pytest.mark.parametrize(("speed", "fps"), [(10.0, 30), (3.7, 7), (1e6, 1)])
def test_a_film_takes_as_long_as_it_should_and_ends_with_the_last_state(trajectory, speed, fps):
    times = frame_times(trajectory, speed, fps)
    assert times[0] == 0.0
    assert times[-1] == 400 * 0.2
    assert np.allclose(np.diff(times[:-1]), speed / fps)
    assert abs(len(times) / fps - 80.0 / speed) <= 2.0 / fps


# the command


def test_who_has_left_stays_where_it_was_last_and_is_not_shown():
    task, scenario = Task(on_goal="remove", max_steps=900), RandomPoses(2, num_goals=1)
    trajectory = record_trajectory(DubinsPursuit(), scenario, 0, 14, task)
    hav, hit = int(np.argmin(trajectory.hit_step)), int(np.min(trajectory.hit_step))
    assert 0 < hit < trajectory.step[-1]
    left = trajectory.removed[:, hav]
    assert not left[: hit + 1].any()
    assert left[hit + 1 :].all()
    assert (trajectory.x[hit + 1 :, hav] == trajectory.x[hit, hav]).all()
    assert not scene_at(trajectory, hit * trajectory.dt).removed[hav]
    assert scene_at(trajectory, trajectory.step[-1] * trajectory.dt).removed[hav]
