"""This module draws the sites of scenarios: ``python -m baselines.figures.site_pictures``.

Each picture shows walls and kerbs, the vehicles where an episode starts, and the drives that lead
from place to place.
"""

import dataclasses
import pathlib
import sys

import numpy as np

from baselines.figures.trajectory_plot import (
    BLUE,
    DARK,
    GREEN,
    GREY,
    LIGHT,
    ORANGE,
    PURPLE,
    Axes,
    Figure,
    Line2D,
    PolyCollection,
    new_figure,
    save_figure,
    sheet,
)
from baselines.sites.chain_motion import chain_of, corner_points
from baselines.sites.drives import DRIVE_FOLDER, Path, read_paths
from baselines.sites.follow import places_in
from hav_env import Batch
from hav_env.cli.options import run_command
from hav_env.models.text import visible
from hav_env.places import BOUNDARY, LINE, chains_of
from hav_env.scenarios.presets import SITES
from hav_env.scenarios.sites import SITE_VEHICLES
from hav_env.vehicles import VEHICLES as MODELS
from hav_env.vehicles import catalogue

_PICTURED_SEED = 1
_WIDTH = 7.0  # inches
_HIGHEST = 6.4
_KIND_COLORS = (BLUE, ORANGE, GREEN, PURPLE)  # of vehicles: a picture has many HAVs of each


@dataclasses.dataclass(frozen=True)
class Options:
    """Folders of pictures and drives, and the sites to draw."""

    sites: tuple[str, ...] = tuple(SITES)
    """Names of scenarios."""
    output: pathlib.Path = pathlib.Path("docs/images")
    """Folder of site_*.png; existing files are replaced."""
    drives: pathlib.Path = DRIVE_FOLDER
    """Folder of the drives."""


def main(words: list[str] | None = None) -> int:
    """Draw, and return the exit code. An error is reported in one line."""
    usage, about = "python -m baselines.figures.site_pictures", "Draw the sites of scenarios."
    return run_command(usage, about, Options(), illustrate, words, "no file is partly written")


def illustrate(options: Options) -> str:
    """Write the pictures, and return their paths and the lengths of the drives.

    Raises:
        ValueError: A site is unknown.
        OSError: The folder cannot be written.
    """
    lines = []
    for name in options.sites:
        if name not in SITES:
            raise ValueError(f"unknown site {name!r}; known: {', '.join(SITES)}")
        paths = read_paths(name, options.drives)
        figure = draw_site(name, paths)
        (file,) = save_figure(figure, options.output, f"site_{name}", ("png",))
        ways = [_length(path) for path in paths]
        lines.append(
            f"{visible(str(options.output / file))}: {len(paths)} drives of {min(ways):.0f} to"
            f" {max(ways):.0f} m, {SITES[name].site.num_segments} segments"
        )
    return "\n".join(lines)


@sheet
def draw_site(name: str, paths: list[Path]) -> Figure:
    """Draw a site with the HAVs at the start of an episode, and all drives.

    Args:
        name: Name of a scenario in ``SITES``.
        paths: Drives of the site.
    """
    scenario = SITES[name]
    x0, y0, x1, y1 = scenario.site.bounds
    figure = new_figure(min(_HIGHEST, _WIDTH * (y1 - y0) / (x1 - x0)) + 0.5)
    axes = figure.subplots()
    for kind, points in chains_of(scenario.site):
        if kind in (BOUNDARY, LINE):
            axes.plot(*points.T, color=DARK, lw=1.0, zorder=3)
        else:
            axes.fill(*points.T, fc=GREY, ec=DARK, lw=0.6, zorder=3)
    for path in paths:
        color = _KIND_COLORS[SITE_VEHICLES[name].index(path.vehicle) % len(_KIND_COLORS)]
        axes.plot(*path.points[:, :2].T, color=color, lw=0.35, alpha=0.6, zorder=2)
    ahead = 0.02 * max(x1 - x0, y1 - y0)
    for x, y, heading in scenario.place:
        tip = ahead * np.cos(heading), ahead * np.sin(heading)
        axes.annotate(
            "",
            (x + tip[0], y + tip[1]),
            (x, y),
            arrowprops={"arrowstyle": "->", "color": DARK, "lw": 0.8},
            zorder=6,
        )
    _draw_start(axes, name)
    axes.set(aspect="equal", xlabel="x [m]", ylabel="y [m]")
    axes.margins(0.02)
    handles = [
        Line2D([], [], color=_KIND_COLORS[k % 4], lw=0.8, label=f"drives of {vehicle}")
        for k, vehicle in enumerate(SITE_VEHICLES[name])
    ]
    square: dict = {"ls": "", "marker": "s", "ms": 6}
    handles += [
        Line2D([], [], color=BLUE, label="truck at the start", **square),
        Line2D([], [], color=ORANGE, label="its trailers", **square),
        Line2D([], [], color=DARK, ls="", marker=r"$\rightarrow$", ms=8, label="place"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    return figure


def _draw_start(axes: Axes, name: str) -> None:
    """Draw the HAVs of one episode at their starts."""
    scenario = SITES[name]
    batch = Batch(scenario, 1, vehicle=MODELS.make("realistic"))
    batch.reset(_PICTURED_SEED)
    for hav in range(scenario.num_havs):
        kinds, _ = places_in(scenario, batch, hav)
        chain = chain_of(catalogue(SITE_VEHICLES[name][int(kinds[0])]))
        state = batch.worlds.state
        units = len(chain.lengths)
        row = [state.x[hav, 0], state.y[hav, 0], *state.heading[hav, :units, 0]]
        corners = corner_points(chain, np.array(row)[None])[0]
        for unit, outline in enumerate(corners[::-1]):
            color = BLUE if unit == units - 1 else ORANGE
            axes.add_collection(PolyCollection([outline], fc=color, ec=LIGHT, lw=0.3, zorder=5))


def _length(path: Path) -> float:
    return float(np.hypot(*np.diff(path.points[:, :2], axis=0).T).sum())


if __name__ == "__main__":
    sys.exit(main())
