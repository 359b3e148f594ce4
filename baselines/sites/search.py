"""This module searches for drives: turns that bring a vehicle from place to place, forwards only.

A drive goes through given poses. Between two poses it is a straight, a Dubins path, perhaps through
a random pose and a second Dubins path, and a straight again. Among the candidates that hit nothing
and arrive nearly straight, the search selects a short one with enough distance to obstacles.
"""

import itertools
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from baselines.sites.chain_motion import Chain, Clearance, advance, clearance_at, outline_points
from hav_env.maths.dubins import shortest_path, turns

Segments = list[tuple[float, float]]
"""Curvature as a multiple of the largest (1 to the left, -1 to the right) and length [m]."""

_BEND_LEFT = 0.05  # [rad] largest articulation at the end
_JOINT_SPARE = 0.05  # [rad] distance to the limits of joints
_STRAIGHTS = (0.0, 0.7, 1.4, 2.4)  # before and after turns: longest unit, or half the trailers
_TRIED_RADII = (1.0, 1.25, 1.6, 4.0)  # radii of turns, in least radii
_NEAR_GUIDE = np.array([0.12, 0.12, 0.12])  # standard deviations [radii, radii, rad]
_SAMPLES = 300  # random poses per round
_ROUNDS = 40
_WANTED = 0.6  # [m] distance to segments below which a path is penalised
_PRICE = 12.0  # [m] of path per metre less


class Terms(NamedTuple):
    """Demands on a drive."""

    chain: Chain
    """The vehicle."""
    field: Clearance
    """Distances to segments."""
    radius: float
    """Least radius of turns [m]."""
    margin: float
    """Least distance of points of outlines to segments [m]."""

    @property
    def step(self) -> float:
        """Longest step of the integrator [m]."""
        return min(0.5, 0.25 * float(self.chain.lengths[1:].min()))


def find_drive(
    terms: Terms, start: np.ndarray, goal: np.ndarray, seed: int, guides: Sequence = ()
) -> Segments | None:
    """Return a drive between two poses (3,); None if none was found.

    Args:
        terms: Demands on the drive.
        start: Pose of a straight chain.
        goal: Pose of the truck; the chain arrives nearly straight.
        seed: Seed of the random poses.
        guides: Poses (3,) near which the drive passes; the chain may be bent there.
    """
    lengths, hitches = terms.chain.lengths[1:], terms.chain.hitches[1:]
    unit = max(float(lengths.max()), 0.5 * float((lengths + hitches).sum()))
    straights = [share * unit for share in _STRAIGHTS]
    direct = [
        path
        for out, back, radius in itertools.product(straights, straights, _TRIED_RADII)
        if (path := _join(terms, start, goal, out, back, [(None, radius)])) is not None
    ]
    found = best_of(terms, start, direct)
    random = np.random.default_rng(seed)
    reach = math.dist(start[:2], goal[:2])
    near = _NEAR_GUIDE * (terms.radius, terms.radius, 1.0)
    for _ in range(_ROUNDS if found is None else 0):
        paths = []
        for _ in range(_SAMPLES):
            out, back = random.choice(straights[:3]), random.choice(straights)
            noise = near * random.choice((0.3, 1.0))
            vias = [pose + random.normal(size=3) * noise for pose in guides]
            vias = vias or [_sample(terms, random, start, goal)]
            ways = [(via, random.choice(_TRIED_RADII)) for via in [*vias, None]]
            path = _join(terms, start, goal, out, back, ways)
            most = 2.0 * reach + 7.0 * terms.radius + out + back
            if path is not None and sum(length for _, length in path) < most:
                paths.append(path)
        found = best_of(terms, start, paths)
        if found is not None:
            break
    return found


