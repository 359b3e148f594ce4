"""This module drives HAVs along Dubins paths: single ones by SciPy, many ones in NumPy."""

import numpy as np
import scipy.integrate
import shapely

from baselines.sites.chain_motion import advance, chain_of, corner_points
from hav_env.maths.dubins import shortest_path, turns
from hav_env.vehicles import catalogue
from hav_env.world.sensing import drivable_radius
from hav_env.world.units.reading import offsets_in, shapes_in
from tests.support.obstacles import unit_shapes, wall_shapes

STRIDE = 0.25  # [m] of the integrator
LOOKED = 2  # strides from look to look
SEEN = 1.0  # [m], gaps beyond count as this


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


def least_gaps(worlds, names, widening) -> np.ndarray:
    """Return the least gaps (N, W) [m] to walls on the paths of HAVs to all their goals.

    Args:
        worlds: As an episode begins; all have as many walls.
        names: Vehicles of the catalogue that the fleet draws.
        widening: Radius of the turns over the least that a HAV can drive for good.
    """
    lengths, walls = np.moveaxis(worlds.fleet.length, 1, 2), wall_shapes(worlds).T
    found = np.full(worlds.state.x.shape, -np.inf)
    for chain in (chain_of(catalogue(name)) for name in names):
        units = len(chain.lengths)
        own = worlds.fleet.num_trailers == units - 1
        own &= (lengths[:, :, :units] == chain.lengths).all(axis=2)
        agent, w = np.nonzero(own)
        if len(w) > 0:
            sides, ways = _paths(worlds, agent, w, widening)
            state = np.stack([worlds.state.x[own], worlds.state.y[own]], axis=1)
            heading = worlds.state.heading[agent, :units, w]
            start = np.concatenate([state, heading], axis=1)
            found[agent, w] = _drive(chain, start, sides, ways, walls[w])
    return found


def _paths(worlds, agent, w, widening):
    """Return curvatures [1/m] and lengths [m] of the segments of the paths, (K, 3 G) each."""
    curvature, way = [], []
    for hav, world in zip(agent, w, strict=True):
        radius = widening * drivable_radius(worlds, hav, world)
        state = worlds.state
        pose = state.x[hav, world], state.y[hav, world], state.heading[hav, 0, world]
        for goal in worlds.goals[hav, :, :, world]:
            seen = complex(goal[0] - pose[0], goal[1] - pose[1]) * np.exp(-1j * pose[2])
            word, *parts = shortest_path(seen.real, seen.imag, goal[2] - pose[2], radius)
            curvature.append(np.array(turns(word)) / radius)
            way.append(parts)
            pose = goal
    return np.reshape(curvature, (len(w), -1)), np.reshape(way, (len(w), -1))


def _drive(chain, state, sides, ways, walls) -> np.ndarray:
    """Return the least gaps (K,) of chains on their way."""
    ends, gone = np.cumsum(ways, axis=1), np.zeros(len(state))
    least, active = np.full(len(state), SEEN), np.arange(len(state))
    ahead, looks = np.zeros(len(state), int), 0
    while len(active):
        if looks % LOOKED == 0:
            least[active] = np.minimum(least[active], _gaps(chain, state[active], walls[active]))
        looks += 1
        left = ends[active, ahead[active]] - gone[active]
        way = np.minimum(left, STRIDE)
        curvature = sides[active, ahead[active]]
        state[active] = advance(chain, state[active], curvature, way[:, None])
        gone[active] += way
        ahead[active] += way >= left
        active = active[ahead[active] < ends.shape[1]]
    return np.minimum(least, _gaps(chain, state, walls))


def _gaps(chain, states, walls) -> np.ndarray:
    """Return the gaps (K,) of chains from their walls (K, S) [m], up to ``SEEN``."""
    corners = corner_points(chain, states)  # (K, U, 4, 2)
    middle, reach = corners.mean(axis=2), 0.5 * np.ptp(chain.bodies[:, 1:], axis=1)
    reach = np.hypot(reach, chain.bodies[:, 0])  # half the diagonals of bodies
    ends = shapely.get_coordinates(walls).reshape(*walls.shape, 2, 2)
    along = ends[:, :, 1] - ends[:, :, 0]
    away = middle[:, :, None] - ends[:, None, :, 0]  # (K, U, S, 2)
    share = np.clip((away * along[:, None]).sum(axis=-1) / (along**2).sum(axis=-1)[:, None], 0, 1)
    away -= share[..., None] * along[:, None]
    hav, unit, wall = np.nonzero(np.hypot(*np.moveaxis(away, -1, 0)) < reach[:, None] + SEEN)
    found = np.full(len(states), SEEN)
    if len(hav) > 0:
        bodies = shapely.polygons(corners[hav, unit])
        np.minimum.at(found, hav, shapely.distance(bodies, walls[hav, wall]))
    return found
