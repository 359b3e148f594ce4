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
        if _depth(words) > _MOST_NESTED:
            told = f"line {number} has more than {_MOST_NESTED} nested brackets"
            raise ValueError(f"{told}, but must have fewer")
        try:
            with np.errstate(invalid="ignore"):  # of nan, which is refused below
                geometry = shapely.from_wkt(words)
        except (shapely.errors.ShapelyError, NotImplementedError, ValueError) as error:
            told = f"line {number} is {show(words)}, but must be a geometry in WKT"
            raise ValueError(f"{told}: {show(str(error), str)}") from None
        found.extend(_read_shape(f"line {number}", geometry))
    return found


def _depth(words: str) -> int:
    deepest = depth = 0
    for letter in words:
        depth += (letter == "(") - (letter == ")")
        deepest = max(deepest, depth)
    return deepest


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
