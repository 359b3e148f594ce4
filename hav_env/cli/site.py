"""This module describes and draws the site in a file, for ``hav-env site``."""

import dataclasses
import pathlib
from typing import Annotated

import tyro

from hav_env.cli.errors import report_errors
from hav_env.cli.options import parse_options
from hav_env.places import BOUNDARY, LINE, POLYGON, Site, load_site
from hav_env.places.areas import covered_area, free_area
from hav_env.places.loading import Unknown

_ABOUT_SITE = (
    "Describe a file of a site, and draw it: JSON, GeoJSON, WKT, a map of ROS (yaml), or"
    " CommonRoad (xml)."
)


def main(words: list[str]) -> int:
    """Describe a file of a site, and draw it."""

    def run(words: list[str]) -> None:
        describe_site(parse_options(DescribeSite, "hav-env site FILE", _ABOUT_SITE, words))

    return report_errors(run, words)


@dataclasses.dataclass
class DescribeSite:
    """Options of ``hav-env site``."""

    file: Annotated[str, tyro.conf.Positional]
    """Site: JSON, GeoJSON, WKT, a map of ROS (yaml), or CommonRoad (xml)."""
    draw: str | None = None
    """Picture of the site, FILE.png."""
    tolerance: float | None = None
    """Largest distance of simplified outlines from those in the file [m]."""
    unknown: Unknown = "free"
    """Meaning of unknown cells of maps of ROS: free, or occupied."""


def describe_site(options: DescribeSite) -> None:
    """Print the content of a file, and draw it.

    Raises:
        ValueError: If the file is invalid (the message names the entry), or the picture has
            another suffix.
        OSError: If a file cannot be read or written.
        ImportError: If an extra is missing.
    """
    picture = None if options.draw is None else pathlib.Path(options.draw)
    if picture is not None and picture.suffix.lower() != ".png":
        raise ValueError(f"draw is {options.draw!r}, but must end in .png")
    site = load_site(options.file, tolerance=options.tolerance, unknown=options.unknown)
    print(summarize_site(site))
    if picture is not None:
        # pygame is slow to import, and an extra
        from hav_env.cli.site_picture import save_picture  # noqa: PLC0415

        save_picture(site, pathlib.Path(options.file).name, picture)
        print(f"drawn in {picture}")


def summarize_site(site: Site) -> str:
    """Return the content of a site as text, in a few lines.

    Args:
        site: A site, as from ``load_site``.

    Raises:
        ImportError: If the extra ``maps`` is missing.
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
