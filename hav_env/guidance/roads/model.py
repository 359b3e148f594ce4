"""This module declares a road network: poses, edges between them, and all shortest paths."""

from typing import Annotated, Any, NamedTuple

import numpy as np

from hav_env.guidance.walls import Walls
from hav_env.models.annotations import Range
from hav_env.models.quantities import Widening


class Roads(NamedTuple):
    """A network of the poses of a site, joined by drives on which no body comes near a wall."""

    clearance: Annotated[float, Range(0.0, 1e3, "m")] = 0.25
    """Least distance of all bodies from walls on an edge [m]. A body that touches a wall is never
    clear."""
    widening: Widening = 1.06
    """Radius of the tightest turns over the least radius that a HAV can drive for good."""
    bend: Annotated[float, Range(1e-3, 1.0, "rad")] = 0.05
    """Largest difference of an articulation at the end of an edge from that at its pose [rad]."""
    reach: Annotated[float, Range(1.0, 1e4, "m")] = 100.0
    """Greatest distance of two poses that an edge joins [m], if one of them is not a place."""


class RoadVehicle(NamedTuple):
    """A kind of HAV with U units."""

    length: np.ndarray  # (U,) of each unit [m]
    offset: np.ndarray  # (U,) from a unit's axle to the hitch of its trailer behind it [m]
    limit: np.ndarray  # (U,) largest articulation of each trailer [rad]
    shape: np.ndarray  # (U, 3) half width, front and rear overhang of each body [m]
    radius: float
    """Least radius that the HAV can drive for good [m]."""


class RoadNetworks(NamedTuple):
    """Networks over P poses, one for each of K turning radii, with E edges; all worlds share them.

    An edge has at most M segments, straights and arcs.
    """

    pose: np.ndarray  # (P, 3) x, y [m], heading [rad]
    radius: np.ndarray  # (K,) least radius that HAVs can drive for good [m]
    left: np.ndarray  # (K, P, P) length of the shortest path between poses [m]; inf: there is none
    edge: np.ndarray  # (K, P, P) int32, first edge of that path; NO_EDGE if there is none
    end: np.ndarray  # (E,) int32, pose at the end of each edge
    parts: np.ndarray  # (E,) int32, number of its segments
    segment: np.ndarray  # (E, M, 3) curvature, left positive [1/m]; length [m]; length behind it
    walls: Walls
    clearance: float
    """Distance of the axle from walls on the way to a pose [m]."""
    widening: float
    """Radius of turns on that way over the least radius that a HAV can drive for good."""

    def __deepcopy__(self, memo: Any) -> "RoadNetworks":
        """Return the same object: no code writes to networks."""
        return self


NO_EDGE = -1
