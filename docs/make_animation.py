"""This module draws two policies on one episode, side by side, as a small animated picture."""

import argparse
import pathlib

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from baselines.replay.trajectory import Trajectory, chain_points, record_trajectory
from hav_env import find_scenario, make_policy
from hav_env.rendering.colors import color_of
from hav_env.world.arrays import ACTUAL, JACKKNIFE, NEVER, WHEN

_PANEL, _HEADER, _GAP = 420, 64, 12  # pixels
_FINER = 2  # lines are drawn so many times larger, then shrunk: their edges become smooth
_MARGIN = 6.0  # m round all that is seen
_TRAIL = 60.0  # s of a trail
_ARROW = 9.0  # m
_PAPER, _INK, _PALE, _ALERT = (250, 250, 248), (38, 50, 56), (225, 228, 230), (190, 0, 50)
_STEPS_PER_STATE = 5
_MILLISECONDS = 80  # a frame
_HOLD = 3_000  # milliseconds for which the last frame stays
_COLORS = 256  # of the palette: fewer merge colours of HAVs


def _view_of(trajectories: list[Trajectory]) -> np.ndarray:
    """Return the corners (2, 2) of a box that holds everything [m]."""
    points = []
    for one in trajectories:
        points.append(one.goals[..., :2].reshape(-1, 2))
        points.append(np.stack([one.x, one.y], axis=-1).reshape(-1, 2))
    every = np.concatenate(points)
    return np.stack([every.min(axis=0) - _MARGIN, every.max(axis=0) + _MARGIN])


def _size_of(view: np.ndarray) -> tuple[int, int]:
    """Return width and height of a panel [pixels]."""
    width, height = view[1] - view[0]
    return _PANEL, 2 * round(_PANEL * height / width / 2)


def _row_at(trajectory: Trajectory, time: float) -> int:
    moments = trajectory.step * trajectory.dt
    return int(np.clip(np.searchsorted(moments, time + 1e-9, "right") - 1, 0, len(moments) - 1))


def _harmed(trajectory: Trajectory, event: int, time: float) -> np.ndarray:
    """Return which HAVs (N,) an event has happened to."""
    when = trajectory.first[:, event, WHEN]
    return (when != NEVER) & (when * trajectory.dt <= time)


def _draw_panel(trajectory: Trajectory, view: np.ndarray, time: float) -> Image.Image:
    """Draw trails, goals under way and HAVs of one policy at a time [s]."""
    width, height = (side * _FINER for side in _size_of(view))
    image = Image.new("RGB", (width, height), "white")
    pen = ImageDraw.Draw(image)
    pen.rectangle((0, 0, width - 1, height - 1), outline=_PALE, width=2 * _FINER)
    scale = width / (view[1, 0] - view[0, 0])

    def pixels(points: np.ndarray) -> list[tuple[float, float]]:
        away = (np.asarray(points) - view[0]) * scale
        return [(float(x), float(height - y)) for x, y in away]

    row = _row_at(trajectory, time)
    harmed = _harmed(trajectory, ACTUAL, time) | _harmed(trajectory, JACKKNIFE, time)
    past = slice(_row_at(trajectory, max(time - _TRAIL, 0.0)), row + 1)
    for hav in range(len(trajectory.length)):
        color = color_of(hav)[:3]
        faint = tuple(int(255 - 0.35 * (255 - part)) for part in color)
        trail = np.stack([trajectory.x[past, hav], trajectory.y[past, hav]], axis=-1)
        if len(trail) > 1:
            pen.line(pixels(trail), fill=faint, width=_FINER)
        x, y, heading = trajectory.goals[hav, trajectory.phase[row, hav]]
        ahead = np.array([np.cos(heading), np.sin(heading)])
        aside = np.array([-ahead[1], ahead[0]])
        tip = np.array([x, y]) + _ARROW / 2.0 * ahead
        tail = np.array([x, y]) - _ARROW / 2.0 * ahead
        head = [tip, tip - 0.45 * _ARROW * (ahead - 0.6 * aside)]
        head += [tip - 0.45 * _ARROW * (ahead + 0.6 * aside)]
        pen.line(pixels([tail, tip]), fill=color, width=_FINER)
        pen.polygon(pixels(head), fill=color)
    for hav in range(len(trajectory.length)):
        color = color_of(hav)[:3]
        chain = pixels(chain_points(trajectory, hav, row))
        if harmed[hav]:
            pen.line(chain, fill=_ALERT, width=9 * _FINER, joint="curve")
        pen.line(chain, fill=color, width=5 * _FINER, joint="curve")
        pen.line(chain[:2], fill=_INK, width=7 * _FINER)
    return image.resize(_size_of(view), Image.Resampling.LANCZOS)


