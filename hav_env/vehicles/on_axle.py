"""This module defines the paper's kinematics: an Ackermann truck with on-axle hitched trailers."""

from typing import Any, NamedTuple

from hav_env.compiled import kernel, like
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import into_frame
from hav_env.models.quantities import Substeps
from hav_env.vehicles.actuators import Instant
from hav_env.vehicles.bodies import Bodies, Lines
from hav_env.world.arrays import AHEAD_COSINE, AHEAD_SINE, AHEAD_SPEED, turn_unit


class OnAxle(NamedTuple):
    """On-axle hitching, rolling without slip, Euler integration.

    The paper does not state its integrator. By default it updates one variable after the other, as
    a program naturally does: the truck's heading, its position, then trailer by trailer, each from
    the newest values (sequential, or semi-implicit, Euler). That fits the published figures.
    ``simultaneous=True`` is the textbook's explicit Euler. Both are of first order.
    """

    substeps: Substeps = 1
    """Euler steps within one step of the simulation; the paper's is one."""
    simultaneous: bool = False
    """Whether to take all derivatives at the beginning of an Euler step instead of in order."""
    bodies: Bodies = Lines()
    """Bodies: ``Lines()`` or ``Rectangles(...)``."""
    actuators: Any = Instant()
    """Actuators: ``Instant()`` or ``Limited(...)``."""


@kernel
def truck_yaw_rate(speed, steering, wheelbase):
    """Return v^0 tan(phi) / l^0 [rad/s], equation (1) of the paper."""
    sine, cosine = sincos(steering)
    return speed * sine / (wheelbase * cosine)


@kernel
def trailer_yaw_rate(speed_ahead, sine_articulation, length):
    """Return -v^{j-1} sin(delta^j) / l^j [rad/s], equation (2) of the paper."""
    return -speed_ahead * sine_articulation / length


@kernel
def trailer_speed(speed_ahead, cosine_articulation):
    """Return v^j = v^{j-1} cos(delta^j) [m/s], equation (2) of the paper."""
    return speed_ahead * cosine_articulation


def move_on_axle(vehicle, dt, world, agent):
    """Integrate equations (1) and (2) of the paper."""
    h = dt / like(vehicle.substeps, dt)
    for _ in range(vehicle.substeps):
        if vehicle.simultaneous:
            _advance_truck(h, world, agent)
            _turn_truck(h, world, agent)
        else:
            _turn_truck(h, world, agent)
            _advance_truck(h, world, agent)
        for unit in range(1, world.units):
            pull_on_axle(vehicle, h, world, agent, unit)


@kernel
def _turn_truck(h, world, agent):
    state = world.state
    for lane in range(world.lanes):
        wheelbase = world.fleet.length[agent, 0, lane]
        rate = truck_yaw_rate(state.speed[agent, lane], state.steering[agent, lane], wheelbase)
        turn_unit(state, agent, 0, lane, state.heading[agent, 0, lane] + h * rate)


@kernel
def _advance_truck(h, world, agent):
    state = world.state
    for lane in range(world.lanes):
        speed = state.speed[agent, lane]
        cosine, sine = state.cosine[agent, 0, lane], state.sine[agent, 0, lane]
        state.x[agent, lane] += h * speed * cosine
        state.y[agent, lane] += h * speed * sine
        _tow(state, lane, speed, cosine, sine)


@kernel
def pull_on_axle(vehicle, h, world, agent, unit):
    """Move one trailer of a HAV by an Euler step, behind the unit ahead; see ``_tow``."""
    state = world.state
    for lane in range(world.lanes):
        speed_ahead = state.ahead[AHEAD_SPEED, lane]
        ahead = state.ahead[AHEAD_COSINE, lane], state.ahead[AHEAD_SINE, lane]
        before = state.cosine[agent, unit, lane], state.sine[agent, unit, lane]
        _, sine_articulation = into_frame(*before, *ahead)
        rate = trailer_yaw_rate(
            speed_ahead, sine_articulation, world.fleet.length[agent, unit, lane]
        )
        after = turn_unit(state, agent, unit, lane, state.heading[agent, unit, lane] + h * rate)
        cosine, sine = before if vehicle.simultaneous else after
        cosine_articulation, _ = into_frame(cosine, sine, *ahead)
        _tow(state, lane, trailer_speed(speed_ahead, cosine_articulation), cosine, sine)


@kernel
def lead_on_axle(vehicle, world, lane, speed, cosine, sine):
    """Store the motion of a truck that drives straight on, for ``pull_on_axle``."""
    _tow(world.state, lane, speed, cosine, sine)


@kernel
def _tow(state, lane, speed, cosine, sine):
    """Store the values of this unit that the unit behind needs."""
    state.ahead[AHEAD_SPEED, lane] = speed
    state.ahead[AHEAD_COSINE, lane] = cosine
    state.ahead[AHEAD_SINE, lane] = sine
