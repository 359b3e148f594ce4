"""This module reads sites from GeoJSON: features whose coordinates are metres."""

import re
from collections.abc import Iterator
from typing import Any

import numpy as np

from hav_env.models.annotations import is_number, show
from hav_env.places.outlines import read_chain, read_circle, read_ring
from hav_env.places.site import BOUNDARY, LINE, POLYGON, Outline

GEOJSON_TYPES = (
    *("FeatureCollection", "Feature", "GeometryCollection", "Polygon", "MultiPolygon"),
    *("LineString", "MultiLineString", "Point", "MultiPoint"),
)
_DEEPEST = 10  # collections in collections
_LEAST_EXTENT = 1.0  # side of a site in metres; in degrees it is 111 km
_CODES = "4326|4979|4258|4267|4269|4283|4490|4617|4674|7844"  # frequent codes of EPSG
_GEOGRAPHIC = rf"(?i)CRS:?84\b|EPSG\W+([\d.]+\W+)?({_CODES})$|^WGS[ _]?(19)?84$"
_PROJECT = "project it to metres first, for example by ogr2ogr -t_srs EPSG:32632 (UTM zone 32)"


def read_geojson(data: Any) -> list[Outline]:
    """Return the outlines of the parsed JSON of a GeoJSON file.

    A Polygon feature with the property ``boundary`` true is the boundary. A Point with the property
    ``radius`` [m] is a circle. The reader ignores heights.

    Raises:
        TypeError, ValueError: if an entry is wrong; the message names its value and the rule.
            Longitudes and latitudes are rejected.
    """
    named = _check_crs(data)
    found = list(_read_object("", data, {}, 0))
    boundaries = [name for name, (kind, _) in found if kind == BOUNDARY]
    if len(boundaries) > 1:
        told = f"{boundaries[1]} is a boundary, and {boundaries[0]} is"
        raise ValueError(f"{told}, but there must be at most one")
    if found and not named:
        _check_metres(np.concatenate([chain for _, (_, chains) in found for chain in chains]))
    return [outline for _, outline in found]


def _check_crs(data: Any) -> bool:
    """Return whether a file names its coordinate reference system; reject one in degrees."""
    crs = data.get("crs") if isinstance(data, dict) else None
    if crs is None:
        return False
    properties = crs.get("properties") if isinstance(crs, dict) else None
    name = properties.get("name") if isinstance(properties, dict) else crs
    if not isinstance(name, str):
        raise ValueError(f"crs is {show(crs)}, but must be a name, or have properties with one")
    if re.search(_GEOGRAPHIC, name):
        raise ValueError(f"crs is {show(name)}, longitudes and latitudes: {_PROJECT}")
    return True


def _check_metres(points: np.ndarray) -> None:
    """Reject coordinates that must be degrees: all within 1 of each other, and in their range."""
    width, height = np.ptp(points, axis=0)
    if max(width, height) < _LEAST_EXTENT and (abs(points) <= (180.0, 90.0)).all():
        x, y = points[0]
        raise ValueError(
            f"all coordinates lie within {width:.3g} by {height:.3g} of each other, as at ({x:.9g},"
            f" {y:.9g}): longitudes and latitudes? Then {_PROJECT}; if not, name a crs"
        )


def _read_object(
    name: str, value: Any, properties: dict, depth: int
) -> Iterator[tuple[str, Outline]]:
    """Yield the outlines in an object of GeoJSON, each with its name.

    Args:
        name: name of its place, for messages.
        value: the object.
        properties: properties of its feature.
        depth: nesting depth of the object.
    """
    if not isinstance(value, dict):
        raise TypeError(f"{name or 'GeoJSON'} is {show(value)}, but must be an object")
    if depth > _DEEPEST:
        raise ValueError(f"{name} is {depth} objects deep, but must be at most {_DEEPEST}")
    kind, dot = value.get("type"), "." if name else ""
    if kind == "Feature":
        own = value.get("properties")
        own = {} if own is None else own
        if not isinstance(own, dict):
            raise TypeError(f"{name}{dot}properties is {show(own)}, but must be an object")
        _check_properties(f"{name}{dot}properties", own)
        geometry = value.get("geometry")
        if geometry is not None:
            yield from _read_object(f"{name}{dot}geometry", geometry, own, depth + 1)
        return
    parts = {"FeatureCollection": "features", "GeometryCollection": "geometries"}.get(kind or "")
    if parts is None:
        yield from _read_geometry(name, kind, value, properties)
        return
    for k, part in enumerate(_list(f"{name}{dot}{parts}", value.get(parts))):
        yield from _read_object(f"{name}{dot}{parts}[{k}]", part, properties, depth + 1)


def _check_properties(name: str, properties: dict) -> None:
    boundary = properties.get("boundary")
    # other programs use the word too: OpenStreetMap's boundary=administrative bounds no site
    meant = isinstance(boundary, str) and boundary.lower() not in ("true", "yes", "1")
    if not (boundary is None or isinstance(boundary, bool) or meant):
        raise ValueError(f"{name}.boundary is {show(boundary)}, but must be true or false")


def _read_geometry(
    name: str, kind: Any, value: dict, properties: dict
) -> Iterator[tuple[str, Outline]]:
    """Yield the outlines of one geometry, each with its name."""
    place = f"{name}." if name else ""
    if kind not in GEOJSON_TYPES:
        known = ", ".join(GEOJSON_TYPES)
        raise ValueError(f"{place}type is {show(kind)}, but must be one of: {known}")
    within, given = f"{place}coordinates", value.get("coordinates")
    is_boundary = properties.get("boundary") is True
    if is_boundary and kind != "Polygon":
        raise ValueError(f"{place}type is {kind}, but that of a boundary must be Polygon")
    parts = [("", given)]
    if kind.startswith("Multi"):
        parts = [(f"[{k}]", part) for k, part in enumerate(_list(within, given))]
    for index, part in parts:
        yield name or "the geometry", _read_part(within + index, kind, part, properties)


def _read_part(name: str, kind: str, value: Any, properties: dict) -> Outline:
    """Return the outline of one polygon, line or point."""
    if kind.endswith("Polygon"):
        rings = _list(name, value)
        if not rings:
            raise ValueError(f"{name} is [], but must have at least one ring")
        read = [read_ring(f"{name}[{k}]", _flat(f"{name}[{k}]", r)) for k, r in enumerate(rings)]
        return BOUNDARY if properties.get("boundary") is True else POLYGON, read
    if kind.endswith("LineString"):
        return LINE, [read_chain(name, _flat(name, value))]
    radius = properties.get("radius")
    if not is_number(radius):
        told = f"{name} is a point whose property radius is {show(radius)}"
        raise ValueError(f"{told}, but must be a number of m: the point is a circle")
    (center,) = _flat(name, [value])
    return POLYGON, [read_circle(f"{name} with its radius", [*center, radius])]


def _list(name: str, value: Any) -> list:
    if not isinstance(value, list):
        raise TypeError(f"{name} is {show(value)}, but must be an array")
    return value


def _flat(name: str, value: Any) -> list:
    """Return positions without their heights."""
    for k, point in enumerate(_list(name, value)):
        listed = isinstance(point, list) and 2 <= len(point) <= 4
        if not listed or not all(map(is_number, point)):
            raise TypeError(f"{name}[{k}] is {show(point)}, but must be a position [x, y]")
    return [point[:2] for point in value]
