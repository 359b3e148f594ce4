"""An episode stored in a file is the same again; viewers show all of it, or leave no file."""

import base64
import json
import re
import subprocess
import sys
import tempfile
import weakref

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image

from baselines.__main__ import main
from baselines.policies.avoid_jack import AvoidJack
from baselines.replay import trajectory as recording
from baselines.replay import video as films
from baselines.replay.trajectory import record_trajectory
from baselines.replay.trajectory_files import load_trajectory, save_trajectory
from hav_env import RandomFleet, RandomPoses, Task
from tests.support.budgets import budget

PAIR = [
    "watch",
    "avoid_jack",
    "--scenario",
    "paper-pair",
    "--episode",
    "5",
    "--task.max-steps",
    "60",
]


def run(capsys, *arguments):
    code = main(list(map(str, arguments)))
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def data_of(page) -> dict:
    """Return the episode that a page holds."""
    found = re.findall(
        r'<script type="application/json" id="episode">(.*?)</script>', page.read_text(), re.DOTALL
    )
    assert len(found) == 1
    return json.loads(found[0])


def numbers(text: str, kind: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), kind).astype(float)


# recorded data


def test_a_page_holds_the_episode(tmp_path, capsys):
    page, record = tmp_path / "run.html", tmp_path / "run.npz"
    code, out, err = run(capsys, *PAIR, "--output", page, "--record", record)
    assert (code, err) == (0, "")
    size = page.stat().st_size / 1e6
    assert out == f"wrote {page}: {size:.1f} MB, 12 s of the episode\n"
    data, kept = data_of(page), load_trajectory(record)
    assert (kept.policy, kept.scenario) == ("avoid_jack", "paper-pair")
    assert (data["policy"], data["episode"], data["dt"]) == ("avoid_jack", 5, 0.2)
    for axis, origin in zip("xy", data["origin"], strict=True):
        found = numbers(data[axis], "<f4") + origin
        assert np.abs(found - getattr(kept, axis).ravel()).max() < 1e-3
    assert np.array_equal(numbers(data["step"], "<i4"), kept.step)
    assert np.array_equal(numbers(data["evaded"], "<i2"), kept.evaded.ravel())
    assert np.allclose(np.array(data["goals"])[..., :2] + data["origin"], kept.goals[..., :2])


def test_a_recorded_episode_is_shown_without_simulating(tmp_path, capsys, monkeypatch):
    pages = [tmp_path / name for name in ("first.html", "again.html")]
    assert run(capsys, *PAIR, "--output", pages[0], "--record", tmp_path / "run.npz")[0] == 0
    monkeypatch.setattr(recording, "record_trajectory", None)
    assert run(capsys, "watch", tmp_path / "run.npz", "--output", pages[1])[0] == 0
    assert pages[0].read_bytes() == pages[1].read_bytes()