def _sample(terms: Terms, random, start: np.ndarray, goal: np.ndarray) -> np.ndarray:
    """Return a random pose: near the line between two poses, or anywhere round it."""
    share, spread = random.uniform(), random.choice((0.08, 0.2, 0.5))
    scale = spread * (math.dist(start[:2], goal[:2]) + terms.radius)
    x, y = (1.0 - share) * start[:2] + share * goal[:2] + random.normal(scale=scale, size=2)
    turned = math.remainder(goal[2] - start[2], 2.0 * math.pi)
    heading = start[2] + share * turned + random.choice((0.3, 1.0, 3.0)) * random.normal()
    return np.array([x, y, heading])


def _join(terms, start, goal, out, back, ways) -> Segments | None:
    """Return a straight, Dubins paths through poses, and a straight."""
    here = _ahead(start, out)
    path: Segments = [(0.0, out)]
    for via, share in ways:
        aim = _ahead(goal, -back) if via is None else via
        radius = share * terms.radius
        x, y = aim[:2] - here[:2]
        cosine, sine = math.cos(here[2]), math.sin(here[2])
        word, *parts = shortest_path(
            x * cosine + y * sine, y * cosine - x * sine, aim[2] - here[2], radius
        )
        if (via is None or len(ways) > 2) and sum(parts) > 1.6 * math.hypot(x, y) + 4.5 * radius:
            return None  # a loop; shorter candidates have none
        path += [(side / share, length) for side, length in zip(turns(word), parts, strict=True)]
        here = aim
    path.append((0.0, back))
    return [(side, length) for side, length in path if length > 1e-6]


def _ahead(pose: np.ndarray, way: float) -> np.ndarray:
    return pose + way * np.array([math.cos(pose[2]), math.sin(pose[2]), 0.0])


def best_of(terms: Terms, start: np.ndarray, paths: list[Segments]) -> Segments | None:
    """Return the cheapest path that is clear; None if no path is."""
    if not paths:
        return None
    total = np.array([sum(length for _, length in path) for path in paths])
    clear, bend = drive(terms, start, paths)
    good = (clear > terms.margin) & (bend <= _BEND_LEFT)
    if not good.any():
        return None
    cost = total + _PRICE * np.maximum(0.0, _WANTED - clear)
    return paths[int(np.argmin(np.where(good, cost, np.inf)))]


def drive(terms: Terms, start: np.ndarray, paths: list[Segments]) -> tuple[np.ndarray, np.ndarray]:
    """Return the least distances to segments (K,) [m] along paths, and the bends at their ends.

    The distance is -1 if a joint came near its limit. A path that comes too near is not followed
    further.
    """
    most = max(map(len, paths))
    side, length = np.zeros((2, len(paths), most))
    for k, path in enumerate(paths):
        side[k, : len(path)], length[k, : len(path)] = zip(*path, strict=True)
    ends = np.cumsum(length, axis=1)
    chain = terms.chain
    units = len(chain.lengths)
    states = np.concatenate([start[:2], np.full(units, start[2])])[None].repeat(len(paths), axis=0)
    least, bend = np.full(len(paths), np.inf), np.full(len(paths), np.inf)
    gone, segment = np.zeros(len(paths)), np.zeros(len(paths), int)
    active = np.arange(len(paths))
    while len(active):
        left = ends[active, segment[active]] - gone[active]
        way = np.minimum(left, terms.step)
        curvature = side[active, segment[active]] / terms.radius
        now = advance(chain, states[active], curvature, way[:, None])
        gone[active] += way
        segment[active] += way >= left
        states[active] = now
        clear = clearance_at(terms.field, outline_points(chain, now)).min(axis=1)
        bends = np.abs(np.diff(now[:, 2:]))
        clear = np.where((bends > chain.limits - _JOINT_SPARE).any(axis=1), -1.0, clear)
        least[active] = np.minimum(least[active], clear)
        done = gone[active] >= ends[active, -1] - 1e-9
        bend[active[done]] = bends[done].max(axis=1)
        active = active[~done & (least[active] > terms.margin)]
    return least, bend
