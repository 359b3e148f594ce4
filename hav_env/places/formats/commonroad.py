"""This module reads sites from CommonRoad's XML: static obstacles, and the edges of roads.

It reads XML by defusedxml. CommonRoad's own reader, commonroad-io, pins protobuf to one old
release, which TensorBoard and others exclude, and brings ten more packages.
"""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from hav_env.models.annotations import show
from hav_env.places.formats.road_edges import Lane, edges_of_roads
from hav_env.places.libraries import import_maps
from hav_env.places.outlines import read_chain, read_circle, read_ring
from hav_env.places.site import LINE, POLYGON, Outline

_OBSTACLES = ("staticObstacle", "environmentObstacle", "obstacle")
_SHAPES = ("rectangle", "circle", "polygon")


def read_commonroad(content: bytes) -> list[Outline]:
    """Return the outlines of a CommonRoad file of version 2018b or 2020a.

    Static obstacles become polygons. The edges of the area of all lanelets become lines; the ends
    of roads stay open. The reader ignores moving obstacles.

    Args:
        content: content of the file.

    Raises:
        ImportError: without the extra ``maps``.
        TypeError, ValueError: if an obstacle or lanelet is wrong; the message names it and the
            rule.
    """
    trees = import_maps("defusedxml.ElementTree")
    parse_error = import_maps("xml.etree.ElementTree").ParseError
    try:
        root = trees.fromstring(content, forbid_dtd=True)
    except (parse_error, ValueError, LookupError) as error:  # defusedxml's are ValueErrors
        reason = show(error, str) if str(error) else type(error).__name__
        raise ValueError(f"the file is no plain XML: {reason}") from None
    if root.tag != "commonRoad":
        raise ValueError(f"its root is {show(root.tag)}, but must be commonRoad")
    lanes = [_read_lane(node) for node in root.findall("lanelet")]
    found: list[Outline] = [(LINE, [edge]) for edge in edges_of_roads(lanes)]
    for tag in _OBSTACLES:
        for number, node in enumerate(root.findall(tag)):
            found.extend(_read_obstacle(f"{tag} {node.get('id', f'number {number}')}", tag, node))
    return found


def _read_lane(node: Any) -> Lane:
    name = f"lanelet {node.get('id', '')}"
    left, right = (
        read_chain(f"{name} {bound}", _read_places(f"{name} {bound}", node.find(bound)))
        for bound in ("leftBound", "rightBound")
    )
    return Lane(left, right, *(node.find(f"adjacent{s}") is None for s in ("Left", "Right")))


def _read_obstacle(name: str, tag: str, node: Any) -> Iterator[Outline]:
    """Yield the outline of each shape of an obstacle, if it is static."""
    if tag == "obstacle" and _text(name, node, "role") != "static":
        return
    x = y = angle = 0.0
    if tag != "environmentObstacle":  # its shape is in world coordinates
        x, y = _read_place(f"{name} position", _find(name, node, "initialState/position/point"))
        angle = _read_number(name, node, "initialState/orientation/exact")
    cosine, sine = math.cos(angle), math.sin(angle)
    shapes = list(_find(name, node, "shape"))
    if not shapes:
        raise ValueError(f"{name} has an empty shape, but must have one of: {', '.join(_SHAPES)}")
    for shape in shapes:
        if shape.tag not in _SHAPES:
            told = f"{name} has the shape {show(shape.tag)}"
            raise ValueError(f"{told}, but must have one of: {', '.join(_SHAPES)}")
        local = _read_shape(f"{name} {shape.tag}", shape)
        turned = local @ np.array([[cosine, sine], [-sine, cosine]])
        yield POLYGON, [read_ring(f"{name} {shape.tag}", turned + np.array([x, y]))]


def _read_shape(name: str, node: Any) -> np.ndarray:
    """Return the corners (P, 2) of a shape in the frame of its obstacle [m]."""
    if node.tag == "polygon":
        return read_ring(name, _read_places(name, node))
    center = node.find("center")
    x, y = (0.0, 0.0) if center is None else _read_place(f"{name} center", center)
    if node.tag == "circle":
        return read_circle(name, [x, y, _read_number(name, node, "radius")])
    length, width = (_read_number(name, node, entry) for entry in ("length", "width"))
    if not (length > 0.0 and width > 0.0):
        told = f"{name} has length {length} and width {width}"
        raise ValueError(f"{told}, but must have both above 0 m")
    angle, shift = (
        0.0 if node.find(entry) is None else _read_number(name, node, entry)
        for entry in ("orientation", "originXShift")
    )
    half = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * (0.5 * length, 0.5 * width)
    along = np.array([math.cos(angle), math.sin(angle)])
    turned = (half[:, :1] - shift) * along + half[:, 1:] * np.array([-along[1], along[0]])
    return turned + np.array([x, y])


def _read_places(name: str, node: Any) -> list[list[float]]:
    if node is None:
        raise ValueError(f"{name} is missing, but must be there")
    return [
        _read_place(f"{name} point[{k}]", point) for k, point in enumerate(node.findall("point"))
    ]


def _read_place(name: str, node: Any) -> list[float]:
    """Return x and y without the height."""
    return [_read_number(name, node, entry) for entry in ("x", "y")]


def _read_number(name: str, node: Any, entry: str) -> float:
    text = _text(name, node, entry)
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise ValueError(f"{name} {entry} is {show(text)}, but must be a number")
    return number


def _text(name: str, node: Any, entry: str) -> str:
    return (_find(name, node, entry).text or "").strip()


def _find(name: str, node: Any, entry: str) -> Any:
    found = node.find(entry)
    if found is None:
        raise ValueError(f"{name} has no {entry}, but must have one")
    return found
