"""This module states the ranges of quantities: lengths, speeds, durations, counts.

Beyond these bounds no number has a meaning. Inside them no computation overflows, yields NaN or
runs without end. For example, the quickest truck turns by less than 2e15 rad in the longest
episode. ``hav_env.maths.elementary.sincos`` is accurate up to that angle.
"""

import math
from typing import Annotated, Literal

from hav_env.models.annotations import Range

ABOVE_ZERO = math.nextafter(0.0, 1.0)

Length = Annotated[float, Range(0.01, 1e3, "m")]  # of a truck or a trailer
BodyWidth = Annotated[float, Range(0.0, 100.0, "m")]
Overhang = Annotated[float, Range(0.0, 100.0, "m")]  # of a body beyond a front end or an axle
RayRange = Annotated[float, Range(0.1, 1e6, "m")]
Gap = Annotated[float, Range(1e-3, 1e6, "m")]  # more than rounding adds up to along a row of HAVs
Coordinate = Annotated[float, Range(-1e8, 1e8, "m")]  # five times as far as web maps reach
Heading = Annotated[float, Range(-1e6, 1e6, "rad")]
Duration = Annotated[float, Range(1e-4, 10.0, "s")]  # of a step
Speed = Annotated[float, Range(1e-3, 1e3, "m/s")]
Acceleration = Annotated[float, Range(1e-3, 1e9, "m/s^2")]  # at the most no limit
Steering = Annotated[float, Range(1e-3, 1.5, "rad")]  # the most; at pi / 2 a truck cannot move
SteeringRate = Annotated[float, Range(1e-3, 1e9, "rad/s")]
GoalSpeed = Annotated[float, Range(0.0, math.inf, "m/s", "at least 0 m/s")]  # of a hit, at most
Articulation = Annotated[float, Range(1e-3, math.pi, "rad")]  # the most
Tolerance = Annotated[float, Range(1e-6, 1e6, "m")]
AngleTolerance = Annotated[float, Range(1e-6, 10.0, "rad")]
Distance = Annotated[float, Range(0.0, 1e6, "m")]  # any other, from nothing on
Angle = Annotated[float, Range(0.0, 10.0, "rad")]  # any other, from nothing on
Factor = Annotated[float, Range(0.0, 1e6)]
Widening = Annotated[float, Range(1.0, 100.0)]  # of a radius
Release = Annotated[float, Range(1.0, 1e6)]
Coefficient = Annotated[float, Range(-100.0, 100.0)]  # in exponents
Share = Annotated[float, Range(0.0, 1.0, said="from 0 to 1")]
Weight = Annotated[float, Range(-1e9, 1e9)]  # of a term of the reward
Offset = Annotated[float, Range(-1e3, 1e3)]
Spread = Annotated[float, Range(1e-3, 1e3)]  # of a random distribution
AreaFactor = Annotated[float, Range(1e-3, 1e6)]
AboveZero = Annotated[float, Range(ABOVE_ZERO, 1e6, said="above 0 and at most 1e+06")]

Havs = Annotated[int, Range(1, 10_000)]  # of a world
Seen = Annotated[int, Range(0, 1_000)]  # segments of which the nearest point is observed
Rays = Annotated[int, Range(0, 128)]  # as many as a block has lanes
Neighbors = Annotated[int, Range(0, 10_000)]  # observed neighbours, at most
Goals = Annotated[int, Range(1, 1_000)]  # of a HAV
Trailers = Annotated[int, Range(1, 100)]
Segments = Annotated[int, Range(0, 100_000)]  # of a world's obstacles
Steps = Annotated[int, Range(1, 10**8)]
Skipped = Annotated[int, Range(1, 10_000)]  # steps for which an action is held
Substeps = Annotated[int, Range(1, 1_000)]  # of a step
Attempts = Annotated[int, Range(1, 100_000)]  # to find a pose
WorldAttempts = Annotated[int, Range(1, 1_000)]
Worlds = Annotated[int, Range(1, 10**7)]
Threads = Annotated[int, Range(1, 1_024)]
Precision = Literal["double", "single"]  # of the state of worlds
Reports = Literal["always", "ends"]  # when environments report: after actions, at ends
