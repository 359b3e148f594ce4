"""This module finds the points of obstacles that are nearest to a HAV's truck."""

import math

from hav_env.compiled import generic
from hav_env.maths.geometry import clip
from hav_env.world.arrays import into_truck_frame
from hav_env.world.place.segments import Obstacles, Plane, segment_of


@generic
def nearest_on_segment_of(place, world, agent, number, lane):
    """Return the point of a segment nearest to the own rear axle: forward [m], left [m]."""


@nearest_on_segment_of.register(Plane)
def _nowhere(place, world, agent, number, lane):
    return math.inf, math.inf


@nearest_on_segment_of.register(Obstacles)
def _nearest_point(place, world, agent, number, lane):
    state = world.state
    middle_x, middle_y, cosine, sine, half, _ = segment_of(place, number, lane)
    dx, dy = middle_x - state.x[agent, lane], middle_y - state.y[agent, lane]
    along = clip(-(dx * cosine + dy * sine), -half, half)
    return into_truck_frame(state, agent, lane, dx + along * cosine, dy + along * sine)
