"""This module drives HAVs along Dubins paths by SciPy: the general n-trailer, integrated."""

import numpy as np
import scipy.integrate

from hav_env.maths.dubins import shortest_path, turns
from hav_env.world.sensing import drivable_radius
from hav_env.world.units.reading import offsets_in, shapes_in
from tests.support.obstacles import unit_shapes


def rates(distance, pose, curvature, lengths, offsets):
    """Return how x, y and all headings change for each metre: the general n-trailer."""
    heading = pose[2:]
    speed, rate, found = 1.0, curvature, [curvature]
    for j in range(1, len(heading)):
        bend = heading[j] - heading[j - 1]
        swing = offsets[j - 1] * rate
        own = -(speed * np.sin(bend) + swing * np.cos(bend)) / lengths[j]
        speed, rate = speed * np.cos(bend) - swing * np.sin(bend), own
        found.append(own)
    return [np.cos(heading[0]), np.sin(heading[0]), *found]


def way_of(worlds, agent, w, widening):
    """Return the poses (T, 2 + units) of a HAV on its way to all goals, along Dubins paths.

    Args:
        worlds: As an episode begins.
        agent: Index of the HAV.
        w: Index of the world.
        widening: Radius of the turns over the least that the HAV can drive for good.
    """
    units = worlds.fleet.num_trailers[agent, w] + 1
    lengths, offsets = worlds.fleet.length[agent, :units, w], offsets_in(worlds.fleet, w)[agent]
    radius = widening * drivable_radius(worlds, agent, w)
    pose = np.r_[
        worlds.state.x[agent, w], worlds.state.y[agent, w], worlds.state.heading[agent, :units, w]
    ]
    way = [pose[None]]
    for x, y, heading in worlds.goals[agent, :, :, w]:
        seen = ((x - pose[0]) + 1j * (y - pose[1])) * np.exp(-1j * pose[2])
        word, *parts = shortest_path(seen.real, seen.imag, heading - pose[2], radius)
        for side, part in zip(turns(word), parts, strict=True):
            if part > 0.0:
                at = np.linspace(0.0, part, max(2, int(part / 0.25)))
                args = side / radius, lengths, offsets
                done = scipy.integrate.solve_ivp(
                    rates, (0.0, part), pose, "DOP853", at, args=args, rtol=1e-9, atol=1e-9
                )
                way.append(done.y.T)
                pose = done.y[:, -1]
        assert np.hypot(pose[0] - x, pose[1] - y) < 1e-5
    return np.concatenate(way)


def way_bodies(worlds, agent, w, way) -> np.ndarray:
    """Return the bodies of a HAV at all poses of its way, as Shapely has them, in one row."""
    units, shape = way.shape[1] - 2, shapes_in(worlds.fleet, w)
    offset = offsets_in(worlds.fleet, w)[agent, :units]
    length = worlds.fleet.length[agent, :units, w]
    shape = None if shape is None else shape[agent, :units]
    return unit_shapes(way[:, 0], way[:, 1], way[:, 2:], length, offset, shape).ravel()
