"""This module is the yardstick in plain Python: floats, lists and functions of ``math``."""

import math

from benchmarks.yardsticks.five_trailers import (
    COSINE_LIMIT,
    GOALS,
    LENGTHS,
    POLICY,
    SPEED,
    STABLE_RADIUS,
    START,
    STEERING_MAX,
    TASK,
    Outcome,
)

_TURN = 2.0 * math.pi
_INFEASIBLE = (math.inf, 0.0, 0.0)
_ROUNDING = 1e-12  # rounding error of a zero angle [rad] or tangent [radii]


def drive_plain_python(num_steps: int) -> Outcome:
    """Drive for so many steps, at most to the last goal."""
    x, y, heading = START
    headings = [heading] * len(LENGTHS)
    truck, *trailers = LENGTHS
    sines, cosines = [0.0] * len(trailers), [1.0] * len(trailers)  # of the articulations
    dt, b, c = TASK.dt, POLICY.b, POLICY.c
    goals_hit, jackknife_step = 0, -1
    for step in range(1, num_steps + 1):
        goal_x, goal_y, goal_heading = GOALS[goals_hit]

        # AVOID-JACK
        dx, dy, cosine, sine = goal_x - x, goal_y - y, math.cos(headings[0]), math.sin(headings[0])
        forward, left = dx * cosine + dy * sine, dy * cosine - dx * sine
        side = goal_side(forward, left, goal_heading - headings[0], truck)
        weight = sum([1.0 + math.tanh(b - c * each) for each in cosines])
        ahead = math.cos(side * STEERING_MAX) + weight * cosines[0]
        aside = math.sin(side * STEERING_MAX) + weight * sines[0]
        steering = min(max(math.atan2(aside, ahead), -STEERING_MAX), STEERING_MAX)

        # kinematics: an Euler step, derivatives at its start
        x += dt * SPEED * cosine
        y += dt * SPEED * sine
        headings[0] += dt * SPEED * math.tan(steering) / truck
        speed = SPEED
        for joint, length in enumerate(trailers):
            headings[joint + 1] -= dt * speed / length * sines[joint]
            speed *= cosines[joint]

        # jackknife and goal
        for joint in range(len(trailers)):
            articulation = headings[joint + 1] - headings[joint]
            sines[joint], cosines[joint] = math.sin(articulation), math.cos(articulation)
        if jackknife_step < 0 and min(cosines) < COSINE_LIMIT:
            jackknife_step = step
        near = math.hypot(goal_x - x, goal_y - y) < TASK.distance_tolerance
        if near and abs(wrap(goal_heading - headings[0])) < TASK.heading_tolerance:
            goals_hit += 1
            if goals_hit == len(GOALS):
                break
    return Outcome(x, y, headings, goals_hit, jackknife_step)


def goal_side(forward, left, heading, truck):
    """Return 1.0, -1.0 or 0.0: the side to which the path to the goal starts."""
    close = POLICY.close_factor * truck
    radius = truck
    if forward * forward + left * left >= close * close:
        forward -= truck * math.cos(heading)
        left -= truck * math.sin(heading)
        radius = STABLE_RADIUS
    for turn, length in shortest_path(forward / radius, left / radius, wrap(heading)):
        if length * radius >= POLICY.straight_below:
            return turn
    return 0.0


def shortest_path(x, y, heading):
    """Return the (turn, length) of the three segments of the shortest Dubins path, radius 1."""
    sine, cosine = math.sin(heading), math.cos(heading)
    best, shortest = None, math.inf
    for turns, segments in (
        ((1.0, 0.0, 1.0), outer_tangent(x - sine, y + cosine - 1.0, heading)),
        ((-1.0, 0.0, -1.0), outer_tangent(x + sine, cosine - y - 1.0, -heading)),
        ((1.0, 0.0, -1.0), inner_tangent(x + sine, y - cosine - 1.0, heading)),
        ((-1.0, 0.0, 1.0), inner_tangent(x - sine, -y - cosine - 1.0, -heading)),
        ((-1.0, 1.0, -1.0), third_circle(x + sine, cosine - y - 1.0, -heading)),
        ((1.0, -1.0, 1.0), third_circle(x - sine, y + cosine - 1.0, heading)),
    ):
        first, second, third = segments
        length = first + second + third
        if length < shortest:
            best, shortest = (turns, segments), length
    return zip(*best, strict=True)


def outer_tangent(across_x, across_y, heading):
    """Return the segments of LSL; RSR is its mirror image. The same holds for the other words."""
    straight = math.hypot(across_x, across_y)
    if straight < _ROUNDING:
        return turn_angle(heading), 0.0, 0.0
    first = turn_angle(math.atan2(across_y, across_x))
    return first, straight, turn_angle(heading - first)


def inner_tangent(across_x, across_y, heading):
    """Return the segments of LSR."""
    squared = across_x * across_x + across_y * across_y - 4.0
    if squared < 0.0:
        return _INFEASIBLE
    straight = math.sqrt(squared)
    first = turn_angle(math.atan2(across_y, across_x) + math.atan2(2.0, straight))
    return first, straight, turn_angle(first - heading)


def third_circle(across_x, across_y, heading):
    """Return the segments of LRL."""
    distance = math.hypot(across_x, across_y)
    if distance > 4.0:
        return _INFEASIBLE
    middle = _TURN - 2.0 * math.asin(0.25 * distance)
    first = turn_angle(math.atan2(across_y, across_x) + 0.5 * middle)
    return first, middle, turn_angle(heading - first + middle)


def turn_angle(angle):
    """Return the angle [rad] in [0, 2 pi); an angle slightly below a turn becomes 0."""
    angle %= _TURN
    return 0.0 if angle > _TURN - _ROUNDING else angle


def wrap(angle):
    """Return the angle [rad] in [-pi, pi)."""
    return (angle + math.pi) % _TURN - math.pi
