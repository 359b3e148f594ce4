"""This module is the yardstick in NumPy.

Its arrays run over the units of the HAV, and over the six Dubins words.
"""

import numpy as np

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

_TURN = 2.0 * np.pi
_ROUNDING = 1e-12  # rounding error of a zero angle [rad] or tangent [radii]
_TRUCK, _TRAILERS = LENGTHS[0], np.array(LENGTHS[1:])
# The words LSL, RSR, LSR, RSL, RLR, LRL: the side on which each starts, the turns that follow.
_SIDE = np.array([1.0, -1.0, 1.0, -1.0, -1.0, 1.0])
_TURNS = np.array([[1, 0, 1], [-1, 0, -1], [1, 0, -1], [-1, 0, 1], [-1, 1, -1], [1, -1, 1]], float)
# From the start's circle to the goal's; the latter is on the other side of the path for LSR, RSL.
_GOAL_SIDE = np.array([1.0, 1.0, -1.0, -1.0, 1.0, 1.0])
_OUTER, _INNER, _THIRD = slice(0, 2), slice(2, 4), slice(4, 6)


def drive_small_arrays(num_steps: int) -> Outcome:
    """Drive for so many steps, at most to the last goal."""
    position, headings = np.array(START[:2]), np.full(len(LENGTHS), START[2])
    goals = np.array(GOALS)
    sines, cosines = np.zeros(len(_TRAILERS)), np.ones(len(_TRAILERS))  # of the articulations
    goals_hit, jackknife_step = 0, -1
    for step in range(1, num_steps + 1):
        goal, goal_heading = goals[goals_hit, :2], goals[goals_hit, 2]

        # AVOID-JACK
        along = np.array([np.cos(headings[0]), np.sin(headings[0])])
        across = np.array([-along[1], along[0]])
        side = goal_side(
            (goal - position) @ along, (goal - position) @ across, goal_heading - headings[0]
        )
        weight = np.sum(1.0 + np.tanh(POLICY.b - POLICY.c * cosines))
        ahead = np.cos(side * STEERING_MAX) + weight * cosines[0]
        aside = np.sin(side * STEERING_MAX) + weight * sines[0]
        steering = np.clip(np.arctan2(aside, ahead), -STEERING_MAX, STEERING_MAX)

        # kinematics: an Euler step, derivatives at its start
        position = position + TASK.dt * SPEED * along
        speeds = SPEED * np.concatenate(([1.0], np.cumprod(cosines[:-1])))  # of the unit ahead
        headings[0] += TASK.dt * SPEED * np.tan(steering) / _TRUCK
        headings[1:] -= TASK.dt * speeds / _TRAILERS * sines

        # jackknife and goal
        articulations = np.diff(headings)
        sines, cosines = np.sin(articulations), np.cos(articulations)
        if jackknife_step < 0 and np.any(cosines < COSINE_LIMIT):
            jackknife_step = step
        near = np.hypot(*(goal - position)) < TASK.distance_tolerance
        if near and abs(wrap(goal_heading - headings[0])) < TASK.heading_tolerance:
            goals_hit += 1
            if goals_hit == len(GOALS):
                break
    return Outcome(*position.tolist(), headings.tolist(), goals_hit, jackknife_step)


def goal_side(forward, left, heading):
    """Return 1.0, -1.0 or 0.0: the side to which the path to the goal starts."""
    close = POLICY.close_factor * _TRUCK
    radius = _TRUCK
    if forward * forward + left * left >= close * close:
        forward -= _TRUCK * np.cos(heading)
        left -= _TRUCK * np.sin(heading)
        radius = STABLE_RADIUS
    words = dubins_words(forward / radius, left / radius, wrap(heading))
    word = np.argmin(words.sum(axis=1))
    driven = words[word] * radius >= POLICY.straight_below
    return _TURNS[word, np.argmax(driven)] if driven.any() else 0.0


def dubins_words(x, y, heading):
    """Return the lengths (6, 3) of the segments of all Dubins words, radius 1, inf if infeasible.

    A word that starts to the right is the mirror image of one that starts to the left.
    """
    heading = _SIDE * heading
    across_x = x - _GOAL_SIDE * np.sin(heading)
    across_y = _SIDE * y + _GOAL_SIDE * np.cos(heading) - 1.0
    distance, bearing = np.hypot(across_x, across_y), np.arctan2(across_y, across_x)
    bearing[_OUTER][distance[_OUTER] < _ROUNDING] = heading[_OUTER][distance[_OUTER] < _ROUNDING]

    middle = distance.copy()  # the straight of LSL and RSR
    middle[_INNER] = np.sqrt(np.maximum(distance[_INNER] ** 2 - 4.0, 0.0))
    middle[_THIRD] = _TURN - 2.0 * np.arcsin(np.minimum(0.25 * distance[_THIRD], 1.0))

    first = bearing
    first[_INNER] += np.arctan2(2.0, middle[_INNER])
    first[_THIRD] += 0.5 * middle[_THIRD]
    first = turn_angle(first)

    third = heading - first
    third[_INNER] *= -1.0
    third[_THIRD] += middle[_THIRD]
    words = np.column_stack((first, middle, turn_angle(third)))
    words[_INNER][distance[_INNER] < 2.0] = np.inf
    words[_THIRD][distance[_THIRD] > 4.0] = np.inf
    return words


def turn_angle(angle):
    """Return the angles [rad] in [0, 2 pi); an angle slightly below a turn becomes 0."""
    angle = angle % _TURN
    return np.where(angle > _TURN - _ROUNDING, 0.0, angle)


def wrap(angle):
    """Return the angle [rad] in [-pi, pi)."""
    return (angle + np.pi) % _TURN - np.pi