def _summary(trajectory: Trajectory, time: float) -> str:
    """Return how many goals were hit and how many HAVs were harmed until a time [s]."""
    hit = trajectory.hit_step
    done = int(((hit != NEVER) & (hit * trajectory.dt <= time)).sum())
    counts = [f"{done} of {hit.size} goals"]
    for name, event in (("collided", ACTUAL), ("jackknifed", JACKKNIFE)):
        number = int(_harmed(trajectory, event, time).sum())
        counts += [f"{number} {name}"] if number else []
    return ", ".join(counts)


def _draw_frame(named: dict[str, Trajectory], view: np.ndarray, time: float) -> Image.Image:
    """Draw the panels of all policies beside each other, each with its heading."""
    width = len(named) * (_PANEL + _GAP) + _GAP
    frame = Image.new("RGB", (width, _HEADER + _size_of(view)[1] + _GAP), _PAPER)
    pen = ImageDraw.Draw(frame)
    title, text = ImageFont.load_default(size=22), ImageFont.load_default(size=16)
    for column, (name, trajectory) in enumerate(named.items()):
        left = _GAP + column * (_PANEL + _GAP)
        pen.text((left, 8), name, _INK, title)
        pen.text((left, 38), _summary(trajectory, time), _INK, text)
        pen.text((left + _PANEL, 38), f"{time:.0f} s", _INK, text, anchor="ra")
        frame.paste(_draw_panel(trajectory, view, time), (left, _HEADER))
    return frame


def main() -> None:
    """Record the episode under each policy, and write the animation."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("output", type=pathlib.Path, help="the .gif file to write")
    parser.add_argument("--policies", nargs="+", default=["avoid_jack", "reserve"])
    parser.add_argument("--scenario", default="swarm-10")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=670.0, help="of the episode to show [s]")
    parser.add_argument("--frames", type=int, default=135)
    options = parser.parse_args()
    named = {}
    for name in options.policies:
        episode = make_policy(name), find_scenario(options.scenario), options.seed, 0
        named[name] = record_trajectory(*episode, every=_STEPS_PER_STATE)
    ends = [_row_at(one, options.seconds) for one in named.values()]
    shown = [
        one._replace(x=one.x[:end], y=one.y[:end])
        for one, end in zip(named.values(), ends, strict=True)
    ]
    view = _view_of(shown)
    times = np.linspace(0.0, options.seconds, options.frames)
    frames = [_draw_frame(named, view, float(time)) for time in times]
    # one palette for all: the file then stores unchanged parts of frames once
    palette = Image.new("RGB", (frames[0].width, 4 * frames[0].height))
    for part in range(4):
        palette.paste(frames[(part + 1) * (len(frames) - 1) // 4], (0, part * frames[0].height))
    palette = palette.quantize(_COLORS)
    drawn = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    durations = [_MILLISECONDS] * (len(drawn) - 1) + [_HOLD]
    drawn[0].save(
        options.output, save_all=True, append_images=drawn[1:], duration=durations, loop=0
    )


if __name__ == "__main__":
    main()
