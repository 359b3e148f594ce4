"""This module loads sites from files: own JSON, GeoJSON, WKT, maps of ROS, CommonRoad."""

import os
import pathlib
from typing import Any, Literal

from hav_env.models.annotations import show
from hav_env.models.checks import check_fields, check_value
from hav_env.models.json_files import read_json
from hav_env.models.quantities import Distance
from hav_env.places.formats.commonroad import read_commonroad
from hav_env.places.formats.geojson import GEOJSON_TYPES, read_geojson
from hav_env.places.formats.occupancy_maps import read_occupancy_map
from hav_env.places.formats.well_known_text import read_wkt
from hav_env.places.simplification import simplify_outlines
from hav_env.places.site import Outline, Site, join_outlines
from hav_env.places.site_files import read_outlines

Unknown = Literal["free", "occupied"]
_MOST_BYTES = 2**25
_KNOWN_ENDINGS = (".json", ".geojson", ".wkt", ".yaml", ".yml", ".xml")


def load_site(
    path: str | os.PathLike[str], *, tolerance: float | None = None, unknown: Unknown = "free"
) -> Site:
    """Load a site from a file; all coordinates are in m. docs/sites.md describes the formats.

    Args:
        path: a file that ends in ``.json`` (the project's own form, or GeoJSON), ``.geojson``,
            ``.wkt``, ``.yaml`` or ``.yml`` (a map of ROS's map_server, with its image), or ``.xml``
            (CommonRoad).
        tolerance: largest deviation of simplified outlines from those in the file [m]; by default
            half a cell for maps of ROS, and 0 for all others.
        unknown: whether cells of a map that are neither occupied nor free are "free" or "occupied".

    Raises:
        ValueError: if an entry is wrong; the message names the file, the entry and the rule.
        OSError: if the system cannot read a file.
        ImportError: if the file needs the missing extra ``maps``.
    """
    check_value("tolerance", Distance | None, tolerance)
    check_value("unknown", Unknown, unknown)
    file = pathlib.Path(path)
    ending = file.suffix.lower()
    if ending not in _KNOWN_ENDINGS:
        told = f"{file} ends in {show(ending)}, but must end in one of: {', '.join(_KNOWN_ENDINGS)}"
        raise ValueError(told)
    if ending in (".json", ".geojson"):
        return read_json(
            file, "site", _MOST_BYTES, lambda data: _finish(_from_json(data), tolerance)
        )
    try:
        if ending in (".yaml", ".yml"):
            outlines = read_occupancy_map(file, tolerance, unknown == "occupied")
            return _finish(outlines, None)  # they are simple already
        content = _read_bytes(file)
        outlines = read_commonroad(content) if ending == ".xml" else read_wkt(_decode(content))
        return _finish(outlines, tolerance)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{file}: {error}") from None


def _finish(outlines: list[Outline], tolerance: float | None) -> Site:
    """Return the site of the outlines in a file."""
    if not outlines:
        raise ValueError("the file has no outline, but must have at least one")
    if tolerance:
        outlines = simplify_outlines(outlines, tolerance)
    site = join_outlines(outlines)
    check_fields("site", site)
    return site


def _from_json(data: Any) -> list[Outline]:
    if isinstance(data, dict) and data.get("type") in GEOJSON_TYPES:
        return read_geojson(data)
    return read_outlines(data)


def _read_bytes(file: pathlib.Path) -> bytes:
    with open(file, "rb") as opened:
        content = opened.read(_MOST_BYTES + 1)
    if len(content) > _MOST_BYTES:
        raise ValueError(f"the file has more than {_MOST_BYTES} bytes, the most of a site")
    return content


def _decode(content: bytes) -> str:
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ValueError(f"the file is not in UTF-8: {error}") from None
