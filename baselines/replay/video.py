"""This module plays an episode frame by frame, in a window or into a film."""

import pathlib
import tempfile

import numpy as np
from rich.console import Console
from rich.progress import Progress

from baselines.replay.interpolation import frame_times, scene_at
from baselines.replay.trajectory import Trajectory
from baselines.storage.atomic_files import whole_file
from hav_env.models.text import visible
from hav_env.rendering.viewer import Viewer

try:
    from moviepy.video.io.ffmpeg_writer import FFMPEG_VideoWriter
except ImportError as error:
    raise ImportError(
        "films need moviepy: run pip install -e '.[rendering]' in the clone"
    ) from error

_SIZES = {".mp4": (960, 720), ".gif": (640, 480)}  # pixels
_CODECS = {".mp4": "libx264", ".gif": "gif"}
_FFMPEG_OPTIONS = {
    # these options play in any player, even during the download
    ".mp4": ["-crf", "20", "-movflags", "+faststart"],
    # a palette for every frame: a common palette would need all frames before the first write
    ".gif": [
        "-vf",
        "split[drawn][seen];[seen]palettegen=stats_mode=single[palette];"
        "[drawn][palette]paletteuse=new=1:dither=none",
    ],
}


_SAMPLES = 6  # parts of a film for the estimate of its size
_SAMPLED = {".mp4": 12, ".gif": 4}  # frames of each part: the first frame of an mp4 is the largest
_ONE_LINE = 60  # characters of a caption that fit into one line of a gif
_PAST = 240.0  # [s] of the episode before a part whose trails are in its frames


def play(trajectory: Trajectory, speed: float, fps: int) -> None:
    """Show an episode in a window, ``speed`` times as fast as real time.

    Raises:
        OSError: If there is no display.
    """
    viewer = Viewer("human", frames_per_second=fps, caption=caption_of(trajectory, speed))
    try:
        for time in frame_times(trajectory, speed, fps):
            viewer.draw(scene_at(trajectory, float(time)))
            if viewer.closed:  # the user has closed the window
                break
    except RuntimeError as error:  # pygame raises it without a display
        raise OSError(f"no window can be opened ({error}): use --output") from None
    finally:
        viewer.close()


def caption_of(trajectory: Trajectory, speed: float) -> list[str]:
    """Return the caption of a film: policy, scenario, seed, episode and speed.

    It is one line, which covers less of the picture, unless names are long.
    """
    lines = [
        f"{visible(trajectory.policy)}, {visible(trajectory.scenario)}",
        f"seed {trajectory.seed}, episode {trajectory.episode}, {speed:.3g} x real time",
    ]
    whole = ", ".join(lines)
    return [whole] if len(whole) <= _ONE_LINE else lines


def estimate_bytes(trajectory: Trajectory, kind: str, speed: float, fps: int) -> float:
    """Return an estimate of the size of a film [bytes], from frames of different moments.

    It is the mean of the parts plus its standard error, because a film that turns out larger
    than its estimate is worse than a smaller one.

    Args:
        trajectory: The episode.
        kind: Suffix of the file, .mp4 or .gif.
        speed: Speed over real time.
        fps: Frames per second.

    Raises:
        OSError: If the frames cannot be written.
    """
    times, count = frame_times(trajectory, speed, fps), _SAMPLED[kind]
    if len(times) <= _SAMPLES * count:
        return 0.0
    sizes = []
    with tempfile.TemporaryDirectory() as folder:
        for start in np.linspace(0, len(times) - count, _SAMPLES).astype(int):
            path = pathlib.Path(folder) / f"{start}{kind}"
            before = times[:start][times[:start] >= times[start] - _PAST]
            part = times[start : start + count]
            _encode(trajectory, path, part, speed, fps, False, before)
            sizes.append(path.stat().st_size)
    mean = float(np.mean(sizes) + np.std(sizes, ddof=1) / np.sqrt(_SAMPLES))
    return mean / count * len(times)


def write_film(trajectory: Trajectory, path: pathlib.Path, speed: float, fps: int) -> float:
    """Write an episode as a film, with one frame in memory at a time; return its duration [s].

    Args:
        trajectory: The episode.
        path: Path of an .mp4 or .gif file, written whole or not at all.
        speed: Speed over real time.
        fps: Frames per second.

    Raises:
        OSError: If the film cannot be written.
    """
    times = frame_times(trajectory, speed, fps)
    with whole_file(path) as unfinished:
        _encode(trajectory, unfinished, times, speed, fps, True)
    return len(times) / fps


def _encode(
    trajectory: Trajectory,
    path: pathlib.Path,
    times: np.ndarray,
    speed: float,
    fps: int,
    shows_progress: bool,
    before: np.ndarray = np.zeros(0),
) -> None:
    """Draw and encode the frames at some times [s], with the trails of times before."""
    kind, bar = path.suffix, Console(stderr=True)
    caption = caption_of(trajectory, speed)
    viewer = Viewer("rgb_array", size=_SIZES[kind], frames_per_second=fps, caption=caption)
    try:
        for time in before:
            viewer.observe(scene_at(trajectory, float(time)))
        writer = FFMPEG_VideoWriter(
            str(path),
            _SIZES[kind],
            fps,
            codec=_CODECS[kind],
            preset="veryfast",  # of mp4: encoding takes less time than drawing
            ffmpeg_params=_FFMPEG_OPTIONS[kind],
        )
        encoder = writer.proc
        # the bar ends before an error is printed
        shown = Progress(console=bar, transient=True, disable=not shows_progress)
        with writer, shown:
            for time in shown.track(times, description="frames"):
                writer.write_frame(viewer.draw(scene_at(trajectory, float(time))))
        if encoder.returncode != 0:
            raise OSError("the film could not be finished: is the disk full?")
    finally:
        viewer.close()
