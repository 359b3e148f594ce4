"""This module plays an episode frame by frame, in a window or into a film."""

import pathlib

import rich.progress
from rich.console import Console
from rich.markup import escape

from baselines.replay.interpolation import frame_times, scene_at
from baselines.replay.trajectory import Trajectory
from baselines.storage.atomic_files import whole_file
from hav_env.models.text import visible
from hav_env.rendering.viewer import Viewer

try:
    from moviepy.video.io.ffmpeg_writer import FFMPEG_VideoWriter
except ImportError as error:
    raise ImportError("films need moviepy: pip install 'hav_env[rendering]'") from error

_SIZES = {".mp4": (960, 720), ".gif": (640, 480)}  # pixels
_CODECS = {".mp4": "libx264", ".gif": "gif"}
_FFMPEG_OPTIONS = {
    # plays while it loads, and everywhere
    ".mp4": ["-crf", "20", "-movflags", "+faststart"],
    # a palette of its own for every frame: one for all of them would have to wait for the last
    ".gif": [
        "-vf",
        "split[drawn][seen];[seen]palettegen=stats_mode=single[palette];"
        "[drawn][palette]paletteuse=new=1:dither=none",
    ],
}


def play(trajectory: Trajectory, speed: float, fps: int) -> None:
    """Show an episode in a window, ``speed`` times as fast as it was.

    Raises:
        OSError: when there is no display.
    """
    viewer = Viewer("human", frames_per_second=fps)
    try:
        for time in frame_times(trajectory, speed, fps):
            viewer.draw(scene_at(trajectory, float(time)))
            if viewer.closed:  # by whom watches
                break
    except RuntimeError as error:  # pygame's, where there is no display
        raise OSError(f"no window can be opened ({error}): use --output") from None
    finally:
        viewer.close()


def write_film(trajectory: Trajectory, path: pathlib.Path, speed: float, fps: int) -> None:
    """Write an episode as a film, frame by frame: no more than one is held at a time.

    Args:
        trajectory: the episode.
        path: of an .mp4 or .gif file, which is written whole or not at all.
        speed: times real time.
        fps: frames per second.

    Raises:
        OSError: when the film cannot be written.
    """
    kind = path.suffix
    viewer = Viewer("rgb_array", size=_SIZES[kind], frames_per_second=fps)
    times = frame_times(trajectory, speed, fps)
    try:
        with whole_file(path) as unfinished:
            writer = FFMPEG_VideoWriter(
                str(unfinished),
                _SIZES[kind],
                fps,
                codec=_CODECS[kind],
                preset="veryfast",  # of mp4: drawing should be what takes the time
                ffmpeg_params=_FFMPEG_OPTIONS[kind],
            )
            encoder = writer.proc
            with writer:
                name, bar = escape(visible(path.name)), Console(stderr=True)
                for time in rich.progress.track(times, name, console=bar, transient=True):
                    writer.write_frame(viewer.draw(scene_at(trajectory, float(time))))
            if encoder.returncode != 0:
                raise OSError(f"the film {path} could not be finished: is the disk full?")
    finally:
        viewer.close()
