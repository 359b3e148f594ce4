"""This module bounds how far any point of a HAV moves in one step."""

import math

from hav_env.compiled import fixed, generic, kernel
from hav_env.safety.trial_moves import LONGEST_MOVE, SHORTEST_UNIT, WIDEST_BODY
from hav_env.world.arrays import SPEED, STEERING_COSINE, STEERING_SINE
from hav_env.world.rectangle_bodies import margin_of
from hav_env.world.units.joints import hitch_offset
from hav_env.world.units.parts import OnAxles

# with finite steps, an axle deviates from the movement of its hitch by at most this share of the
# squared step over the unit's length. The largest share is 0.69 at the end of a step, and below 1.0
# within it
_DRIFT = 1.0
_ROUNDED_UP = 1.0 + 1e-9


@kernel
def bound_displacement(world, agent, lane, step, squared_tangent):
    """Return a bound [m] on how far any point of a HAV's bodies moves in a step.

    Args:
        world: Block of worlds.
        agent: Index of the HAV.
        lane: Index of the world.
        step: Distance that the truck's rear axle moves [m].
        squared_tangent: Largest squared tangent of the steering angle.
    """
    fleet = world.fleet
    wheelbase = fleet.length[agent, 0, lane]
    front = step * math.sqrt(1.0 + squared_tangent * (1.0 + 2.0 * step / wheelbase))
    drift, swing, hitched = 0.0, margin_of(fleet.bodies, agent, 0, lane) * front / wheelbase, 0.0
    ahead, leverage = wheelbase, 1.0
    for unit in range(1, fleet.num_trailers[agent, lane] + 1):
        length = fleet.length[agent, unit, lane]
        offset = abs(hitch_offset(fleet.joints, agent, unit - 1, lane))
        hitched += offset
        # a hitch farther from an axle than the unit's length moves farther than the unit's front
        leverage *= max(1.0, offset / ahead)
        drift += _DRIFT / length
        swing = max(swing, margin_of(fleet.bodies, agent, unit, lane) * front / length)
        ahead = length
    # off-axle hitches pass on the speed of the front, on-axle hitches at most that of the rear
    if hitched > 0.0:
        return leverage * (front + leverage * drift * front * front + swing)
    return max(front, step + drift * step * step) + swing


@kernel
def most_displacement(world, agent, lane, dt):
    """Return a bound [m] on the movement of any point of a HAV in a step, for every command."""
    limit = world.fleet.limit
    cosine, sine = limit[agent, STEERING_COSINE, lane], limit[agent, STEERING_SINE, lane]
    tangent = sine / cosine
    return bound_displacement(world, agent, lane, dt * limit[agent, SPEED, lane], tangent * tangent)


@kernel
def roughly_most(world, agent, lane, dt):
    """Return a bound [m] on ``most_displacement``, without divisions in a loop.

    With on-axle hitches, 1 / l summed over the n trailers is at most n over the least length, and
    no swing is larger than that of the widest body on the shortest unit. The spare is far more than
    the rounding of sums of a hundred numbers. With other hitches it is the bound itself.
    """
    return _roughly_most(world.fleet.joints, world, agent, lane, dt)


@generic
def _roughly_most(joints, world, agent, lane, dt):
    """Return the bound for a kind of joints."""


@_roughly_most.otherwise
def _exactly_most(joints, world, agent, lane, dt):
    return most_displacement(world, agent, lane, dt)


@_roughly_most.register(OnAxles)
def _roughly_on_axles(joints, world, agent, lane, dt):
    fleet = world.fleet
    shortest, widest = fleet.length[agent, 0, lane], margin_of(fleet.bodies, agent, 0, lane)
    for unit in range(1, fleet.num_trailers[agent, lane] + 1):
        shortest = min(shortest, fleet.length[agent, unit, lane])
        widest = max(widest, margin_of(fleet.bodies, agent, unit, lane))
    return _longest_move(world, agent, lane, dt, shortest, widest)


@kernel
def _longest_move(world, agent, lane, dt, shortest, widest):
    """Return the bound [m], given the length of the shortest unit and the margin of the widest."""
    fleet, limit = world.fleet, world.fleet.limit
    cosine, sine = limit[agent, STEERING_COSINE, lane], limit[agent, STEERING_SINE, lane]
    step, squared = dt * limit[agent, SPEED, lane], (sine / cosine) * (sine / cosine)
    wheelbase = fleet.length[agent, 0, lane]
    front = step * math.sqrt(1.0 + squared * (1.0 + 2.0 * step / wheelbase))
    share = 1.0 / shortest
    drift = _DRIFT * float(fleet.num_trailers[agent, lane]) * share
    return _ROUNDED_UP * (max(front, step + drift * step * step) + widest * front * share)


@generic
def bound_moves(joints, world, agent, dt, rows):
    """Write the bound of ``roughly_most`` to row LONGEST_MOVE, in every lane of a block."""


@bound_moves.otherwise
def _bound_nothing(joints, world, agent, dt, rows):
    for lane in range(world.lanes):
        rows[LONGEST_MOVE, lane] = math.inf


@bound_moves.register(OnAxles)
def _bound_on_axles(joints, world, agent, dt, rows):
    fleet = world.fleet
    for lane in range(world.lanes):
        rows[SHORTEST_UNIT, lane] = fleet.length[agent, 0, lane]
        rows[WIDEST_BODY, lane] = margin_of(fleet.bodies, agent, 0, lane)
    for number in range(1, world.units):
        unit = fixed(number)
        for lane in range(world.lanes):
            shortest, widest = rows[SHORTEST_UNIT, lane], rows[WIDEST_BODY, lane]
            length = fleet.length[agent, unit, lane]
            width = margin_of(fleet.bodies, agent, unit, lane)
            present = unit <= fleet.num_trailers[agent, lane]
            rows[SHORTEST_UNIT, lane] = min(shortest, length) if present else shortest
            rows[WIDEST_BODY, lane] = max(widest, width) if present else widest
    for lane in range(world.lanes):
        rows[LONGEST_MOVE, lane] = _longest_move(
            world, agent, lane, dt, rows[SHORTEST_UNIT, lane], rows[WIDEST_BODY, lane]
        )
