"""This module reads sites from well-known text (WKT): one geometry a line, in metres."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from hav_env.models.annotations import show
from hav_env.places.libraries import import_maps
from hav_env.places.outlines import read_chain, read_ring
from hav_env.places.site import LINE, POLYGON, Outline

_KINDS = "POLYGON, LINESTRING, their MULTI forms, GEOMETRYCOLLECTION"
_MOST_NESTED = 50  # brackets: GEOS reads nested collections by recursion


def read_wkt(text: str) -> list[Outline]:
    """Return the outlines of a text. It has no boundary, and heights are left out.

    Args:
        text: a geometry a line; empty lines and lines that begin with # are left out.

    Raises:
        ImportError: without the extra ``maps``.
        ValueError: naming the line and what is wrong with it.
    """
    shapely = import_maps("shapely")
    found: list[Outline] = []
    for number, line in enumerate(text.splitlines(), 1):
        words = line.strip()
        if not words or words.startswith("#"):
            continue
        if words.upper().startswith("SRID="):  # as PostGIS writes it
            words = words.partition(";")[2]
        deepest, rest = _scan(words)
        if deepest > _MOST_NESTED:
            told = f"line {number} has more than {_MOST_NESTED} nested brackets"
            raise ValueError(f"{told}, but must have fewer")
        if rest:
            raise ValueError(f"line {number} goes on by {show(rest)}, but must be one geometry")
        try:
            with np.errstate(all="ignore"):  # nan and inf, which are refused below
                geometry = shapely.from_wkt(words)
        except (shapely.errors.ShapelyError, NotImplementedError, ValueError) as error:
            told = f"line {number} is {show(words)}, but must be a geometry in WKT"
            raise ValueError(f"{told}: {show(str(error), str)}") from None
        found.extend(_read_shape(f"line {number}", geometry))
    return found


def _scan(words: str) -> tuple[int, str]:
    """Return how deep brackets are, and what follows the first geometry: older GEOS drops it."""
    deepest = depth = 0
    for place, letter in enumerate(words):
        depth += (letter == "(") - (letter == ")")
        deepest = max(deepest, depth)
        if letter == ")" and depth == 0:
            return deepest, words[place + 1 :].strip()
    return deepest, ""


def _read_shape(name: str, geometry: Any) -> Iterator[Outline]:
    """Yield the outlines of a Shapely geometry."""
    kind = geometry.geom_type
    if geometry.is_empty:
        return
    if kind == "Polygon":
        rings = [geometry.exterior, *geometry.interiors]
        yield POLYGON, [read_ring(name, _places(ring)) for ring in rings]
    elif kind in ("LineString", "LinearRing"):
        yield LINE, [read_chain(name, _places(geometry))]
    elif kind in ("MultiPolygon", "MultiLineString", "GeometryCollection"):
        for part in geometry.geoms:
            yield from _read_shape(name, part)
    else:
        raise ValueError(f"{name} is a {kind.upper()}, but must be one of: {_KINDS}")


def _places(line: Any) -> list:
    return [list(point[:2]) for point in line.coords]
