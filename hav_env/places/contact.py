"""This module tests poses on a site by NumPy: contacts with segments, and the free area."""

import numpy as np

from hav_env.places.site import Site, is_kept, ray_crosses


def touched_segment(site: Site, corners: np.ndarray) -> int | None:
    """Return the number of a segment that a body touches, None if there is none.

    Two convex shapes are apart if and only if a line along a side of one of them separates them.
    The test therefore uses the normals of all sides.

    Args:
        site: a site of S segments.
        corners: (K, 4, 2) corners of rectangles, in turn; lines and points are rectangles without a
            width or a length [m].
    """
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    ends = site.segment.reshape(-1, 2, 2)
    near = np.flatnonzero(
        ((ends.min(axis=1) <= high) & (ends.max(axis=1) >= low)).all(axis=1)
    )  # (S, 2, 2) is large; few segments are near
    if not len(near):
        return None
    ends = ends[near]
    touched = np.zeros(len(near), bool)
    for body in corners:
        touched |= ~_apart(body, ends)
    return int(near[np.argmax(touched)]) if touched.any() else None


def bodies_touch(one: np.ndarray, other: np.ndarray) -> bool:
    """Return whether any rectangle of a group touches any of another group.

    Args:
        one: (K, 4, 2) corners, in turn [m].
        other: (L, 4, 2) likewise.
    """
    low, high = other.min(axis=(0, 1)), other.max(axis=(0, 1))
    if ((one.min(axis=(0, 1)) > high) | (one.max(axis=(0, 1)) < low)).any():
        return False
    return any(not _apart(body, other).all() for body in one)


def place_is_inside(site: Site, x: float, y: float) -> bool:
    """Return whether a place [m] is in the free area: ``is_inside`` for all S at a time.

    Args:
        site: a site of S segments.
        x: x of the place [m].
        y: y of the place [m].
    """
    return bool(is_kept(site.kind, count_crossings(site, x, y) % 2 == 1).all())


def count_crossings(site: Site, x: float, y: float) -> np.ndarray:
    """Return (K,) the number of crossings of each outline with a ray to the right of a place [m].

    Args:
        site: a site of K outlines.
        x: x of the place [m].
        y: y of the place [m].
    """
    crossed = ray_crosses(*site.segment.T, x, y)
    return np.bincount(site.outline[crossed], minlength=len(site.kind))


def _apart(body: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Return (S,) whether a rectangle (4, 2) is apart from each of some shapes.

    Args:
        body: (4, 2) corners, in turn [m].
        ends: (S, 2, 2) ends of segments, or (S, 4, 2) corners of rectangles, whose sides are along
            and across.
    """
    apart = np.zeros(len(ends), bool)
    along = ends[:, 1] - ends[:, 0]
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    sides = body[1:3] - body[:2]  # along and across, one of which may be zero
    normals = np.array([[-side[1], side[0]] for side in sides])
    axes = [*sides, *normals]
    # a body that is a point has no side: use the direction of the segment
    for axis in (*(np.broadcast_to(a, across.shape) for a in axes), along, across):
        own = np.einsum("sd,kd->sk", axis, body)
        other = np.einsum("sd,skd->sk", axis, ends)
        apart |= own.max(axis=1) < other.min(axis=1)
        apart |= other.max(axis=1) < own.min(axis=1)
    return apart
