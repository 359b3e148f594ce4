"""A scenario that is written down: given lengths, start poses and goal poses."""

import json
import math
import pathlib
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from hav_env.world import derive_radii, put_straight, set_limits

_LARGEST = 10**300  # of whole numbers, which a float can still hold


class Explicit(NamedTuple):
    """Given HAVs at given poses; every episode is the same. Build it with ``explicit``."""

    num_havs: int
    num_goals: int
    max_trailers: int
    num_trailers: np.ndarray  # (N,)
    length: np.ndarray  # (N, U) [m], 1 beyond the last unit
    start: np.ndarray  # (N, 3) x [m], y [m], heading [rad]
    goals: np.ndarray  # (N, G, 3)
    speed_max: float
    steering_max: float
    articulation_max: float
    footprint_truck_share: float = 0.0


def explicit(
    lengths: Sequence[Sequence[float]],
    start: Sequence[Sequence[float]],
    goals: Sequence[Sequence[Sequence[float]]],
    *,
    speed_max: float = 1.0,
    steering_max: float = math.radians(40.0),
    articulation_max: float = math.pi / 2,
    footprint_truck_share: float = 0.0,
) -> Explicit:
    """Write a scenario down.

    Args:
        lengths: for each HAV the lengths [m] of its truck and its trailers, at least one trailer.
        start: for each HAV x [m], y [m], heading [rad].
        goals: for each HAV its goal poses, as many as the others have.
        speed_max, steering_max, articulation_max: limits of all HAVs [m/s, rad, rad].
        footprint_truck_share: share of the truck's length in the footprint radius d_i.

    Raises:
        ValueError: naming the HAV and what is wrong with it.
    """
    if len(lengths) == 0:
        raise ValueError("a scenario needs at least one HAV")
    if not len(lengths) == len(start) == len(goals):
        raise ValueError(
            f"{len(lengths)} HAVs have lengths, {len(start)} a start and {len(goals)} goals"
        )
    for agent, (units, pose, own_goals) in enumerate(zip(lengths, start, goals, strict=True)):
        if len(units) < 2:
            raise ValueError(f"HAV {agent} needs the lengths of a truck and at least one trailer")
        if len(own_goals) == 0 or len(own_goals) != len(goals[0]):
            raise ValueError(
                f"HAV {agent} has {len(own_goals)} goals; all need the same number, at least 1"
            )
        for place in (pose, *own_goals):
            if len(place) != 3:
                raise ValueError(f"HAV {agent}: {place} is not a pose [x, y, heading]")
    most = max(map(len, lengths))
    scenario = Explicit(
        len(lengths),
        len(goals[0]),
        most - 1,
        np.array([len(units) - 1 for units in lengths]),
        np.array([[*units, *[math.inf] * (most - len(units))] for units in lengths], float),
        np.array(start, float),
        np.array(goals, float),
        float(speed_max),
        float(steering_max),
        float(articulation_max),
        float(footprint_truck_share),
    )
    check_explicit(scenario)
    return scenario


