"""This module finds the points of obstacles that are nearest to a HAV's truck."""

import math

from hav_env.compiled import generic, kernel
from hav_env.maths.geometry import clip
from hav_env.world.arrays import into_truck_frame
from hav_env.world.place.segments import Obstacles, Plane, segment_of


@generic
def nearest_to(place, number, x, y, lane):
    """Return where a segment is nearest to a place [m], as the difference from there in x and y."""


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
def nearest_of_segment(world, agent, number, lane):
    """Return the point of a segment nearest to the own rear axle: forward [m], left [m]."""
    state = world.state
    x, y = state.x[agent, lane], state.y[agent, lane]
    return into_truck_frame(state, agent, lane, *nearest_to(world.place, number, x, y, lane))
