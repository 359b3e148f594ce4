"""This module states the HAV of the yardsticks, its rules, and their report.

Values are pinned here, so the work stays the same if the project's defaults change.
"""

import math
from typing import NamedTuple

from baselines.policies.avoid_jack import AvoidJack, safe_speed
from hav_env import OnAxle, Task, explicit

TASK, POLICY = Task(), AvoidJack(close_factor=1.0)
VEHICLE = OnAxle(simultaneous=True)  # explicit Euler: arrays can compute it at once
LENGTHS = (4.0, 6.0, 8.0, 5.0, 7.0, 6.0)  # lengths of the truck and five trailers [m]
START = (0.0, 0.0, 0.0)
GOALS = (  # as far apart as the paper's are for this HAV; the last is hit after some 6,700 steps
    (100.0, 20.0, 1.0),
    (60.0, 90.0, 3.0),
    (10.0, 40.0, -1.5),
    (90.0, 10.0, 0.5),
    (20.0, 80.0, 2.0),
    (70.0, 50.0, -2.5),
)
SCENARIO = explicit([LENGTHS], [START], [GOALS], steering_max=math.radians(50.0))

# constants of the steps, computed once as in any reasonable program
STABLE_RADIUS = math.sqrt(sum(length * length for length in LENGTHS))  # R_min [m]
STEERING_MAX = SCENARIO.steering_max  # [rad]
COSINE_LIMIT = math.cos(SCENARIO.articulation_max)
SPEED = min(  # [m/s]
    SCENARIO.speed_max,
    safe_speed(POLICY.dt, *LENGTHS[:2], STEERING_MAX, SCENARIO.articulation_max, POLICY.beta),
)


class Outcome(NamedTuple):
    """The pose of a HAV after some steps, its goals and its jackknife."""

    x: float  # x of the truck's rear axle [m]
    y: float
    headings: list[float]  # headings of the truck and the trailers [rad]
    goals_hit: int
    jackknife_step: int  # -1 if it never jackknifed
