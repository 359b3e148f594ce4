"""This module checks places on a site by NumPy: who touches a segment, and who is inside."""

import numpy as np

from hav_env.places.site import BOUNDARY, LINE, Site


def touched_segment(site: Site, corners: np.ndarray) -> int | None:
    """Return the number of a segment that one of some bodies touches, None if there is none.

    Two convex shapes are apart if and only if a line along a side of one of them separates them.
    The normals of all sides are therefore tried.

    Args:
        site: of S segments.
        corners: (K, 4, 2) of rectangles, in turn; lines and points are rectangles without a width
            or a length [m].
    """
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    ends = site.segment.reshape(-1, 2, 2)
    near = np.flatnonzero(
        ((ends.min(axis=1) <= high) & (ends.max(axis=1) >= low)).all(axis=1)
    )  # (S, 2, 2) is much; few are near
    if not len(near):
        return None
    ends = ends[near]
    touched = np.zeros(len(near), bool)
    for body in corners:
        touched |= ~_apart(body, ends)
    return int(near[np.argmax(touched)]) if touched.any() else None


def place_is_inside(site: Site, x: float, y: float) -> bool:
    """Tell whether a place [m] is where HAVs may be, as ``is_inside`` does, but all S at a time.

    Args:
        site: of S segments.
        x: of the place [m].
        y: likewise [m].
    """
    odd = count_crossings(site, x, y) % 2 == 1
    return bool(((odd == (site.kind == BOUNDARY)) | (site.kind == LINE)).all())


def count_crossings(site: Site, x: float, y: float) -> np.ndarray:
    """Return (K,) how often a ray to the right of a place [m] crosses each outline.

    Args:
        site: of K outlines.
        x: of the place [m].
        y: likewise [m].
    """
    _, ay, _, by = site.segment.T
    beside = np.flatnonzero((ay > y) != (by > y))
    ax, ay, bx, by = site.segment[beside].T
    crossed = beside[x < ax + (y - ay) / (by - ay) * (bx - ax)]
    return np.bincount(site.outline[crossed], minlength=len(site.kind))


def _apart(body: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Return (S,) whether a rectangle (4, 2) is apart from each segment (S, 2, 2)."""
    apart = np.zeros(len(ends), bool)
    along = ends[:, 1] - ends[:, 0]
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    sides = body[1:3] - body[:2]  # along and across, one of which may be nothing
    normals = np.array([[-side[1], side[0]] for side in sides])
    axes = [*sides, *normals]
    # the direction of the segment tells where a body is a point
    for axis in (*(np.broadcast_to(a, across.shape) for a in axes), along, across):
        own = np.einsum("sd,kd->sk", axis, body)
        other = np.einsum("sd,skd->sk", axis, ends)
        apart |= own.max(axis=1) < other.min(axis=1)
        apart |= other.max(axis=1) < own.min(axis=1)
    return apart
