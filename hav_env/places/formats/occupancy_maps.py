"""This module reads sites from maps of ROS's map_server: a YAML file and its image."""

import os
import pathlib
from collections.abc import Callable
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np

from hav_env.models.annotations import Range, kinds_of, show
from hav_env.models.checks import check_value
from hav_env.models.quantities import Coordinate, Heading, Share
from hav_env.places.formats.cell_outlines import trace_cells
from hav_env.places.formats.map_images import read_shades
from hav_env.places.libraries import import_maps
from hav_env.places.simplification import simplify_chains
from hav_env.places.site import POLYGON, Outline

_MOST_BYTES = 2**14  # of the YAML file
_DEEPEST_YAML = 8  # lists in lists: PyYAML takes minutes for thousands
_HALF = 0.5  # share of a cell: the default tolerance
_POSE: tuple[Any, ...] = (Coordinate, Coordinate, Heading)
_NUMBERS = ("resolution", "occupied_thresh", "free_thresh")
Resolution = Annotated[float, Range(1e-4, 1e3, "m")]
Mode = Literal["trinary", "scale"]


class MapDescription(NamedTuple):
    """The content of the YAML file."""

    image: str
    """Path of the image, beside the file or below."""
    resolution: Resolution
    """Side of a cell [m]."""
    origin: tuple[float, float, float]
    """x [m], y [m] and yaw [rad] of the lower left corner."""
    negate: bool
    """Whether white is occupied."""
    occupied_thresh: Share
    """A cell whose share is above this is occupied."""
    free_thresh: Share
    """A cell whose share is below this is free."""
    mode: Mode = "trinary"
    """Whether transparent cells are unknown, as with the mode "scale"."""


def read_occupancy_map(
    path: str | os.PathLike[str], tolerance: float | None, unknown_occupied: bool
) -> list[Outline]:
    """Return the outlines of the occupied cells: one polygon with all their rings.

    Args:
        path: path of the YAML file.
        tolerance: largest deviation of the outlines from those of the cells [m]; by default half a
            cell.
        unknown_occupied: whether cells that are neither occupied nor free count as occupied.

    Raises:
        ImportError: without the extra ``maps``.
        OSError: if the system cannot read a file.
        ValueError, TypeError: if an entry, or the image, is wrong; the message names it and the
            rule.
    """
    told = _describe(_read_yaml(path))
    image = _beside(path, told.image)
    shade, opaque = read_shades(image, average_alpha=told.mode == "trinary")
    share = shade if told.negate else 1.0 - shade
    occupied = share > told.occupied_thresh
    unknown = ~occupied & (share >= told.free_thresh)
    if opaque is not None and told.mode == "scale":
        occupied &= opaque
        unknown = unknown & opaque | ~opaque
    if unknown_occupied:
        occupied |= unknown
    chains = trace_cells(occupied[::-1])  # the first row of an image is the highest
    if not chains:
        return []
    cells = _HALF if tolerance is None else tolerance / told.resolution
    place = _placing(told)
    return [(POLYGON, [place(chain) for chain in simplify_chains(chains, cells)])]


def _read_yaml(path: str | os.PathLike[str]) -> Any:
    """Return the parsed YAML of a file; reject aliases and depth, which could make it endless."""
    yaml = import_maps("yaml")
    with open(path, "rb") as file:
        content = file.read(_MOST_BYTES + 1)
    if len(content) > _MOST_BYTES:
        raise ValueError(f"the file has more than {_MOST_BYTES} bytes, the most of a map")
    try:
        _check_events(yaml, content)
        return yaml.safe_load(content)
    except (yaml.YAMLError, RecursionError, UnicodeError) as error:
        raise ValueError(f"the file is no plain YAML: {show(error, str)}") from None


def _check_events(yaml: Any, content: bytes) -> None:
    depth = 0
    for event in yaml.parse(content, Loader=yaml.SafeLoader):
        if isinstance(event, yaml.AliasEvent):
            raise ValueError(f"the file has the alias *{event.anchor}, but must have none")
        depth += isinstance(event, yaml.CollectionStartEvent)
        depth -= isinstance(event, yaml.CollectionEndEvent)
        if depth > _DEEPEST_YAML:
            told = f"the file has more than {_DEEPEST_YAML} lists or maps in each other"
            raise ValueError(f"{told}, but must have fewer")


def _describe(data: Any) -> MapDescription:
    """Check the content of the YAML file; ignore unknown entries."""
    if not isinstance(data, dict):
        raise TypeError(f"the file holds {show(data)}, but must hold entries such as image")
    given: dict[str, Any] = {}
    for name in MapDescription._fields:
        if name in data:
            given[name] = data[name]
        elif name not in MapDescription._field_defaults:
            raise ValueError(f"there is no entry {name}, but there must be one")
    for name in _NUMBERS:
        given[name] = _number(given[name])
    origin = given["origin"]
    if not isinstance(origin, list) or len(origin) != 3:
        raise TypeError(f"origin is {show(origin)}, but must be [x, y, yaw]")
    given["origin"] = tuple(map(_number, origin))
    for k, (part, value) in enumerate(zip(_POSE, given["origin"], strict=True)):
        check_value(f"origin[{k}]", part, value)
    if given["negate"] not in (0, 1):
        raise ValueError(f"negate is {show(given['negate'])}, but must be 0 or 1")
    given["negate"] = bool(given["negate"])
    if not isinstance(given["image"], str):
        raise TypeError(f"image is {show(given['image'])}, but must be a path")
    told = MapDescription(**given)
    for name in (*_NUMBERS, "mode"):
        check_value(name, kinds_of(MapDescription)[name], getattr(told, name))
    if told.free_thresh > told.occupied_thresh:
        most = told.occupied_thresh
        raise ValueError(
            f"free_thresh is {told.free_thresh}, but must be at most occupied_thresh, {most}"
        )
    return told


def _number(value: Any) -> Any:
    """Return a number that PyYAML reads as a word, such as 5e-2."""
    try:
        return float(value) if isinstance(value, str) else value
    except ValueError:
        return value


def _beside(path: str | os.PathLike[str], image: str) -> pathlib.Path:
    """Return the path of the image; reject files in other folders, because strangers write maps."""
    folder = pathlib.Path(path).resolve().parent
    try:
        found = (folder / image).resolve()
    except (ValueError, OSError, RuntimeError) as error:
        raise ValueError(f"image is {show(image)}, but must be a path: {error}") from None
    if not found.is_relative_to(folder):
        raise ValueError(f"image is {show(image)}, but must be in the folder of the map or below")
    return found


def _placing(told: MapDescription) -> Callable[[np.ndarray], np.ndarray]:
    """Return a function from corners of cells (P, 2) to coordinates [m]."""
    x, y, yaw = told.origin
    along = told.resolution * np.array([np.cos(yaw), np.sin(yaw)])
    up = np.array([-along[1], along[0]])
    return lambda cells: np.array([x, y]) + cells[:, :1] * along + cells[:, 1:] * up
