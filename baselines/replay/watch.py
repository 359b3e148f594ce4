"""This module shows one episode: in a window, as a film, or as a page that replays it."""

import os
import pathlib

from baselines.cli.bounds import check_whole
from baselines.evaluation.runs import Experiments, check_experiments
from baselines.replay.trajectory import Trajectory
from baselines.replay.web_page import write_replay
from hav_env.maths.random_numbers import SEED_LIMIT

FILMS = (".mp4", ".gif")
PAGES = (".html",)
_USUAL_SPEED = 10.0  # times real time
_LONGEST_FILM = 60.0  # [s], of one at this speed; beyond it runs faster
_SLOWEST, _FASTEST = 0.01, 10_000.0  # times real time
_MOST_SKIPPED = 10**9  # steps


def check_display(output: pathlib.Path | None) -> None:
    """Check, before anything is simulated, that an episode can be shown; None for a window.

    Raises:
        ValueError, OSError, ImportError: as ``check_output``.
    """
    if output is None:
        import baselines.replay.video  # noqa: F401, PLC0415 (says what is missing)
    else:
        check_output(output, (*FILMS, *PAGES))


def check_output(path: pathlib.Path, suffixes: tuple[str, ...]) -> None:
    """Check, before anything is simulated, that a file can be written; make its folder.

    Raises:
        ValueError: when the suffix is none of ``suffixes``, or a folder has this name.
        OSError: when the folder cannot be made or written to.
        ImportError: when what writes this kind of file is not installed.
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


def check_pace(speed: float | None, fps: int) -> None:
    """Raise ValueError unless speed (None: by default) and frames per second can be shown."""
    if speed is not None and not _SLOWEST <= speed <= _FASTEST:
        raise ValueError(f"speed is {speed}, but must be from {_SLOWEST} to {_FASTEST:g}")
    check_whole("fps", fps, 1, 100)


def check_episode(job: Experiments, episode: int, every: int) -> None:
    """Check, before anything is written, what is simulated and which states are kept.

    Args:
        job: policy, scenario, seed and rules.
        episode: its number.
        every: keep the states after each so many steps.

    Raises:
        TypeError, ValueError: naming the argument, its value and what is allowed.
    """
    check_experiments(job)
    check_whole("episode", episode, 0, SEED_LIMIT - 1)
    check_whole("every", every, 1, _MOST_SKIPPED)


def show(
    trajectory: Trajectory, output: pathlib.Path | None, speed: float | None, fps: int
) -> None:
    """Show an episode in a window, or write it to a file.

    Args:
        trajectory: the episode.
        output: a file whose suffix is one of ``FILMS`` or ``PAGES``; None for a window.
        speed: times real time; None for 10, or for what makes a film last a minute.
        fps: frames per second.

    Raises:
        ImportError: when what draws is not installed; OSError: when the file cannot be written.
    """
    if output is not None and output.suffix in PAGES:
        write_replay(trajectory, output, speed or _USUAL_SPEED)
        return
    # drawing needs an extra, which a page does not
    from baselines.replay.video import play, write_film  # noqa: PLC0415

    if output is None:
        play(trajectory, speed or _USUAL_SPEED, fps)
    else:
        duration = (trajectory.step[-1] - trajectory.step[0]) * trajectory.dt
        write_film(trajectory, output, speed or max(_USUAL_SPEED, duration / _LONGEST_FILM), fps)


def name_with_changes(name: str, model, usual) -> str:
    """Return a name, followed by the parameters of a model in which it is not the usual one."""
    changes = [
        f"{field}={value}"
        for field, value in model._asdict().items()
        if model is not usual and value != getattr(usual, field)
    ]
    return f"{name} ({', '.join(changes)})" if changes else name
