"""The columns of a row: their names, their order, their scales and bounds."""

import math
from typing import NamedTuple

from hav_env.compiled import kernel
from hav_env.maths.elementary import log
from hav_env.maths.geometry import clip
from hav_env.models.checks import check_value
from hav_env.models.quantities import Neighbors

LENGTH_UNIT, MOST_UNITS = 10.0, 10.0  # of the lengths of units [m]; where they are cut
FARTHEST = 1e4  # [m], where distances are cut
NEAR = 10.0  # [m], what is near the front of a truck
SPEED_UNIT = 10.0  # [m/s], where speeds are cut
_PER_LOGARITHM = 1.0 / math.log(1.0 + FARTHEST)
TINY = 1e-12  # [m], keeps the direction to a point at the same place finite

OWN = (
    "waits",
    "goals_left",
    "speed_max",
    "steering_max",
    "articulation_max",
    "stable_radius",
    "drivable_steering",
    "footprint_radius",
    "largest_articulation",
    "goal_distance",
    "goal_bearing_cosine",
    "goal_bearing_sine",
    "goal_heading_cosine",
    "goal_heading_sine",
    "approach_distance",
    "approach_bearing_cosine",
    "approach_bearing_sine",
    "goal_path_turn",
    "goal_path_first",
    "goal_path_whole",
    "goal_path_steering",
    "approach_path_turn",
    "approach_path_first",
    "approach_path_whole",
    "approach_path_steering",
)
WAITS, GOALS_LEFT, SPEED_MAX, STEERING_MAX, ARTICULATION_MAX = range(5)
STABLE, DRIVABLE, FOOTPRINT, LARGEST = range(5, 9)
GOAL, GOAL_HEADING, APPROACH, PATHS, UNITS = 9, 12, 14, 17, 25  # where each group begins
NEIGHBOR = (
    "present",
    "distance",
    "bearing_cosine",
    "bearing_sine",
    "heading_cosine",
    "heading_sine",
    "footprint_radius",
    "clearance",
    "truck_length",
    "chain_distance",
    "chain_bearing_cosine",
    "chain_bearing_sine",
)
FRONTS = ("speed", "front_nearness", "front_ahead", "front_aside", "exposed_nearness")
PRESENT, PLACE, RELATIVE_HEADING, OTHER_FOOTPRINT, CLEARANCE, TRUCK, NEAREST, CHAIN = (
    *(0, 1, 4, 6),
    *(7, 8, 9, 12),
)


class Observation(NamedTuple):
    """How much of its surroundings a learner sees."""

    neighbors: Neighbors = 4
    """K, of how many HAVs in sensing range, nearest first; never more than there are others."""
    chains: bool = False
    """Add the lengths and articulations of the neighbours' trailers."""
    fronts: bool = False
    """Add the neighbours' speeds, and what is near the fronts of trucks: with them HAVs collide."""


def check_observation(observation: Observation) -> None:
    """Check what is seen.

    Raises:
        ValueError: naming the field, its value and what is allowed.
        TypeError: when this is no observation, or a field has a value of another kind.
    """
    check_value("observation", Observation, observation)


def settle(observation: Observation, num_havs: int) -> Observation:
    """Return the observation with no more neighbours than there are."""
    neighbors = min(observation.neighbors, num_havs - 1)
    return observation._replace(neighbors=neighbors) if neighbors > 0 else Observation(neighbors=0)


def name_columns(observation: Observation, max_trailers: int) -> tuple[str, ...]:
    """Return the names of the columns of a settled observation, in their order."""
    joints = range(1, max_trailers + 1)
    bends = [f"articulation_{part}_{j}" for part in ("cosine", "sine") for j in joints]
    names = [*OWN, *(f"length_{unit}" for unit in range(max_trailers + 1)), *bends]
    for k in range(observation.neighbors):
        chain = [*(f"length_{j}" for j in joints), *bends] if observation.chains else []
        fronts = FRONTS if observation.fronts else ()
        names += [f"neighbor_{k}_{name}" for name in (*NEIGHBOR, *chain, *fronts)]
    return tuple(names)


_SIGNED = (
    *("_turn", "_path_steering", "_clearance", "largest_articulation"),
    *("front_ahead", "front_aside"),
)


def bounds_of(name: str) -> tuple[float, float]:
    """Return the least and the greatest value of a column."""
    if "length" in name:
        return 0.0, MOST_UNITS
    signed = "cosine" in name or "sine" in name or name.endswith(_SIGNED)
    return -1.0 if signed else 0.0, 1.0


@kernel
def scale_distance(distance):
    """Return ln(1 + d / 1 m) / ln(1 + 10 km / 1 m), cut to 1: 1 m and 300 m both tell."""
    return min(log(1.0 + distance) * _PER_LOGARITHM, 1.0)


@kernel
def scale_length(length):
    """Return the length of a unit in 10 m, cut to 10."""
    return min(length * (1.0 / LENGTH_UNIT), MOST_UNITS)


@kernel
def write_place(columns, column, lane, forward, left):
    """Write distance, cosine and sine of the bearing of a point [m]."""
    distance = math.sqrt(forward * forward + left * left)
    per_distance = 1.0 / max(distance, TINY)
    columns[column, lane] = scale_distance(distance)
    write_direction(columns, column + 1, lane, forward * per_distance, left * per_distance)


@kernel
def write_direction(columns, column, lane, cosine, sine):
    """Write a cosine and a sine, which rounding may have brought beyond 1."""
    columns[column, lane] = clip(cosine, -1.0, 1.0)
    columns[column + 1, lane] = clip(sine, -1.0, 1.0)
