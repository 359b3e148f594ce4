"""The paper's kinematics: an Ackermann truck, trailers hitched on the axle ahead."""

import math
from typing import NamedTuple

from hav_env.world import turn_unit


class OnAxle(NamedTuple):
    """On-axle hitching, rolling without slip, Euler integration.

    The paper does not state its integrator. By default one variable is updated after the other, as
    a program naturally would: the truck's heading, its position, then trailer by trailer, each from
    the newest values (sequential, or semi-implicit, Euler). That fits the published figures; the
    textbook's explicit Euler is ``simultaneous=True``. Both are of first order.
    """

    substeps: int = 1
    """Euler steps within one step of the simulation; the paper's is one."""
    simultaneous: bool = False
    """Take all derivatives at the beginning of an Euler step instead of in order."""


def check_on_axle(vehicle: OnAxle) -> None:
    """Raise ValueError unless there is at least one substep."""
    if not isinstance(vehicle.substeps, int) or vehicle.substeps < 1:
        raise ValueError(f"vehicle substeps is {vehicle.substeps}, but must be a whole number >= 1")


def move_on_axle(vehicle, dt, world, agent, speed, steering):
    """Integrate eqs. (kinematics) and (kinematics-trailers).

    The sine and the cosine of an articulation come from those of the two headings, which the state
    keeps.
    """
    state, length = world.state, world.fleet.length
    h = dt / vehicle.substeps
    yaw_per_speed = math.tan(steering) / length[agent, 0]
    for _ in range(vehicle.substeps):
        cosine_ahead, sine_ahead = state.cosine[agent, 0], state.sine[agent, 0]
        turn_unit(state, agent, 0, state.heading[agent, 0] + h * speed * yaw_per_speed)
        if not vehicle.simultaneous:
            cosine_ahead, sine_ahead = state.cosine[agent, 0], state.sine[agent, 0]
        state.x[agent] += h * speed * cosine_ahead
        state.y[agent] += h * speed * sine_ahead
        unit_speed = speed  # v^{j-1}, which decreases from unit to unit
        for unit in range(1, world.fleet.num_trailers[agent] + 1):
            cosine, sine = state.cosine[agent, unit], state.sine[agent, unit]
            sine_articulation = sine * cosine_ahead - cosine * sine_ahead
            yaw_rate = -unit_speed / length[agent, unit] * sine_articulation
            turn_unit(state, agent, unit, state.heading[agent, unit] + h * yaw_rate)
            if not vehicle.simultaneous:
                cosine, sine = state.cosine[agent, unit], state.sine[agent, unit]
            unit_speed *= cosine * cosine_ahead + sine * sine_ahead
            cosine_ahead, sine_ahead = cosine, sine
