"""This module defines the camera, which chooses the visible plane and projects points."""

import math

import numpy as np

_SETTLING = 0.6  # s for most of the motion to a new view
_LEAST = 24.0  # m, least visible size, so that a HAV at its goal does not fill the picture


class Camera:
    """A view of the plane that moves smoothly to its target.

    Attributes:
        size: width and height of the picture in pixels.
        free: (2,) width and height of the area without text at its edges.
        middle: (2,) the pixel in the middle of that area.
        center: (2,) the point of the plane that appears there [m].
        scale: pixels per metre.
    """

    def __init__(
        self, size: tuple[int, int], left: float, frames_per_second: float, bottom: float = 0.0
    ) -> None:
        """Begin without a view; the first ``aim`` sets it at once.

        Args:
            size: width and height of the picture in pixels.
            left: pixels on the left for text.
            frames_per_second: rate of the calls of ``aim``.
            bottom: pixels at the bottom for text.
        """
        self.size = size
        self.free = np.array([size[0] - left, size[1] - bottom], float)
        self.middle = np.array([left, 0.0]) + self.free / 2.0
        self.center = np.zeros(2)
        self.scale = 1.0
        self._share = 1.0 - math.exp(-1.0 / (_SETTLING * frames_per_second))
        self._begun = False

    def aim(self, low: np.ndarray, high: np.ndarray, margin: float, zoom: float = 1.0) -> None:
        """Move towards a view of a box.

        Args:
            low: (2,) its lower left corner [m].
            high: (2,) its upper right corner [m].
            margin: free pixels round it.
            zoom: additional magnification.
        """
        width, height = np.maximum(self.free - 2.0 * margin, self.free / 2.0)
        extent = np.maximum(high - low, _LEAST)
        scale = zoom * float(min(width / extent[0], height / extent[1]))
        share = self._share if self._begun else 1.0
        self.center = self.center + share * ((low + high) / 2.0 - self.center)
        self.scale *= (scale / self.scale) ** share
        self._begun = True

    def forget(self) -> None:
        """Jump to the next target."""
        self._begun = False
        self.center, self.scale = np.zeros(2), 1.0

    def project(self, points: np.ndarray) -> np.ndarray:
        """Return the pixels (right, down) of points (..., 2) of the plane [m]."""
        away = (np.asarray(points, float) - self.center) * (self.scale, -self.scale)
        return away + self.middle

    def place(self, pose: tuple[float, float, float], shape) -> np.ndarray:
        """Return the pixels of a shape in the frame of a pose.

        Args:
            pose: x [m], y [m], heading [rad].
            shape: (K, 2) forward and left [m].
        """
        x, y, heading = pose
        cosine, sine = math.cos(heading), math.sin(heading)
        turned = np.asarray(shape, float) @ np.array([[cosine, sine], [-sine, cosine]])
        return self.project(turned + np.array([x, y]))

    def seen(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the corners (2,) of the visible plane [m]."""
        width, height = np.array(self.size) / self.scale
        low = self.center - (self.middle[0] / self.scale, height - self.middle[1] / self.scale)
        return low, low + np.array([width, height])


def clip_segments(
    segments: np.ndarray, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the segments that reach into a box, and their parts inside.

    It is the algorithm of Liang and Barsky, for all segments at once.

    Args:
        segments: (S, 4) x and y of one end, x and y of the other.
        low: (2,) lower left corner of the box.
        high: (2,) its upper right corner.

    Returns:
        (K,) numbers of these segments, ascending, and (K, 4) their parts.
    """
    start, along = segments[:, :2], segments[:, 2:] - segments[:, :2]
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.stack([low - start, high - start]) / along
    # a segment along an axis never enters or leaves, or is wholly outside
    outside = (along == 0.0) & ((start < low) | (start > high))
    first = np.where(along == 0.0, 0.0, shares.min(axis=0)).max(axis=1, initial=0.0)
    last = np.where(along == 0.0, 1.0, shares.max(axis=0)).min(axis=1, initial=1.0)
    seen = np.flatnonzero((first <= last) & ~outside.any(axis=1))
    start, along = start[seen], along[seen]
    ends = [start + share[seen, None] * along for share in (first, last)]
    return seen, np.concatenate(ends, axis=1)


def box(rear: float, front: float, half: float) -> np.ndarray:
    """Return the corners (4, 2) of a box along a heading, to both sides of it [m]."""
    return np.array([(rear, -half), (front, -half), (front, half), (rear, half)])


def round_length(length: float) -> float:
    """Return the smallest of 1, 2, 5, 10, 20, ... that is not less than a length."""
    power = 10.0 ** math.floor(math.log10(length))
    return next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= length * 0.999)
