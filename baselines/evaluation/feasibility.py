"""This module finds the worlds with unreachable goals in a table, and the shortest times."""

import math

import numpy as np
import pyarrow as pa

from baselines.policies.reserve.preconditions import CIRCLE_FACTOR
from hav_env import Task
from hav_env.maths.dubins import path_length


def column(table: pa.Table, name: str) -> np.ndarray:
    """Return a column of a table as floats, NaN for null."""
    return table[name].cast(pa.float64()).to_numpy(zero_copy_only=False)


def starts_touching(table: pa.Table, num_havs: int) -> np.ndarray:
    """Return a flag for each world: whether chains touch at the start, (W,)."""
    if num_havs == 1:
        return np.zeros(table.num_rows, bool)
    return (column(table, "actual_collision_step") == 0).reshape(-1, num_havs).any(1)


def goals_crossing(table: pa.Table, num_havs: int) -> np.ndarray:
    """Return a flag for each world: whether two trucks at their goals would cross, (W,)."""
    crossing = np.zeros(table.num_rows // num_havs, bool)
    length = column(table, "truck_length").reshape(-1, num_havs)
    goal = 1
    while f"goal_{goal}_x" in table.column_names:
        x, y, heading = (
            column(table, f"goal_{goal}_{what}").reshape(-1, num_havs)
            for what in ("x", "y", "heading")
        )
        rear = x + 1j * y
        front = rear + length * np.exp(1j * heading)
        for first in range(num_havs):
            a, b = rear[:, first, None], front[:, first, None]
            c, d = rear[:, first + 1 :], front[:, first + 1 :]
            apart = (_side(a, b, c) * _side(a, b, d) > 0) | (_side(c, d, a) * _side(c, d, b) > 0)
            crossing |= (~apart).any(1)
        goal += 1
    return crossing


def _side(a, b, p):
    """Return a number above 0 if p is left of the line from a to b; all are complex."""
    return ((b - a).conjugate() * (p - a)).imag


def shortest_times(table: pa.Table, fleet) -> tuple[np.ndarray, np.ndarray]:
    """Return the number of steps of the shortest path to each goal, two arrays (G, R).

    A path to the second or a later goal begins at the goal before. The paths of the first array
    have the truck's own radius, l^0 / tan(phi^max). Those of the second have the radius of
    Reserve's circle. It is ``CIRCLE_FACTOR`` times the least radius on which the trailers can also
    drive without end, max(sqrt(sum (l^j)^2), l^0 / tan(phi^max)).
    """
    step = fleet.speed_max * Task().dt
    truck = column(table, "truck_length")
    lengths = table["trailer_lengths"].to_pylist()
    trailers = np.array([math.hypot(*of_one) for of_one in lengths])
    own = truck / math.tan(fleet.steering_max)
    poses = [np.stack([column(table, f"start_{what}") for what in ("x", "y", "heading")], 1)]
    steps: list[list[np.ndarray]] = [[], []]
    while f"goal_{len(poses)}_x" in table.column_names:
        goal = f"goal_{len(poses)}_"
        poses.append(np.stack([column(table, goal + what) for what in ("x", "y", "heading")], 1))
        start, end = poses[-2:]
        dx, dy = (end - start)[:, :2].T
        seen = (dx + 1j * dy) * np.exp(-1j * start[:, 2])
        turn = end[:, 2] - start[:, 2]
        radii = own, CIRCLE_FACTOR * np.maximum(own, trailers)
        for times, radius in zip(steps, radii, strict=True):
            shortest = map(path_length, seen.real, seen.imag, turn, radius)
            times.append(np.fromiter(shortest, float, len(truck)) / step)
    return np.array(steps[0]), np.array(steps[1])
