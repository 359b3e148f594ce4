"""This module describes a site in a file, for ``python -m hav_env site``, and draws it."""

import dataclasses
import pathlib
from typing import Annotated

import tyro

from hav_env.places import BOUNDARY, LINE, POLYGON, Site, load_site
from hav_env.places.areas import covered_area, free_area
from hav_env.places.loading import Unknown


@dataclasses.dataclass
class DescribeSite:
    """The options of the description of a site."""

    file: Annotated[str, tyro.conf.Positional]
    """A site: JSON, GeoJSON, WKT, a map of ROS (yaml), or CommonRoad (xml)."""
    draw: str | None = None
    """A picture of it, FILE.png."""
    tolerance: float | None = None
    """How far outlines may be from those in the file, to leave out points [m]."""
    unknown: Unknown = "free"
    """Meaning of unknown cells of maps of ROS: free, or occupied."""


def describe_site(options: DescribeSite) -> None:
    """Print what a file holds, and draw it.

    Raises:
        ValueError: when the file is wrong, naming the entry, or the picture has another ending.
        OSError: when a file cannot be read or written.
        ImportError: when an extra is missing.
    """
    picture = None if options.draw is None else pathlib.Path(options.draw)
    if picture is not None and picture.suffix.lower() != ".png":
        raise ValueError(f"draw is {options.draw!r}, but must end in .png")
    site = load_site(options.file, tolerance=options.tolerance, unknown=options.unknown)
    print(summarize_site(site))
    if picture is not None:
        # pygame takes its time, and is in an extra of its own
        from hav_env.cli.site_picture import save_picture  # noqa: PLC0415

        save_picture(site, pathlib.Path(options.file).name, picture)
        print(f"drawn in {picture}")


def summarize_site(site: Site) -> str:
    """Return what a site consists of, in a few lines.

    Args:
        site: as ``load_site`` returns it.

    Raises:
        ImportError: without the extra ``maps``.
    """
    left, low, right, high = site.bounds
    free = free_area(site)
    inside = "no boundary" if free is None else f"{free.area:,.2f} m2"
    count = {kind: int((site.kind == kind).sum()) for kind in (BOUNDARY, POLYGON, LINE)}
    rows = {
        "boundaries": count[BOUNDARY],
        "polygons": f"{count[POLYGON]}, {covered_area(site).area:,.2f} m2",
        "lines": count[LINE],
        "segments": site.num_segments,
        "bounds": f"x {left:.3f} to {right:.3f} m, y {low:.3f} to {high:.3f} m",
        "area inside": inside,
    }
    return "\n".join(f"{name:12} {told}" for name, told in rows.items())
