"""This module draws the figures of docs/vehicles.md: ``python -m baselines.figures.catalogue``.

The first figure shows all vehicles of the catalogue from above, to one scale. The second figure
shows each vehicle in a turn round a corner. The command also writes docs/vehicle-dimensions.md, and
prints the table of docs/vehicles.md.
"""

import dataclasses
import pathlib
import sys

import numpy as np

from baselines.figures.right_angle_turn import Turn, body_points, usual_turn
from baselines.figures.trajectory_plot import (
    BLUE,
    DARK,
    GREY,
    LIGHT,
    ORANGE,
    Axes,
    Figure,
    Line2D,
    PolyCollection,
    new_figure,
    save_figure,
    sheet,
)
from baselines.figures.vehicle_tables import dimension_page, turn_table
from baselines.storage.atomic_files import whole_file
from hav_env.cli.options import run_command
from hav_env.models.text import visible
from hav_env.vehicles import COMBINATIONS, Combination, Unit, catalogue

_SCALE_BAR = 10.0  # [m]
_ROW_LENGTH = 60.0  # [m] length of a row of vehicles
_ROW_HEIGHT = 7.0  # [m] height of a row with its names
_BESIDE = 5.0  # [m] between two vehicles of a row
_SHOWN = 3  # moments of a turn that are drawn
_PANELS_ABREAST = 3  # turns in a row
_EACH = 8  # every so many moments of a turn, for the swept area
_WHEEL = 0.9  # [m] diameter of a wheel


@dataclasses.dataclass(frozen=True)
class Options:
    """Folder of the pages."""

    output: pathlib.Path = pathlib.Path("docs")
    """Folder of vehicle-dimensions.md and of images/vehicle*.png; existing files are replaced."""


def main(words: list[str] | None = None) -> int:
    """Draw and write, and return the exit code. An error is reported in one line."""
    usage, about = "python -m baselines.figures.catalogue", "Draw the catalogue of vehicles."
    return run_command(usage, about, Options(), illustrate, words, "no file is partly written")


def illustrate(options: Options) -> str:
    """Write the pictures and the page, and return their paths and the table of docs/vehicles.md.

    Raises:
        ValueError: The output is a file.
        OSError: The folder cannot be written.
    """
    if options.output.exists() and not options.output.is_dir():
        raise ValueError(f"output {options.output} is a file, but must be a folder")
    images = options.output / "images"
    images.mkdir(parents=True, exist_ok=True)
    vehicles = [catalogue(name) for name in COMBINATIONS.names()]
    figures = {"vehicles": draw_vehicles(vehicles), "vehicle_turns": draw_turns(vehicles)}
    paths = []
    for name, figure in figures.items():
        paths += [images / file for file in save_figure(figure, images, name, ("png",))]
    paths.append(options.output / "vehicle-dimensions.md")
    with whole_file(paths[-1]) as unfinished:
        pathlib.Path(unfinished).write_text(dimension_page())
    return "\n".join([*(visible(str(path)) for path in paths), "", turn_table()])


@sheet
def draw_vehicles(vehicles: list[Combination]) -> Figure:
    """Draw vehicles from above, all to one scale, from left to right.

    Args:
        vehicles: Vehicles to draw; short ones share a row.
    """
    rows = _share_rows(vehicles)
    figure = new_figure(7.0 * len(rows) * _ROW_HEIGHT / _ROW_LENGTH + 0.4)
    axes = figure.subplots()
    for place, row in enumerate(rows):
        left, y = 0.0, -place * _ROW_HEIGHT
        for vehicle in row:
            _draw_straight(axes, vehicle, left, y)
            left += vehicle.overall_length + _BESIDE
    end, y = _ROW_LENGTH, -(len(rows) - 1) * _ROW_HEIGHT - 2.6
    axes.plot([end - _SCALE_BAR, end], [y, y], color=DARK, lw=1.5, solid_capstyle="butt")
    axes.annotate(f"{_SCALE_BAR:.0f} m", (end - _SCALE_BAR / 2, y + 0.3), ha="center", fontsize=7)
    axes.set(aspect="equal", xlim=(-1.0, _ROW_LENGTH + 1.0), ylim=(y - 0.8, 5.4))
    axes.axis("off")
    figure.legend(handles=_legend(), loc="outside lower center", ncols=4)
    return figure


