"""This module draws random shapes for tests of places, and compares sites with Shapely."""

import json
import math

import numpy as np
import shapely
from hypothesis import strategies as st

from hav_env.places import BOUNDARY, LINE, POLYGON, chains_of

COORDINATES = st.floats(-100.0, 100.0).map(lambda x: round(x, 3))
POINTS = st.tuples(COORDINATES, COORDINATES)


@st.composite
def stars(draw, center=None, most=30.0):
    """Draw a polygon without crossings: a radius for each of some angles, in turn."""
    count = draw(st.integers(3, 9))
    x, y = draw(POINTS) if center is None else center
    radii = draw(st.lists(st.floats(0.2 * most, most), min_size=count, max_size=count))
    angles = 2.0 * math.pi * (np.arange(count) + 0.1) / count
    return [[x + r * math.cos(a), y + r * math.sin(a)] for r, a in zip(radii, angles, strict=True)]


CHAINS = st.lists(POINTS, min_size=2, max_size=6, unique=True)


def lines_of(site, *kinds):
    """Return the chains of a site, or those of some kinds, as one Shapely geometry."""
    wanted = kinds or (BOUNDARY, POLYGON, LINE)
    return shapely.MultiLineString([p for kind, p in chains_of(site) if kind in wanted])


def rounded(polygon):
    """Return the rings of a Shapely polygon as GeoJSON has them."""
    return json.loads(shapely.to_geojson(polygon))["coordinates"]
