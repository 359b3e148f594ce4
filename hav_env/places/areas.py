"""This module measures the areas of a site: the free area, and that of its polygons."""

from typing import Any

import numpy as np

from hav_env.places.contact import count_crossings
from hav_env.places.libraries import import_maps
from hav_env.places.site import BOUNDARY, POLYGON, Site


def covered_area(site: Site) -> Any:
    """Return the area of all polygons, without their holes, as a Shapely geometry [m].

    Args:
        site: a site, with or without polygons.

    Raises:
        ImportError: without the extra ``maps``.
    """
    return _area_of(site, POLYGON)


def free_area(site: Site) -> Any | None:
    """Return the area inside the boundary and outside polygons, as a Shapely geometry [m].

    Args:
        site: a site. Without a boundary it has no such area, and the result is None.

    Raises:
        ImportError: without the extra ``maps``.
    """
    if BOUNDARY not in site.kind:
        return None
    return _area_of(site, BOUNDARY).difference(covered_area(site))


def _area_of(site: Site, kind: int) -> Any:
    """Return the area that the rings of a kind of outlines surround an odd number of times."""
    shapely = import_maps("shapely")
    areas = []
    for number in np.flatnonzero(site.kind == kind):
        ends = site.segment[site.outline == number].reshape(-1, 2, 2)
        lines = shapely.union_all(shapely.linestrings(ends))  # segments meet where they cross
        for face in shapely.get_parts(shapely.polygonize(shapely.get_parts(lines))):
            x, y = shapely.point_on_surface(face).coords[0]
            if count_crossings(site, x, y)[number] % 2 == 1:
                areas.append(face)
    return shapely.union_all(areas)
