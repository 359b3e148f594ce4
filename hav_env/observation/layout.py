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
    """Settings of an observation: the parts of the surroundings that a learner observes."""

    neighbors: Neighbors = 4
    """Number K of observed HAVs in sensing range, nearest first; at most the number of other HAVs.
    """
    chains: bool = False
    """Add the lengths and articulations of the neighbours' trailers."""
    fronts: bool = False
    """Add the neighbours' speeds, and the nearest points to the fronts of trucks, where HAVs
    collide.
    """
    motion: bool = False
    """Add the HAV's own speed and steering, for trucks that follow commands with a delay."""
    obstacles: Seen = 0
    """Number K of obstacle segments whose nearest points are observed, nearest first."""
    rays: Rays = 0
    """Number R of rays, each with the distance to obstacles and to other HAVs. The first ray points
    forward; the others follow counter-clockwise.
    """
    ray_range: RayRange = 50.0
    """Length of the rays [m]."""


def check_observation(observation: Observation) -> None:
    """Check the settings of an observation.

    Raises:
        ValueError: If a field is invalid; the message names it, its value and the rule.
        TypeError: If this is not an observation, or a field has a value of another type.
    """
    check_value("observation", Observation, observation)


def settle(observation: Observation, num_havs: int) -> Observation:
    """Return the settings with at most as many neighbours as there are other HAVs."""
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
    """Return the first column after those of the units."""
    return FIRST_OF_UNITS + count_unit_columns(max_trailers)
