"""This module reads the obstacles of worlds as an array, for every type of place."""

from typing import Any

import numpy as np

from hav_env.world.place.segments import (
    DIRECTION_COSINE,
    DIRECTION_SINE,
    HALF_LENGTH,
    MIDDLE_X,
    MIDDLE_Y,
    Obstacles,
)


def segments_in(place: Any, w: int) -> np.ndarray:
    """Return the segments of a world, (S, 4) x and y of one end, x and y of the other [m].

    Args:
        place: Place of a batch.
        w: Index of the world.
    """
    if not isinstance(place, Obstacles):
        return np.zeros((0, 4))
    segment = place.segment[: place.count[w], :, w]
    middle = segment[:, [MIDDLE_X, MIDDLE_Y]]
    half = segment[:, [DIRECTION_COSINE, DIRECTION_SINE]] * segment[:, [HALF_LENGTH]]
    return np.concatenate([middle - half, middle + half], axis=1)
