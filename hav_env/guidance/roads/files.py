"""This module keeps the road networks of sites on disk.

The name of a file is the SHA-256 of all inputs of its networks: walls, poses, edges allowed,
vehicles, bounds, ``Roads``, and the code of the search.
"""

import functools
from collections.abc import Sequence

import numpy as np

from hav_env.compiled import digest_code
from hav_env.guidance.array_files import digest_numbers, file_of, keep_arrays, read_arrays
from hav_env.guidance.roads.detours import join_by_third
from hav_env.guidance.roads.edges import join_poses
from hav_env.guidance.roads.model import RoadNetworks, Roads, RoadVehicle
from hav_env.guidance.roads.networks import build_networks
from hav_env.guidance.roads.sweeps import try_drives
from hav_env.guidance.walls import Grid, Walls

_FOLDER = "roads"
_ARRAYS = ("pose", "radius", "left", "edge", "end", "parts", "segment")
_OTHERS = ("segments", "gaps", "scalars")  # of walls and grid; grid, clearance and widening


def load_networks(
    roads: Roads,
    walls: np.ndarray,
    poses: np.ndarray,
    joins: np.ndarray,
    vehicles: Sequence[RoadVehicle],
    bounds: tuple[float, float, float, float],
) -> RoadNetworks:
    """Return the networks of ``build_networks``; load them from disk, or build and keep them.

    Args:
        roads: As all arguments, see ``build_networks``.
        walls: (S, 4) [m].
        poses: (P, 4).
        joins: (P + 1, P) bool.
        vehicles: Kinds of HAVs.
        bounds: Of the site [m].

    Raises:
        ValueError: As ``build_networks``.
    """
    shapes = [part for vehicle in vehicles for part in vehicle[:4]]
    radii = [vehicle.radius for vehicle in vehicles]
    arrays = walls, poses, joins, *shapes
    path = file_of(_FOLDER, digest_numbers(_digest_code(), (*roads, *radii, *bounds), arrays))
    found = read_arrays(path, (*_ARRAYS, *_OTHERS))
    if found is not None:
        *grid, clearance, widening = found.pop("scalars").tolist()
        site = Walls(found.pop("segments"), found.pop("gaps"), Grid(*grid))
        return RoadNetworks(**found, walls=site, clearance=clearance, widening=widening)
    networks = build_networks(roads, walls, poses, joins, vehicles, bounds)
    site, scalars = networks.walls, [*networks.walls.grid, networks.clearance, networks.widening]
    kept = {name: getattr(networks, name) for name in _ARRAYS}
    others = site.segments, site.gaps, np.array(scalars)
    keep_arrays(path, {**kept, **dict(zip(_OTHERS, others, strict=True))})
    return networks


@functools.cache
def _digest_code() -> str:
    """Return the digest of the code of the search."""
    return digest_code([build_networks, try_drives, join_poses, join_by_third]).digest
