"""Films are short unless stated otherwise, show the wanted part, and say what they show."""

import re

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image

from baselines.__main__ import main
from baselines.replay import video as films
from baselines.replay import watch
from baselines.replay.trajectory import cut_trajectory
from baselines.replay.trajectory_files import save_trajectory


def run(capsys, *arguments):
    code = main(list(map(str, arguments)))
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_a_gif_is_short_and_slow_unless_stated_otherwise(trajectory, tmp_path):
    long = trajectory._replace(dt=2.0)  # 800 s
    save_trajectory(long, tmp_path / "long.npz")
    assert main(["watch", str(tmp_path / "long.npz"), "--output", str(tmp_path / "x.gif")]) == 0
    with Image.open(tmp_path / "x.gif") as film:
        times = []
        for k in range(film.n_frames):
            film.seek(k)
            times.append(film.info["duration"])
    assert sum(times) <= 30_200  # ms
    assert film.n_frames <= 15 * 30 + 1


def test_a_part_of_an_episode_is_shown(trajectory, tmp_path, capsys):
    save_trajectory(trajectory, tmp_path / "run.npz")  # of 80 s
    part = ["--from", "20", "--until", "30"]
    film = tmp_path / "part.mp4"
    pace = ["--speed", "1", "--fps", "5"]
    assert run(capsys, "watch", tmp_path / "run.npz", *part, *pace, "--output", film)[0] == 0
    assert imageio_ffmpeg.count_frames_and_secs(str(film))[0] == 51


def test_the_size_of_a_large_film_is_announced(trajectory, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(watch, "_LARGE", 1e3)
    path, film = tmp_path / "run.npz", tmp_path / "run.gif"
    save_trajectory(trajectory, path)
    code, out, err = run(capsys, "watch", path, "--speed", 4, "--fps", 10, "--output", film)
    size = film.stat().st_size
    assert code == 0
    assert re.search(r"run.gif will have about \S+ MB: --speed", err)
    assert out == f"wrote {film}: {size / 1e6:.1f} MB, 20 s at 4 x real time\n"
    assert size <= 1.05 * films.estimate_bytes(trajectory, ".gif", 4.0, 10) <= 1.5 * size


def test_a_film_carries_policy_scenario_and_seed(trajectory):
    told = " ".join(films.caption_of(trajectory, 10.0))
    assert all(word in told for word in (trajectory.policy, trajectory.scenario, "seed 0"))
    assert "episode 5" in told


def test_a_part_keeps_the_states_between_two_times(trajectory):
    part = cut_trajectory(trajectory, 20.0, 30.0)
    assert part.step.tolist() == list(range(100, 151))
    assert np.array_equal(part.x, trajectory.x[100:151])
    assert np.array_equal(part.heading, trajectory.heading[100:151])
    assert part.goals is trajectory.goals
    assert cut_trajectory(trajectory, None, None).step.tolist() == trajectory.step.tolist()
    with pytest.raises(ValueError, match="from 900 s until 80 s is too short a part: the states"):
        cut_trajectory(trajectory, 900.0, None)
