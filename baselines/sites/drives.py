"""This module stores drives on a site: found by a search, written to JSON, read as dense paths."""

import json
import math
import pathlib
from typing import Any, NamedTuple

import numpy as np

from baselines.sites.chain_motion import chain_of, clearance_of
from baselines.sites.roads import ROADS
from baselines.sites.search import Segments, Terms, best_of, find_drive
from baselines.storage.atomic_files import write_text
from hav_env.scenarios.presets import SITES
from hav_env.vehicles import Combination, catalogue
from hav_env.vehicles.steady_circles import least_radius

DRIVE_FOLDER = pathlib.Path("tests/scenarios/drives")
"""Folder of the drives, from the root of the project."""
DRIVE_MARGIN = 0.25
"""Least distance of bodies to segments [m]; it covers a driver's deviation from its path."""
_TURN_SPARE = 1.06
"""Radius of the tightest turns, as a multiple of the vehicle's least."""
_BETWEEN = 0.1
"""Distance between the points of a path [m]."""


class Path(NamedTuple):
    """A drive as points of the path of the truck's rear axle."""

    vehicle: str
    """Name in the catalogue."""
    begin: int
    """Number of the place at the start."""
    end: int
    """Number of the place at the end."""
    points: np.ndarray
    """(T, 4) x [m], y [m], heading [rad] and curvature [1/m]."""


def least_turn(vehicle: Combination) -> float:
    """Return the radius [m] of a vehicle's tightest turns in drives."""
    wheels = vehicle.lengths[0] / math.tan(vehicle.steering_max)
    joints = least_radius(vehicle.lengths, vehicle.offsets, vehicle.limits)
    return round(_TURN_SPARE * max(wheels, joints), 3)


def plan_site(name: str, vehicles: tuple[str, ...]) -> dict[str, Any]:
    """Search drives for all connections of a site, for each of some vehicles.

    Args:
        name: Name of a scenario in ``SITES``.
        vehicles: Names in the catalogue.

    Raises:
        ValueError: If no drive was found for a connection; the message names it.
    """
    scenario = SITES[name]
    field, plans = clearance_of(scenario.site), {}
    for vehicle_name in vehicles:
        vehicle = catalogue(vehicle_name)
        terms = Terms(chain_of(vehicle), field, least_turn(vehicle), DRIVE_MARGIN)
        legs: dict[tuple[float, ...], Segments] = {}
        known: dict[tuple[float, ...], list[Segments]] = {}  # sites are symmetric in parts
        drives: dict[str, list[list[float]]] = {}
        for begin, end in np.argwhere(scenario.follows == 1):
            start, goal = scenario.place[begin], scenario.place[end]
            path: Segments = []
            one, guides = start, []
            for other in [*ROADS[name](scenario, start, goal), goal]:
                if len(other) > 3:
                    guides.append(other[:3])
                    continue
                key = (*one, *other)
                if key not in legs:
                    like = _relative(one, other)
                    found = best_of(terms, one, known.get(like, []))
                    found = found or find_drive(terms, one, other, 0, guides)
                    if found is None:
                        message = f"{vehicle_name} found no way from place {begin} to place {end}"
                        raise ValueError(f"{message} of {name}: between {one} and {other}")
                    legs[key] = found
                    known.setdefault(like, []).append(found)
                    mirrored = _relative(np.zeros(3), np.array([like[0], -like[1], -like[2]]))
                    known.setdefault(mirrored, []).append([(-side, way) for side, way in found])
                path = path + legs[key]
                one, guides = other, []
            drives[f"{begin}-{end}"] = [[round(side, 4), round(way, 3)] for side, way in path]
        plans[vehicle_name] = {"radius": terms.radius, "drives": drives}
    return {"scenario": name, "vehicles": plans}


def _relative(one: np.ndarray, other: np.ndarray) -> tuple[float, float, float]:
    """Return a pose relative to another: ahead, to the left, turned."""
    x, y, heading = other - one
    cosine, sine = math.cos(one[2]), math.sin(one[2])
    ahead, left = x * cosine + y * sine, y * cosine - x * sine
    turned = math.remainder(heading, 2.0 * math.pi)
    turned = math.pi if abs(turned + math.pi) < 1e-3 else turned
    return round(ahead, 2) + 0.0, round(left, 2) + 0.0, round(turned, 3) + 0.0


def write_plans(plans: dict[str, Any], folder: pathlib.Path = DRIVE_FOLDER) -> pathlib.Path:
    """Write the drives of a site as JSON, one drive a line, and return the path."""
    lines = []
    for name, plan in plans["vehicles"].items():
        drives = ",\n".join(f'   "{k}": {json.dumps(v)}' for k, v in plan["drives"].items())
        lines.append(f'  "{name}": {{"radius": {plan["radius"]}, "drives": {{\n{drives}\n  }}}}')
    text = ",\n".join(lines)
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{plans['scenario']}.json"
    write_text(f'{{"scenario": "{plans["scenario"]}", "vehicles": {{\n{text}\n}}}}\n', path)
    return path


def read_paths(name: str, folder: pathlib.Path = DRIVE_FOLDER) -> list[Path]:
    """Return all drives of a site as paths."""
    plans, place = json.loads((folder / f"{name}.json").read_text()), SITES[name].place
    paths = []
    for vehicle, plan in plans["vehicles"].items():
        for key, segments in plan["drives"].items():
            begin, end = map(int, key.split("-"))
            paths.append(
                Path(vehicle, begin, end, trace_path(place[begin], segments, plan["radius"]))
            )
    return paths


def trace_path(start: np.ndarray, segments: Segments, radius: float) -> np.ndarray:
    """Return points (T, 4) along segments from a pose: x, y, heading, curvature.

    Args:
        start: Pose (3,).
        segments: Curvatures as multiples of the largest, and lengths [m].
        radius: Radius of the largest curvature [m].
    """
    x, y, heading = map(float, start)
    rows = []
    for side, length in segments:
        count = max(1, math.ceil(length / _BETWEEN))
        way, curvature = length / count, side / radius
        for _ in range(count):
            rows.append((x, y, heading, curvature))
            middle = heading + 0.5 * way * curvature
            chord = way * float(np.sinc(0.5 * way * curvature / math.pi))
            x, y = x + chord * math.cos(middle), y + chord * math.sin(middle)
            heading += way * curvature
    rows.append((x, y, heading, 0.0))
    return np.array(rows)
