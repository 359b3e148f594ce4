"""This module simplifies outlines: it removes points within a tolerance."""

from collections.abc import Sequence

import numpy as np

from hav_env.places.libraries import import_maps
from hav_env.places.site import Outline


def simplify_outlines(outlines: Sequence[Outline], tolerance: float) -> list[Outline]:
    """Return outlines with fewer points, by the algorithm of Douglas and Peucker.

    No point of the old outlines is farther from the new ones than the tolerance, nor the other way
    round. Simplification creates no new crossings.

    Args:
        outlines: rings and chains.
        tolerance: largest deviation [m], at least 0.

    Raises:
        ImportError: without the extra ``maps``.
    """
    chains = simplify_chains([chain for _, own in outlines for chain in own], tolerance)
    rest = iter(chains)
    return [(kind, [next(rest) for _ in own]) for kind, own in outlines]


def simplify_chains(chains: Sequence[np.ndarray], tolerance: float) -> list[np.ndarray]:
    """Return simplified chains of points (P, 2); open chains keep their ends.

    Args:
        chains: chains of points (P, 2), in any unit.
        tolerance: largest deviation in the same unit.

    Raises:
        ImportError: without the extra ``maps``.
    """
    shapely = import_maps("shapely")
    lines = shapely.MultiLineString([chain.tolist() for chain in chains])
    simple = shapely.simplify(lines, tolerance, preserve_topology=True)
    return [np.asarray(line.coords) for line in shapely.get_parts(simple)]