def test_recording_alone_opens_no_window_and_may_be_thinned(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(films, "play", None)
    path = tmp_path / "made/run.npz"
    assert run(capsys, *PAIR, "--record", path, "--every", 25)[0] == 0
    assert load_trajectory(path).step.tolist() == [0, 25, 50, 60]


def test_parameters_that_were_changed_are_told(tmp_path, capsys):
    path = tmp_path / "run.npz"
    arguments = ["--policy.close-factor", 3, "--num-goals", 1, "--record", path]
    assert run(capsys, *PAIR, *arguments)[0] == 0
    kept = load_trajectory(path)
    assert kept.policy == "avoid_jack (close_factor=3.0)"
    assert kept.scenario == "paper-pair (num_goals=1)"


def test_names_cannot_break_out_of_a_page(trajectory, tmp_path, capsys):
    odd = trajectory._replace(policy='</script><script>alert("x")</script>', scenario="<!--")
    save_trajectory(odd, tmp_path / "odd.npz")
    assert run(capsys, "watch", tmp_path / "odd.npz", "--output", tmp_path / "odd.html")[0] == 0
    data = data_of(tmp_path / "odd.html")
    assert (data["policy"], data["scenario"]) == (odd.policy, odd.scenario)


def test_a_page_of_a_long_pair_stays_small(tmp_path, capsys):
    scenario = RandomPoses(num_havs=2, fleet=RandomFleet(min_trailers=10))
    steps = budget(2_000, 50)
    long = record_trajectory(AvoidJack(), scenario, 0, 0, Task(max_steps=steps))
    assert long.step[-1] == steps
    save_trajectory(long, tmp_path / "long.npz")
    assert run(capsys, "watch", tmp_path / "long.npz", "--output", tmp_path / "long.html")[0] == 0
    assert (tmp_path / "long.html").stat().st_size < 430_000


def test_a_film_has_every_frame(tmp_path, capsys):
    arguments = [*PAIR, "--fps", 10, "--speed", 5]
    frames = 25  # 12 s at 5 times real time, 10 a second, and the last state
    for name in ("run.gif", "run.mp4"):
        assert run(capsys, *arguments, "--output", tmp_path / name)[0] == 0
    with Image.open(tmp_path / "run.gif") as film:
        assert film.n_frames == frames
        assert film.info["duration"] == 100  # ms
        colors = film.convert("RGB").getcolors(100_000)
        assert len(colors) > 20
    count, seconds = imageio_ffmpeg.count_frames_and_secs(str(tmp_path / "run.mp4"))
    assert (count, seconds) == (frames, frames / 10)
    decoder = [imageio_ffmpeg.get_ffmpeg_exe(), "-v", "error", "-i", str(tmp_path / "run.mp4")]
    raw = subprocess.run(
        [*decoder, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"], capture_output=True, check=True
    )
    pictures = np.frombuffer(raw.stdout, np.uint8).reshape(-1, 720, 960, 3)
    assert len(pictures) == frames
    assert all(picture.std() > 1 for picture in pictures)
    assert not np.array_equal(pictures[0], pictures[-1])
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run.gif", "run.mp4"]


class Recorder:
    """Replaces the viewer; counts its pictures that are alive."""

    closed = False
    most, drawn = 0, 0
    stop_at: int | None = None
    error: type[BaseException] = RuntimeError

    def __init__(self, mode, *, size=(960, 720), frames_per_second=30, caption=()):
        """Take the arguments of a viewer."""
        self.size = size
        self.pictures: list[weakref.ref] = []

    def observe(self, scene):
        """Draw nothing."""

    def draw(self, scene):
        Recorder.drawn += 1
        if Recorder.drawn == Recorder.stop_at:
            raise Recorder.error("stopped")
        picture = np.full((self.size[1], self.size[0], 3), Recorder.drawn % 256, np.uint8)
        self.pictures.append(weakref.ref(picture))
        alive = sum(reference() is not None for reference in self.pictures)
        Recorder.most = max(Recorder.most, alive)
        return picture

    def close(self):
        self.closed = True


@pytest.fixture
def recorder(monkeypatch):
    monkeypatch.setattr(films, "Viewer", Recorder)
    for name in ("most", "drawn", "stop_at", "error"):
        monkeypatch.setattr(Recorder, name, getattr(Recorder, name))
    return Recorder


@pytest.mark.parametrize(("name", "sampled"), [("run.gif", 24), ("run.mp4", 72)])
def test_no_more_than_two_pictures_of_a_film_are_held(name, sampled, recorder, tmp_path, capsys):
    assert run(capsys, *PAIR, "--speed", 2, "--fps", 30, "--output", tmp_path / name)[0] == 0
    assert recorder.drawn == sampled + 181  # some are drawn to estimate the size
    assert recorder.most <= 2


@pytest.mark.parametrize(
    ("error", "code"), [(ValueError, 2), (MemoryError, 2), (KeyboardInterrupt, 130)]
)
@pytest.mark.parametrize("speed", [10, 1])  # at 1, the size is estimated first
@pytest.mark.parametrize("name", ["run.gif", "run.mp4"])
def test_a_film_that_stops_leaves_nothing(
    name, speed, error, code, recorder, tmp_path, capsys, monkeypatch
):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    (tmp_path / name).write_text("from before")
    monkeypatch.setattr(recorder, "stop_at", 5)
    monkeypatch.setattr(recorder, "error", error)
    assert run(capsys, *PAIR, "--speed", speed, "--output", tmp_path / name)[0] == code
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert (tmp_path / name).read_text() == "from before"


@pytest.mark.parametrize("name", ["run.gif", "run.mp4"])
def test_an_encoder_that_fails_is_told_and_leaves_nothing(
    name, recorder, tmp_path, capsys, monkeypatch
):
    monkeypatch.setitem(films._FFMPEG_OPTIONS, f".{name[-3:]}", ["-vf", "nonsense"])
    code, _, err = run(capsys, *PAIR, "--output", tmp_path / name)
    assert code == 2
    assert err.splitlines()[-1].startswith("error: ")
    assert not list(tmp_path.iterdir())


def test_a_window_shows_the_frames_of_a_film(recorder, capsys):
    assert run(capsys, *PAIR, "--fps", 10, "--speed", 5)[0] == 0
    assert recorder.drawn == 25


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["watch"], "name what to watch"),
        (["watch", "avoid_jack", "random"], "watch shows one policy, but 2 are named"),
        (["watch", "nobody"], "unknown policy 'nobody'"),
        (["watch", "none.npz"], "none.npz"),
        (["watch", "random", "--output", "{}/run.avi"], "must end with .mp4 or .gif or .html"),
        (["watch", "random", "--output", "{}/run"], "must end with"),
        (["watch", "random", "--record", "{}/run.html"], "must end with .npz"),
        (["watch", "random", "--output", "{}/file/run.html"], "file"),
        (["watch", "random", "--output", "{}/file/run.mp4"], "file"),
        (["watch", "random", "--output", "{}/folder.html"], "is a folder"),
        (["watch", "random", "--record", "{}/file/run.npz"], "file"),
        (["watch", "random", "--output", "{}/run.gif", "--speed", "0"], "speed is 0"),
        (["watch", "random", "--output", "{}/run.gif", "--speed", "inf"], "speed is inf"),
        (["watch", "random", "--output", "{}/run.gif", "--fps", "0"], "fps is 0"),
        (["watch", "random", "--output", "{}/run.gif", "--from", "-1"], "from is -1 s"),
        (["watch", "random", "--output", "{}/run.gif", "--until", "nan"], "until is nan s"),
        (
            ["watch", "random", "--output", "{}/run.gif", "--from", "9", "--until", "9"],
            "from is 9 s, but must be below until, 9 s",
        ),
        (["watch", "random", "--record", "{}/run.npz", "--every", "0"], "every is 0"),
        (["watch", "random", "--record", "{}/run.npz", "--seed", "-1"], "seed is -1"),
        (["watch", "random", "--record", "{}/run.npz", "--episode", "-1"], "episode is -1"),
        (["watch", "random", "--record", "{}/run.npz", "--task.max-steps", "0"], "max_steps is 0"),
        (["watch", "random", "--record", "{}/run.npz", "--policy.hold", "0"], "hold is 0"),
        (["watch", "random", "--record", "{}/run.npz", "--scenario", "moon"], "unknown scenario"),
        (["watch", "{}/file.npz", "--output", "{}/run.html"], "not a whole recorded episode"),
        (["watch", "{}/file.npz", "--seed", "1", "--output", "{}/run.html"], "--seed"),
    ],
)
def test_bad_input_is_one_line_and_leaves_nothing(arguments, message, tmp_path, capsys):
    for name in ("file", "file.npz"):
        (tmp_path / name).write_text("in the way")
    (tmp_path / "folder.html").mkdir()
    before = sorted(tmp_path.rglob("*"))
    code, _, err = run(capsys, *(argument.format(tmp_path) for argument in arguments))
    said = [line for line in err.splitlines() if line.startswith("error: ")]
    assert code == 2
    assert len(said) == 1
    assert message in said[0]
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize("output", [["--output", "{}/run.mp4"], ["--output", "{}/run.gif"], []])
def test_a_missing_extra_is_named_before_anything_is_simulated(
    output, tmp_path, capsys, monkeypatch
):
    monkeypatch.setitem(sys.modules, "moviepy.video.io.ffmpeg_writer", None)
    monkeypatch.delitem(sys.modules, "baselines.replay.video")
    monkeypatch.setattr(recording, "record_trajectory", None)
    code, _, err = run(capsys, *PAIR, *(word.format(tmp_path) for word in output))
    assert code == 2
    assert err == "error: films need moviepy: run pip install -e '.[rendering]' in the clone\n"
    assert not list(tmp_path.iterdir())


def test_a_page_needs_no_extra(tmp_path, capsys, monkeypatch):
    for name in ("moviepy", "pygame", "matplotlib"):
        monkeypatch.setitem(sys.modules, name, None)
    monkeypatch.delitem(sys.modules, "baselines.replay.video")
    assert run(capsys, *PAIR, "--output", tmp_path / "run.html")[0] == 0
