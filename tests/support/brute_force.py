"""This module finds the events of recorded trajectories by brute force, with Shapely."""

import numpy as np
import shapely

from tests.support.worlds import wrapped

NEVER = -1


def axles(trajectory, hav) -> np.ndarray:
    """Return the axles of a HAV in all states (T, units + 1, 2), front to end."""
    units = trajectory.num_trailers[hav] + 1
    headings, lengths = trajectory.heading[:, hav, :units], trajectory.length[hav, :units]
    ways = lengths[:, None] * np.stack([np.cos(headings), np.sin(headings)], axis=2)
    rear = np.stack([trajectory.x[:, hav], trajectory.y[:, hav]], axis=1)[:, None]
    return np.concatenate([rear + ways[:, :1], rear, rear - ways[:, 1:].cumsum(axis=1)], axis=1)


def chains_touch(trajectory) -> np.ndarray:
    """Return (T, N, N) which chains of axles have a point in common."""
    lines = [shapely.linestrings(axles(trajectory, i)) for i in range(len(trajectory.goals))]
    lines = np.stack(lines, axis=1)
    return shapely.intersects(lines[:, :, None], lines[:, None, :])


def circles_touch(trajectory, center=0.0, truck_share=0.0) -> np.ndarray:
    """Return (T, N, N) which circles overlap, about a point of each truck, with its length."""
    trucks = trajectory.length[:, 0]
    radii = trajectory.footprint + truck_share * trucks
    places = trajectory.x + 1j * trajectory.y
    places = places + center * trucks * np.exp(1j * trajectory.heading[:, :, 0])
    gaps = np.abs(places[:, :, None] - places[:, None, :])
    return gaps <= radii[:, None] + radii[None, :]


def first_partners(touching, every=1) -> list[tuple[int, set[int]]]:
    """Return, for each HAV, when it first touches another after every so many steps, and which."""
    found = []
    for hav in range(touching.shape[1]):
        others = touching[:, hav].copy()
        others[:, hav] = False
        steps = [t for t in range(0, len(others), every) if others[t].any()]
        found.append((steps[0], set(np.flatnonzero(others[steps[0]]))) if steps else (NEVER, set()))
    return found


def first_jackknifes(trajectory, every=1) -> list[tuple[int, int]]:
    """Return, for each HAV, when it is first jackknifed every so many steps, and which joint."""
    found = []
    for hav, trailers in enumerate(trajectory.num_trailers):
        bends = np.diff(trajectory.heading[:, hav, : trailers + 1], axis=1)
        bent = np.cos(bends) < np.cos(trajectory.articulation_max[hav, 1 : trailers + 1])
        steps = [t for t in range(every, len(bent), every) if bent[t].any()]
        found.append((steps[0], 1 + int(bent[steps[0]].argmax())) if steps else (NEVER, NEVER))
    return found


def close_misses(trajectory, task, hav, goal, every=1) -> dict[str, list[tuple[float, float]]]:
    """Return distance [m] and heading difference [rad] of a HAV in its close misses of a goal."""
    seen: dict[str, list[tuple[float, float]]] = {"heading": [], "euclidean": []}
    x, y, heading = trajectory.goals[hav, goal]
    for t in range(every, len(trajectory.x), every):
        under_way = trajectory.phase[t - 1, hav] == goal and not trajectory.waiting[t - 1, hav]
        if not under_way:
            continue
        distance = abs(complex(x - trajectory.x[t, hav], y - trajectory.y[t, hav]))
        turn = abs(wrapped(heading - trajectory.heading[t, hav, 0]))
        most, widest = task.distance_tolerance, task.heading_tolerance
        if distance < most and widest <= turn < 2 * widest:
            seen["heading"].append((distance, turn))
        if turn < widest and most <= distance < 2 * most:
            seen["euclidean"].append((distance, turn))
    return seen
