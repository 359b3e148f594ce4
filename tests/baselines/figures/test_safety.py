"""The figures of docs/safety.md: drawn elements are at their places, and the command draws them."""

import numpy as np
import pytest
import shapely

from baselines.figures.reserved_areas import circle_behind, path_ahead, remember, reserved_corners
from baselines.figures.safety import main
from baselines.policies.reserve import Reserve
from baselines.policies.reserve.memory.rows import DRIVEN, HELD, OWN_STEP
from baselines.replay.trajectory import chain_points, record_trajectory
from hav_env import RandomPoses, Task
from tests.support.budgets import budget
from tests.support.paths import ROOT

SAFETY = ROOT / "docs/safety.md"
ROUNDING = 1e-9  # [m]


@pytest.fixture(scope="module")
def episode():
    """Return a trajectory, the memory of its HAVs, and the poses (T, N, 3) of their trucks."""
    scenario, task = RandomPoses(num_havs=2, num_goals=1), Task(max_steps=budget(1200, 15))
    trajectory = record_trajectory(Reserve(), scenario, 2026, 25, task)
    memories = remember(Reserve(), scenario, 2026, 25, task)
    poses = np.stack([trajectory.x, trajectory.y, trajectory.heading[..., 0]], axis=-1)
    return trajectory, memories, poses


def polygon(memories, poses, state, hav):
    corners = reserved_corners(memories[state, hav], *poses[state, hav])
    return None if corners is None else shapely.Polygon(corners).buffer(ROUNDING)


@pytest.mark.exhaustive
def test_outlines_hold_the_chain_and_the_circle(episode):
    trajectory, memories, poses = episode
    outlines = circles = 0
    for state, hav in np.ndindex(poses.shape[:2]):
        reserved = polygon(memories, poses, state, hav)
        circle = circle_behind(memories[state, hav], *poses[state, hav])
        if reserved is None:
            assert circle is None
            continue
        outlines += 1
        assert reserved.covers(shapely.LineString(chain_points(trajectory, hav, state)))
        if circle is not None:
            circles += 1
            assert reserved.covers(shapely.Point(circle[0]).buffer(circle[1]))
    assert outlines > len(poses)
    assert circles > 0
    assert budget(circles < outlines, True)  # the rest to a goal has none


@pytest.mark.exhaustive
def test_a_recorded_episode_has_the_same_outlines(episode):
    trajectory, memories, poses = episode
    shown = 0
    for state, hav in np.ndindex(poses.shape[:2]):
        number = trajectory.reserved[state, hav]
        corners = reserved_corners(memories[state, hav], *poses[state, hav])
        assert (corners is None) == (number < 0) or trajectory.waiting[state, hav]
        if number >= 0:
            shown += 1
            np.testing.assert_allclose(trajectory.outline[number], corners, atol=2e-3)
    assert shown > len(poses)
    assert len(trajectory.outline) < shown


@pytest.mark.exhaustive
def test_what_both_hold_is_disjoint(episode):
    _, memories, poses = episode
    for state in range(len(poses)):
        one, other = (polygon(memories, poses, state, hav) for hav in range(2))
        if one is not None and other is not None and memories[state, :, HELD].all():
            assert one.distance(other) > 0.0


@pytest.mark.exhaustive
def test_paths_ahead_are_driven(episode):
    _, memories, poses = episode
    compared = 0
    for state, hav in np.ndindex(len(poses) - 1, 2):
        rows, after = memories[state, hav], memories[state + 1, hav]
        step = rows[OWN_STEP]
        if step > 0.0 and after[DRIVEN] == rows[DRIVEN] + step:
            ahead = path_ahead(rows, *poses[state, hav], after[DRIVEN])
            assert ahead[0] == pytest.approx(poses[state, hav])
            assert ahead[1] == pytest.approx(poses[state + 1, hav], abs=1e-6)
            compared += 1
    assert compared > len(poses) / 2


@pytest.mark.exhaustive
def test_the_command_draws_what_safety_shows(tmp_path, capsys):
    arguments = ["--havs", 1, "--steps", budget(300, 4), "--episodes", budget(8, 1)]
    arguments += ["--worlds", 1, "--output", tmp_path / "drawn"]
    assert main(list(map(str, arguments))) == 0
    pictures = sorted((tmp_path / "drawn").iterdir())
    assert capsys.readouterr().out.split() == [str(path) for path in pictures]
    for picture in pictures:
        assert picture.read_bytes().startswith(b"\x89PNG")
        assert f"(images/{picture.name})" in SAFETY.read_text()
    assert len(pictures) == 3


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["--episodes", "0"], "episodes is 0, but must be at least 1"),
        (["--worlds", "-1"], "worlds is -1, but must be at least 1"),
        (["--havs", "0"], "havs is 0, but must be at least 1"),
        (["--steps", "0"], "steps is 0, but must be at least 1"),
        (["--havs", "many"], "--havs"),
        (["--seeds", "3"], "--seeds"),
        (["--threads", "0"], "threads is 0"),
        (["--output", __file__], "is a file, but must be a folder"),
    ],
)
def test_bad_options_are_named_in_one_line(arguments, complaint, capsys):
    assert main(arguments) == 2
    told = capsys.readouterr().err
    assert complaint in told
    assert told.startswith("error: ")
    assert told.count("\n") == 1