@sheet
def draw_turns(vehicles: list[Combination]) -> Figure:
    """Draw vehicles in a turn round a corner, each to its own scale.

    Args:
        vehicles: Vehicles to draw.
    """
    lines = -(-len(vehicles) // _PANELS_ABREAST)
    figure = new_figure(2.15 * lines)
    panels = figure.subplots(lines, _PANELS_ABREAST, squeeze=False)
    for axes, vehicle in zip(panels.flat, vehicles, strict=False):
        turn = usual_turn(vehicle)
        _draw_turn(axes, turn)
        axes.set_title(f"{vehicle.name}, R = {turn.radius:.1f} m")
    for axes in panels.flat[len(vehicles) :]:
        axes.axis("off")
    return figure


def _share_rows(vehicles: list[Combination]) -> list[list[Combination]]:
    """Return rows of vehicles in their order, with as many in each as fit."""
    rows: list[list[Combination]] = []
    space = 0.0
    for vehicle in vehicles:
        if space < vehicle.overall_length:
            rows.append([])
            space = _ROW_LENGTH
        rows[-1].append(vehicle)
        space -= vehicle.overall_length + _BESIDE
    return rows


def _draw_straight(axes: Axes, vehicle: Combination, left: float, y: float) -> None:
    """Draw a vehicle with heading to the right, its rear end at ``left``."""
    ends = vehicle.straight_ends
    shift = left - min(
        axle - unit.rear for unit, (_, axle) in zip(vehicle.units, ends, strict=True)
    )
    outlines = []
    for unit, (front_end, axle) in zip(vehicle.units, ends, strict=True):
        along = shift + np.array([axle - unit.rear, front_end + unit.front])[[0, 1, 1, 0]]
        aside = y + unit.half_width * np.array([-1.0, -1.0, 1.0, 1.0])
        outlines.append(np.stack([along, aside], axis=-1))
    _fill_bodies(axes, vehicle, outlines)
    for place, (unit, (front_end, axle)) in enumerate(zip(vehicle.units, ends, strict=True)):
        half = max(unit.half_width, 0.35)
        for x in (axle, front_end) if place == 0 else (axle,):
            for side in (-half, half):
                wheel = shift + x + np.array([-_WHEEL, _WHEEL]) / 2
                axes.plot(wheel, [y + side] * 2, color=DARK, lw=1.6, zorder=4)
        if place:
            axes.plot(shift + front_end, y, "o", color=DARK, ms=2.2, zorder=5)
    text = f"{vehicle.name}, {vehicle.overall_length:.4g} m\n{vehicle.title}"
    axes.annotate(text, (left, y + 1.7), fontsize=6.5, va="bottom", linespacing=1.3)


def _fill_bodies(axes: Axes, vehicle: Combination, outlines: list[np.ndarray]) -> None:
    """Fill the outlines of all units, the lowest layer first."""
    for place, (unit, outline) in enumerate(zip(vehicle.units, outlines, strict=True)):
        color, height = _look(vehicle, place, unit)
        axes.fill(*outline.T, fc=color, alpha=0.55, ec="none", zorder=height)
        axes.fill(*outline.T, fill=False, ec=color if color != LIGHT else GREY, lw=0.7, zorder=3)


def _look(vehicle: Combination, place: int, unit: Unit) -> tuple[str, float]:
    """Return the colour of a unit, and its drawing layer."""
    if place == 0:
        return BLUE, 2.0
    carries_next = place + 1 < len(vehicle.units) and vehicle.units[place + 1].hitch == 0.0
    bare = unit.front == 0.0 and carries_next  # a drawbar or a dolly
    return (LIGHT, 1.0) if bare else (ORANGE, 2.0)


def _draw_turn(axes: Axes, turn: Turn) -> None:
    """Draw the swept area, the paths of the first and of the last axle, and some moments."""
    gone = turn.axles[:, -1, 1] > turn.radius  # past the arc
    final = int(np.argmax(gone)) if gone.any() else len(gone) - 1
    swept = body_points(turn, slice(0, final, _EACH))
    axes.add_collection(
        PolyCollection(list(swept.reshape(-1, *swept.shape[2:])), color=LIGHT, zorder=1)
    )
    for moment in np.linspace(0, final, _SHOWN).astype(int):
        _fill_bodies(axes, turn.vehicle, list(body_points(turn, slice(moment, moment + 1))[0]))
    ahead = turn.axles[:final, 0] + turn.vehicle.lengths[0] * np.stack(
        [np.cos(turn.headings[:final, 0]), np.sin(turn.headings[:final, 0])], axis=-1
    )
    axes.plot(*ahead.T, color=BLUE, lw=0.8, zorder=6)
    axes.plot(*turn.axles[:final, -1].T, color=DARK, lw=0.8, ls=(0, (3, 1.5)), zorder=6)
    axes.set(aspect="equal")
    axes.margins(0.03)


def _legend() -> list[Line2D]:
    square: dict = {"ls": "", "marker": "s", "ms": 8, "alpha": 0.55}
    return [
        Line2D([], [], color=BLUE, label="truck", **square),
        Line2D([], [], color=ORANGE, label="trailer", **square),
        Line2D([], [], mfc=LIGHT, mec=GREY, label="drawbar or dolly", **square),
        Line2D([], [], color=DARK, ls="", marker="o", ms=2.2, label="hitch; bars are axles"),
    ]


if __name__ == "__main__":
    sys.exit(main())
