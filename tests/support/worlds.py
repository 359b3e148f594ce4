"""This module writes worlds by hand, for tests, and reads them."""

import math

import numpy as np

from hav_env import Batch, Explicit, RandomFleet, RandomPoses, Task, explicit
from hav_env.world.arrays import COSINE, DISTANCE, FOOTPRINT, SINE, STABLE, derive_radii
from hav_env.world.lanes import view_of
from hav_env.world.units.parts import Outlines, arrays_in

ALL = slice(None)


def wrapped(angle):
    """Return the angle [rad] moved by whole turns into (-pi, pi], by complex numbers."""
    return np.angle(np.exp(1j * np.asarray(angle)))


def chain(lengths, x, y, headings) -> np.ndarray:
    """Return the axles (units + 1, 2) of a HAV from the front of its truck to its end."""
    units = np.asarray(lengths)[:, None] * np.stack([np.cos(headings), np.sin(headings)], axis=1)
    return np.array([x, y]) + np.concatenate([units[:1], np.zeros((1, 2)), -units[1:].cumsum(0)])


def sample(scenario, num_worlds, seed=1):
    """Return the worlds of so many episodes at their beginning."""
    batch = Batch(scenario, num_worlds)
    batch.reset(seed)
    return batch.worlds


def places_of(worlds):
    """Return the positions of starts and goals (1 + G, N, 2, W)."""
    starts = np.stack([worlds.state.x, worlds.state.y], axis=1)
    return np.concatenate([starts[None], np.moveaxis(worlds.goals[:, :, :2], 1, 0)])


def open_plane(num_worlds=1, num_havs=1, num_trailers=3, *, task=Task(), vehicle=None, goals=1):
    """Return a batch whose HAVs ``put`` overwrites; none is near a goal."""
    fleet = RandomFleet(max_trailers=num_trailers)
    scenario = RandomPoses(num_havs=num_havs, num_goals=goals, fleet=fleet, area_factor=1e4)
    vehicles = {} if vehicle is None else {"vehicle": vehicle}
    batch = Batch(scenario, num_worlds, task, **vehicles)
    batch.reset(0)
    aim(batch.worlds, ALL, ALL, 1e9, 1e9, 1e9)
    batch.worlds.record.first[:] = -1
    return batch


def aim(worlds, agent, w, x, y, heading, phase=0):
    """Write a goal of a HAV, and set out for it: position [m], heading [rad]."""
    worlds.goals[agent, phase, 0, w] = x
    worlds.goals[agent, phase, 1, w] = y
    worlds.goals[agent, phase, 2, w] = heading
    worlds.state.goal[agent, :3, w] = worlds.goals[agent, phase, :, w]
    worlds.state.goal[agent, COSINE, w] = np.cos(heading)
    worlds.state.goal[agent, SINE, w] = np.sin(heading)
    worlds.state.goal[agent, DISTANCE, w] = math.inf  # found anew by the next step


def put(worlds, lengths, x=0.0, y=0.0, headings=0.0, *, w=0, agent=0):
    """Write one HAV into a world: lengths [m], rear axle of the truck [m], all headings [rad]."""
    state, fleet, units = worlds.state, worlds.fleet, len(lengths)
    headings = np.broadcast_to(np.asarray(headings, float), units)
    fleet.num_trailers[agent, w] = units - 1
    fleet.length[agent, :, w] = math.inf
    fleet.length[agent, :units, w] = lengths
    fleet.radius[agent, FOOTPRINT, w] = sum(lengths[1:])
    fleet.radius[agent, STABLE, w] = math.hypot(*lengths)
    state.x[agent, w], state.y[agent, w] = x, y
    state.heading[agent, :, w] = 0.0
    state.heading[agent, :units, w] = headings
    state.cosine[agent, :, w] = np.cos(state.heading[agent, :, w])
    state.sine[agent, :, w] = np.sin(state.heading[agent, :, w])


def hitch(worlds, offsets, limits=None, *, w=0, agent=0):
    """Hitch trailers off the axles: c_j [m] of all trailers, limits of their joints [rad]."""
    joints, trailers = worlds.fleet.joints, len(offsets)
    joints.offset[agent, :, w] = 0.0
    joints.offset[agent, :trailers, w] = offsets
    joints.limit[agent, 1 : trailers + 1, w] = math.pi / 2 if limits is None else limits


def limit(worlds, *, speed=1.0, steering=math.radians(50), articulation=math.pi / 2):
    """Give every HAV of every world the same limits."""
    columns = [speed, steering, articulation, math.cos(steering), math.sin(steering)]
    worlds.fleet.limit[:] = np.array(columns)[:, None]


def stand(batch, steps: int = 1) -> None:
    """Step without movement: written states are sensed and recorded."""
    nothing = np.zeros(batch.worlds.state.x.shape)
    for _ in range(steps):
        batch.step(nothing, nothing)


def bits(worlds, w: int = 0) -> list[bytes]:
    """Return the bytes of a world without scratch and the state of the neighbour search."""
    world = view_of(worlds, w)
    count, index = world.nearby[:2]
    neighbors = [row[:filled] for row, filled in zip(index, count, strict=True)]
    fleet = world.fleet._replace(joints=world.fleet.joints[:2])  # without scratch
    state = world.state._replace(ahead=world.state.ahead[:0])  # without scratch
    parts = state, fleet, world.goals, count, *neighbors, world.record
    return [array.tobytes() for array in arrays_in(parts)]


def side_by_side(*distances, gap=30.0) -> Explicit:
    """Return a scenario whose HAVs get to their goals by driving so far [m] straight on."""
    start = [[0.0, gap * k, 0.0] for k in range(len(distances))]
    goals = [[[far, gap * k, 0.0]] for k, far in enumerate(distances)]
    return explicit([[3.0, 4.0]] * len(distances), start, goals)


CATALOGUE_BODIES = ((1.25, 1.4, 0.9), (0.1, 0.0, 0.0), (1.25, 0.8, 1.2), (1.2, 0.9, 1.5))


def catalogue_like(vehicle):
    """Return a pair as real vehicles are: truck, drawbar, body, and a semitrailer on that.

    The truck's hitch is 1 m behind its axle, the last one 0.6 m ahead of the body's axle. Where the
    vehicle has bodies, they are ``CATALOGUE_BODIES``.
    """
    batch = open_plane(1, 2, 3, vehicle=vehicle)
    worlds = batch.worlds
    limit(worlds, speed=5.0)
    headings = np.array([0.3, 0.05, -0.15, -0.3])
    for hav, turn in enumerate((1.0, -2.0)):
        put(worlds, [4.5, 2.5, 6.0, 7.0], 0.0, 14.0 * hav, turn * headings, agent=hav)
        hitch(worlds, [1.0, 0.0, -0.6], [1.3, 1.0, 1.5], agent=hav)
        if isinstance(worlds.fleet.bodies, Outlines):
            worlds.fleet.bodies.shape[hav, :4, :, 0] = CATALOGUE_BODIES
        derive_radii(worlds.fleet, hav, 0, 0.0)
        aim(worlds, hav, 0, 30.0, 14.0 * hav + 5.0, 0.4)
    return batch
