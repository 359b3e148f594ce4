"""This module bounds how far any point of a HAV moves in one step."""

import math

from hav_env.compiled import kernel
from hav_env.world.arrays import SPEED, STEERING_COSINE, STEERING_SINE
from hav_env.world.rectangle_bodies import margin_of
from hav_env.world.units.joints import hitch_offset

# with finite steps, an axle deviates from the movement of its hitch by at most this share of the
# squared step over the unit's length. The largest share is 0.69 at the end of a step, and below 1.0
# within it
_DRIFT = 1.0


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
