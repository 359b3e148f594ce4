"""This module shows one episode: in a window, as a film, or as a page that replays it."""

import os
import pathlib
import sys

from baselines.cli.bounds import check_whole
from baselines.evaluation.runs import Experiments, check_experiments
from baselines.replay.trajectory import Trajectory
from baselines.replay.web_page import write_replay
from hav_env.maths.random_numbers import SEED_LIMIT
from hav_env.models.text import visible

FILMS = (".mp4", ".gif")
PAGES = (".html",)
_USUAL_SPEED = 10.0  # over real time
_LONGEST = {".mp4": 60.0, ".gif": 30.0}  # [s]; longer films get a higher speed
_USUAL_RATE, _RATE_OF_GIF = 30, 15  # frames per second
_LARGE = 20e6  # [bytes]; a message announces larger films
_SLOWEST, _FASTEST = 0.01, 10_000.0  # over real time
_MOST_SKIPPED = 10**9  # steps
_MOST_SECONDS_SHOWN = 1e6  # [s]


def check_display(output: pathlib.Path | None) -> None:
    """Check, before any simulation, that an episode can be shown; None for a window.

    Raises:
        ValueError, OSError, ImportError: As in ``check_output``.
    """
    if output is None:
        import baselines.replay.video  # noqa: F401, PLC0415 (names a missing extra)
    else:
        check_output(output, (*FILMS, *PAGES))


def check_output(path: pathlib.Path, suffixes: tuple[str, ...]) -> None:
    """Check, before any simulation, that a file can be written; make its folder.

    Raises:
        ValueError: If the suffix is none of ``suffixes``, or a folder has this name.
        OSError: If the folder cannot be made or is not writable.
        ImportError: If the library for this kind of file is missing.
    """
    if path.suffix not in suffixes:
        raise ValueError(f"{path} must end with {' or '.join(suffixes)}")
    if path.is_dir():
        raise ValueError(f"{path} is a folder")
    if path.suffix in FILMS:
        import baselines.replay.video  # noqa: F401, PLC0415
    path.parent.mkdir(parents=True, exist_ok=True)
    if not os.access(path.parent, os.W_OK):
        raise PermissionError(f"the folder {path.parent} cannot be written to")


def check_pace(
    speed: float | None,
    fps: int | None,
    begin: float | None = None,
    end: float | None = None,
) -> None:
    """Check the speed, the frame rate and the shown times; None is the default of each.

    Args:
        speed: Speed over real time.
        fps: Frames per second.
        begin: First shown time [s].
        end: Last shown time [s].

    Raises:
        ValueError: If an argument is out of range; the message names it, its value and the rule.
    """
    for name, time in (("from", begin), ("until", end)):
        if time is not None and not 0 <= time <= _MOST_SECONDS_SHOWN:
            told = f"must be from 0 to {_MOST_SECONDS_SHOWN:,.0f} s"
            raise ValueError(f"{name} is {time:g} s, but {told}")
    if begin is not None and end is not None and begin >= end:
        raise ValueError(f"from is {begin:g} s, but must be below until, {end:g} s")
    if speed is not None and not _SLOWEST <= speed <= _FASTEST:
        raise ValueError(f"speed is {speed}, but must be from {_SLOWEST} to {_FASTEST:g}")
    if fps is not None:
        check_whole("fps", fps, 1, 100)


def check_episode(job: Experiments, episode: int, every: int) -> None:
    """Check, before any file is written, the episode and the interval of its states.

    Args:
        job: Policy, scenario, seed and rules.
        episode: Number of the episode.
        every: Number of steps between recorded states.

    Raises:
        TypeError, ValueError: If an argument is invalid; the message names it, its value and the
            rule.
    """
    check_experiments(job)
    check_whole("episode", episode, 0, SEED_LIMIT - 1)
    check_whole("every", every, 1, _MOST_SKIPPED)


def show(
    trajectory: Trajectory, output: pathlib.Path | None, speed: float | None, fps: int | None
) -> None:
    """Show an episode in a window, or write it to a file and print the file's size and duration.

    Args:
        trajectory: The episode.
        output: A file with a suffix of ``FILMS`` or ``PAGES``; None for a window.
        speed: Speed over real time; None for 10, or more to limit an mp4 to 60 s and a gif to 30 s.
        fps: Frames per second; None for 30, of a gif 15.

    Raises:
        ImportError: If the drawing library is missing.
        OSError: If the file cannot be written.
    """
    duration = (trajectory.step[-1] - trajectory.step[0]) * trajectory.dt
    if output is not None and output.suffix in PAGES:
        write_replay(trajectory, output, speed or _USUAL_SPEED)
        _report(output, f"{duration:,.0f} s of the episode")
        return
    # drawing needs an extra, a page does not
    from baselines.replay import video  # noqa: PLC0415

    if output is None:
        video.play(trajectory, speed or _USUAL_SPEED, fps or _USUAL_RATE)
        return
    kind = output.suffix
    pace = (
        speed or max(_USUAL_SPEED, duration / _LONGEST[kind]),
        fps or (_RATE_OF_GIF if kind == ".gif" else _USUAL_RATE),
    )
    size = video.estimate_bytes(trajectory, kind, *pace)
    if size > _LARGE:
        remedy = "--speed, --fps, --from and --until make it smaller, and so does .mp4"
        print(f"{output.name} will have about {size / 1e6:.0f} MB: {remedy}", file=sys.stderr)
    seconds = video.write_film(trajectory, output, *pace)
    _report(output, f"{seconds:,.0f} s at {pace[0]:.3g} x real time")


def _report(path: pathlib.Path, what: str) -> None:
    """Print the path of a written file, its size, and its content."""
    print(f"wrote {visible(str(path))}: {path.stat().st_size / 1e6:.1f} MB, {what}")
