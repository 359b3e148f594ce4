"""This module bounds how far any point of a HAV moves until the HAV stands.

docs/safety-filter.md has the proofs.
"""

from hav_env.compiled import kernel
from hav_env.maths.elementary import floor, sincos
from hav_env.safety.displacement import bound_displacement
from hav_env.world.arrays import SPEED, STEERING_COSINE, STEERING_SINE
from hav_env.world.sensing import own_speed


@kernel
def sum_of_speeds(speed, slower):
    """Return the sum of a speed and of the speeds of all steps after it in which a HAV brakes.

    Args:
        speed: Speed in the first step [m/s].
        slower: Decrease of the speed in a step [m/s].
    """
    steps = floor(speed / slower)
    return (steps + 1.0) * (speed - 0.5 * slower * steps)


@kernel
def bound_way(actuators, dt, world, agent, lane, speed, squared_tangent):
    """Return a bound [m] on how far any point of a HAV moves in a step and while it then brakes.

    The bound for a step grows at least in proportion to the speed.

    Args:
        actuators: Limits of the rates.
        dt: Duration of a step [s].
        world: Block of worlds.
        agent: Index of the HAV.
        lane: Index of the world.
        speed: Speed in the first step [m/s]; at most 0 for a HAV that stands.
        squared_tangent: Largest squared tangent of the steering angle.
    """
    if not speed > 0.0:
        return 0.0
    steps = sum_of_speeds(speed, actuators.braking * dt) / speed
    return steps * bound_displacement(world, agent, lane, dt * speed, squared_tangent)


@kernel
def own_way(actuators, dt, world, agent, speed):
    """Return that bound with the present steering, in a block of one world."""
    sine, cosine = sincos(world.state.steering[agent, 0])
    tangent = sine / cosine
    return bound_way(actuators, dt, world, agent, 0, speed, tangent * tangent)


@kernel
def way_of_other(actuators, dt, world, other, lane, brakes):
    """Return a bound [m] on how far another HAV moves until it stands, at any steering.

    ``brakes`` says that it brakes already in the next step. Otherwise it may first drive any
    command for a step.
    """
    limit, before = world.fleet.limit, own_speed(world, other, lane)
    tangent = limit[other, STEERING_SINE, lane] / limit[other, STEERING_COSINE, lane]
    slowest, fastest = before - actuators.braking * dt, before + actuators.acceleration * dt
    speed = slowest if brakes else min(fastest, limit[other, SPEED, lane])
    return bound_way(actuators, dt, world, other, lane, speed, tangent * tangent)
