"""This module finds the points of obstacles that are nearest to a HAV's truck."""

import math

from hav_env.compiled import generic, kernel
from hav_env.maths.geometry import clip
from hav_env.world.arrays import World, into_truck_frame
from hav_env.world.place.segments import Obstacles, Plane, num_segments, segment_of


@generic
def nearest_to(place, number, x, y, lane):
    """Return the vector from a position to the nearest point of a segment, in x and y [m]."""


@nearest_to.register(Plane)
def _nowhere(place, number, x, y, lane):
    return math.inf, math.inf


@nearest_to.register(Obstacles)
def _nearest_point(place, number, x, y, lane):
    middle_x, middle_y, cosine, sine, half, _ = segment_of(place, number, lane)
    dx, dy = middle_x - x, middle_y - y
    along = clip(-(dx * cosine + dy * sine), -half, half)
    return dx + along * cosine, dy + along * sine


@kernel
def num_obstacles(world: World, agent: int, lane: int) -> int:
    """Return the number of obstacle segments, at any distance."""
    return num_segments(world.place, lane)


@kernel
def obstacle_point(world: World, agent: int, k: int, lane: int) -> tuple[float, float]:
    """Return the point of segment ``k`` that is nearest to the truck: forward [m], left [m].

    The distance is measured from the truck's rear axle.
    """
    state = world.state
    x, y = state.x[agent, lane], state.y[agent, lane]
    return into_truck_frame(state, agent, lane, *nearest_to(world.place, k, x, y, lane))
