"""This module lays out an observation: its groups of columns and their order."""

from typing import NamedTuple

from hav_env.compiled import kernel
from hav_env.models.checks import check_value
from hav_env.models.quantities import Neighbors, RayRange, Rays, Seen
from hav_env.observation import neighbors as of_neighbors
from hav_env.observation.columns import Column
from hav_env.observation.obstacles import obstacle_columns
from hav_env.observation.own import ITSELF, MOTION, count_unit_columns, unit_columns
from hav_env.observation.route import ROUTE

OWN = tuple(column.name for column in (*ITSELF, *ROUTE))
NEIGHBOR = tuple(column.name for column in of_neighbors.NEIGHBOR_COLUMNS)
FIRST_OF_ROUTE, FIRST_OF_UNITS = len(ITSELF), len(ITSELF) + len(ROUTE)


class Observation(NamedTuple):
    """The parts of its surroundings that a learner observes."""

    neighbors: Neighbors = 4
    """K, of how many HAVs in sensing range, nearest first; never more than there are others."""
    chains: bool = False
    """Add the lengths and articulations of the neighbours' trailers."""
    fronts: bool = False
    """Add the neighbours' speeds, and what is near the fronts of trucks: with them HAVs collide."""
    motion: bool = False
    """Add the own speed and steering, for trucks that do not do at once what is commanded."""
    obstacles: Seen = 0
    """K, of how many segments of obstacles the nearest point is seen, nearest first."""
    rays: Rays = 0
    """R, in how many directions the distance to obstacles and to other HAVs is seen. The first is
    forward, the others follow counter-clockwise."""
    ray_range: RayRange = 50.0
    """Length of the rays [m]."""


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
    if neighbors == 0:
        return observation._replace(neighbors=0, chains=False, fronts=False)
    return observation._replace(neighbors=neighbors)


def list_columns(observation: Observation, max_trailers: int) -> tuple[Column, ...]:
    """Return the columns of a settled observation, in their order."""
    motion = MOTION if observation.motion else ()
    found = [*ITSELF, *ROUTE, *unit_columns(max_trailers), *motion]
    found += obstacle_columns(observation.obstacles, observation.rays)
    one = of_neighbors.neighbor_columns(observation.chains, observation.fronts, max_trailers)
    for k in range(observation.neighbors):
        found += [column._replace(name=f"neighbor_{k}_{column.name}") for column in one]
    return tuple(found)


def name_columns(observation: Observation, max_trailers: int) -> tuple[str, ...]:
    """Return the names of the columns of a settled observation, in their order."""
    return tuple(column.name for column in list_columns(observation, max_trailers))


@kernel
def behind_units(max_trailers):
    """Return the first column behind those of the units."""
    return FIRST_OF_UNITS + count_unit_columns(max_trailers)
