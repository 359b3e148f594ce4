"""This module reads sites from well-known text (WKT): one geometry a line, in metres."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from hav_env.models.annotations import show
from hav_env.places.libraries import import_maps
from hav_env.places.outlines import read_chain, read_ring
from hav_env.places.site import LINE, POLYGON, Outline

_KINDS = "POLYGON, LINESTRING, their MULTI forms, GEOMETRYCOLLECTION"
_MOST_NESTED = 50  # nesting of brackets: GEOS reads collections by recursion


def read_wkt(text: str) -> list[Outline]:
    """Return the outlines of a text, without heights; the format has no boundary.

    Args:
        text: one geometry per line; empty lines and lines that begin with # are ignored.

    Raises:
        ImportError: without the extra ``maps``.
        ValueError: if a line is wrong; the message names it and the rule.
    """
    shapely = import_maps("shapely")
    found: list[Outline] = []
    for number, line in enumerate(text.splitlines(), 1):
        words = line.strip()
        if not words or words.startswith("#"):
            continue
        if words.upper().startswith("SRID="):  # the form that PostGIS writes
            words = words.partition(";")[2]
        deepest, rest = _scan(words)
        if deepest > _MOST_NESTED:
            told = f"line {number} has more than {_MOST_NESTED} nested brackets"
            raise ValueError(f"{told}, but must have fewer")
        if rest:
            raise ValueError(f"line {number} goes on by {show(rest)}, but must be one geometry")
        try:
            with np.errstate(all="ignore"):  # nan and inf, which are rejected below
                geometry = shapely.from_wkt(words)
        except (shapely.errors.ShapelyError, NotImplementedError, ValueError) as error:
            told = f"line {number} is {show(words)}, but must be a geometry in WKT"
            raise ValueError(f"{told}: {show(str(error), str)}") from None
        found.extend(_read_shape(f"line {number}", geometry))
    return found


def _scan(words: str) -> tuple[int, str]:
    """Return the depth of brackets, and the text after the first geometry: older GEOS drops it."""
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