def load_explicit(path: str | pathlib.Path) -> Explicit:
    """Read a scenario from a JSON file (examples/two_havs.json shows the form).

    Raises:
        ValueError: when the file is no such scenario; OSError: when it cannot be read.
    """
    try:
        data = json.loads(pathlib.Path(path).read_text())
    except (json.JSONDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise ValueError(f"{path} is not a JSON file: {error}") from None
    try:
        return _from_json(data)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def _from_json(data: Any) -> Explicit:
    if not isinstance(data, dict) or not isinstance(data.get("havs"), list):
        raise ValueError('a scenario is an object with a list "havs"')
    limits = {name: data[name] for name in data if name != "havs"}
    unknown = set(limits) - {
        *("speed_max", "steering_max", "articulation_max", "footprint_truck_share")
    }
    if unknown:
        raise ValueError(f"unknown entry {sorted(unknown)[0]!r}")
    columns: dict[str, list] = {"lengths": [], "start": [], "goals": []}
    for agent, hav in enumerate(data["havs"]):
        if not isinstance(hav, dict) or set(hav) != set(columns):
            raise ValueError(f'HAV {agent} must have "lengths", "start" and "goals", and no more')
        for name, column in columns.items():
            column.append(hav[name])
    _require_numbers(columns["lengths"], 2, "lengths")
    _require_numbers(columns["start"], 2, "start")
    _require_numbers(columns["goals"], 3, "goals")
    for name, value in limits.items():
        _require_numbers(value, 0, name)
    return explicit(columns["lengths"], columns["start"], columns["goals"], **limits)


def _require_numbers(value: Any, depth: int, name: str) -> None:
    """Raise ValueError unless ``value`` is lists, ``depth`` deep, of numbers in a float's range."""
    if depth > 0:
        if not isinstance(value, list):
            raise ValueError(f"{name}: {value!r} is not a list")
        for part in value:
            _require_numbers(part, depth - 1, name)
    elif isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{name}: {value!r} is not a number")
    elif isinstance(value, int) and abs(value) > _LARGEST:
        raise ValueError(f"{name}: a whole number of {value.bit_length()} bits is out of range")


def check_explicit(scenario: Explicit) -> None:
    """Check numbers, limits and that neither starts nor goals of a phase could collide."""
    limits = ("speed_max", math.inf), ("steering_max", math.pi / 2), ("articulation_max", math.pi)
    for field, most in limits:
        value = getattr(scenario, field)
        too_large = value > most if field == "articulation_max" else value >= most
        if not value > 0 or too_large:
            rule = f"at most {most:.6g}" if field == "articulation_max" else f"below {most:.6g}"
            raise ValueError(f"scenario {field} is {value}, but must be above 0 and {rule}")
    share = scenario.footprint_truck_share
    if not 0 <= share <= 1:
        raise ValueError(f"scenario footprint_truck_share is {share}, but must be in [0, 1]")
    places = np.concatenate([scenario.start[:, None], scenario.goals], axis=1)  # (N, 1 + G, 3)
    radius = np.array(
        [
            scenario.footprint_truck_share * units[0] + sum(units[1 : count + 1])
            for units, count in zip(scenario.length, scenario.num_trailers, strict=True)
        ]
    )
    for agent in range(scenario.num_havs):
        units = scenario.length[agent, : scenario.num_trailers[agent] + 1]
        if not (np.isfinite(units).all() and (units > 0).all()):
            raise ValueError(f"HAV {agent} has lengths {units.tolist()}, but all must be above 0 m")
        if not np.isfinite(places[agent]).all():
            raise ValueError(f"HAV {agent} has a pose that is not finite")
        for other in range(agent):
            gaps = np.hypot(*(places[agent, :, :2] - places[other, :, :2]).T)
            for which, gap in enumerate(gaps):
                if gap <= radius[agent] + radius[other]:
                    name = "starts" if which == 0 else f"goals {which}"
                    raise ValueError(
                        f"the {name} of HAVs {other} and {agent} are {gap:.2f} m apart, a potential"
                        f" collision: they need more than {radius[agent] + radius[other]:.2f} m"
                    )


def populate_explicit(scenario, world, lane):
    """Copy the scenario into one lane."""
    fleet = world.fleet
    for agent in range(scenario.num_havs):
        fleet.num_trailers[agent, lane] = scenario.num_trailers[agent]
        fleet.length[agent, :, lane] = math.inf
        for unit in range(scenario.num_trailers[agent] + 1):
            fleet.length[agent, unit, lane] = scenario.length[agent, unit]
        set_limits(scenario, fleet, agent, lane)
        derive_radii(fleet, agent, lane, scenario.footprint_truck_share)
        x, y, heading = scenario.start[agent]
        put_straight(world.state, agent, lane, x, y, heading)
        for goal in range(scenario.num_goals):
            for part in range(3):
                world.goals[agent, goal, part, lane] = scenario.goals[agent, goal, part]
    return True
