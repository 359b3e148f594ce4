"""This module defines the kinematics of trailers with off-axle hitches.

It is the general n-trailer: C. Altafini, "Some properties of the general n-trailer", International
Journal of Control 74(4), 2001.
"""

from typing import Any, Literal, NamedTuple

from hav_env.compiled import kernel
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import into_frame
from hav_env.models.quantities import Substeps
from hav_env.vehicles.actuators import Instant
from hav_env.vehicles.bodies import Bodies, Lines
from hav_env.vehicles.on_axle import truck_yaw_rate
from hav_env.world.arrays import turn_unit

EULER = 1  # place of the word in ``OffAxle.integrator``


class OffAxle(NamedTuple):
    """Mixed chains: a hitch behind the axle ahead, on it, or ahead of it, as a fifth wheel.

    Rolling without slip, as in the paper. By default a step uses the rates at its middle (the
    explicit midpoint rule, of second order). After a minute at 5 m/s with steps of 0.2 s, a chain
    of five units is 1 cm off. Euler steps are metres off.
    """

    substeps: Substeps = 1
    """Steps of the integrator within one step of the simulation."""
    integrator: Literal["midpoint", "euler"] = "midpoint"
    """Integrator. "euler" updates one variable after the other, from the newest values, as
    ``OnAxle`` does; with all hitches on the axles it gives the same bits."""
    bodies: Bodies = Lines()
    """Bodies: ``Lines()`` or ``Rectangles(...)``."""
    actuators: Any = Instant()
    """Actuators: ``Instant()`` or ``Limited(...)``."""


@kernel
def pull_of(speed, yaw_rate, cosine, sine, offset):
    """Return the speed of a hitch along a trailer and across it [m/s].

    v^j = v^{j-1} cos(delta^j) - c^j w^{j-1} sin(delta^j) is the speed of the trailer's axle.
    Across, v^{j-1} sin(delta^j) + c^j w^{j-1} cos(delta^j) = -l^j w^j turns the trailer.

    Args:
        speed: v^{j-1} of the axle ahead [m/s].
        yaw_rate: w^{j-1} of the unit ahead [rad/s].
        cosine: cosine of the articulation delta^j.
        sine: sine of the articulation.
        offset: c^j, distance of the trailer's hitch behind the axle ahead [m].
    """
    swing = offset * yaw_rate
    return speed * cosine - swing * sine, speed * sine + swing * cosine


@kernel
def pull_unit(own, ahead, speed, rate, offset, length, distance):
    """Return the motion of a trailer over a distance by the midpoint rule, halfway and after.

    Args:
        own: heading of the trailer before [rad].
        ahead: heading of the unit ahead, halfway [rad].
        speed: speed of the axle ahead, over the truck's.
        rate: yaw rate of the unit ahead, for each metre of the truck [rad/m].
        offset: distance of the trailer's hitch behind the axle ahead [m].
        length: length of the trailer [m].
        distance: distance of the truck [m].

    Returns:
        Speed over the truck's, yaw rate [rad/m], and the headings halfway and after [rad].
    """
    sine, cosine = sincos(own - ahead)
    _, across = pull_of(speed, rate, cosine, sine, offset)
    sine, cosine = sincos(own - 0.5 * distance * across / length - ahead)
    along, across = pull_of(speed, rate, cosine, sine, offset)
    rate = -across / length
    return along, rate, own + 0.5 * distance * rate, own + distance * rate


@kernel
def turn_direction(cosine, sine, angle):
    """Return a direction turned by an angle [rad], as cosine and sine.

    The result has length 1 for every angle. For small angles its error is angle**5 / 120. The
    midpoint rule uses it for half a step, and so stays of second order.
    """
    half = 0.5 * angle
    tangent = half + half * half * half * (1.0 / 3.0)
    share = 2.0 / (1.0 + tangent * tangent)
    turned_cosine, turned_sine = share - 1.0, share * tangent
    return (
        cosine * turned_cosine - sine * turned_sine,
        sine * turned_cosine + cosine * turned_sine,
    )


def move_off_axle(vehicle, dt, world, agent):
    """Integrate the equations above, unit by unit from front to rear."""
    h = dt / vehicle.substeps
    for _ in range(vehicle.substeps):
        if vehicle.integrator == EULER:
            _step_truck(h, world, agent)
            for unit in range(1, world.units):
                _step_trailer(h, world, agent, unit)
        else:
            _turn_truck_midway(h, world, agent)
            for unit in range(1, world.units):
                _pull_trailer_midway(h, world, agent, unit)


@kernel
def pull_off_axle(vehicle, h, world, agent, unit):
    """Move one trailer of a HAV by a step of the integrator, behind the unit ahead."""
    if vehicle.integrator == EULER:
        _step_trailer(h, world, agent, unit)
    else:
        _pull_trailer_midway(h, world, agent, unit)


@kernel
def lead_off_axle(vehicle, world, lane, speed, cosine, sine):
    """Store the motion of a truck that drives straight on, for ``pull_off_axle``."""
    _hand_on(world.fleet.joints.ahead, lane, speed, 0.0, cosine, sine)
    _hand_on(world.fleet.joints.halfway, lane, speed, 0.0, cosine, sine)


@kernel
def _step_truck(h, world, agent):
    state, ahead = world.state, world.fleet.joints.ahead
    for lane in range(world.lanes):
        speed, wheelbase = state.speed[agent, lane], world.fleet.length[agent, 0, lane]
        rate = truck_yaw_rate(speed, state.steering[agent, lane], wheelbase)
        heading = state.heading[agent, 0, lane] + h * rate
        cosine, sine = turn_unit(state, agent, 0, lane, heading)
        state.x[agent, lane] += h * speed * cosine
        state.y[agent, lane] += h * speed * sine
        _hand_on(ahead, lane, speed, rate, cosine, sine)


@kernel
def _step_trailer(h, world, agent, unit):
    state, joints = world.state, world.fleet.joints
    ahead = joints.ahead
    for lane in range(world.lanes):
        speed, rate = ahead.speed[lane], ahead.yaw_rate[lane]
        length = world.fleet.length[agent, unit, lane]
        offset = joints.offset[agent, unit - 1, lane]
        direction = ahead.cosine[lane], ahead.sine[lane]
        before = state.cosine[agent, unit, lane], state.sine[agent, unit, lane]
        _, across = pull_of(speed, rate, *into_frame(*before, *direction), offset)
        own_rate = -across / length
        after = turn_unit(state, agent, unit, lane, state.heading[agent, unit, lane] + h * own_rate)
        along, _ = pull_of(speed, rate, *into_frame(*after, *direction), offset)
        _hand_on(ahead, lane, along, own_rate, *after)


@kernel
def _turn_truck_midway(h, world, agent):
    """Turn and move the truck: its yaw rate is the same during the whole step."""
    state, joints = world.state, world.fleet.joints
    for lane in range(world.lanes):
        speed, wheelbase = state.speed[agent, lane], world.fleet.length[agent, 0, lane]
        rate = truck_yaw_rate(speed, state.steering[agent, lane], wheelbase)
        cosine, sine = state.cosine[agent, 0, lane], state.sine[agent, 0, lane]
        _hand_on(joints.ahead, lane, speed, rate, cosine, sine)
        cosine, sine = turn_direction(cosine, sine, 0.5 * h * rate)
        _hand_on(joints.halfway, lane, speed, rate, cosine, sine)
        state.x[agent, lane] += h * speed * cosine
        state.y[agent, lane] += h * speed * sine
        turn_unit(state, agent, 0, lane, state.heading[agent, 0, lane] + h * rate)


@kernel
def _pull_trailer_midway(h, world, agent, unit):
    """Turn a trailer to the middle of the step by its first yaw rate, then by the rate there."""
    state, joints = world.state, world.fleet.joints
    ahead, halfway = joints.ahead, joints.halfway
    for lane in range(world.lanes):
        to_yaw_rate = -1.0 / world.fleet.length[agent, unit, lane]
        offset = joints.offset[agent, unit - 1, lane]
        own = state.cosine[agent, unit, lane], state.sine[agent, unit, lane]
        speed, rate = ahead.speed[lane], ahead.yaw_rate[lane]
        bend = into_frame(*own, ahead.cosine[lane], ahead.sine[lane])
        along, across = pull_of(speed, rate, *bend, offset)
        own_rate = to_yaw_rate * across
        _hand_on(ahead, lane, along, own_rate, *own)

        own = turn_direction(*own, 0.5 * h * own_rate)
        speed, rate = halfway.speed[lane], halfway.yaw_rate[lane]
        bend = into_frame(*own, halfway.cosine[lane], halfway.sine[lane])
        along, across = pull_of(speed, rate, *bend, offset)
        own_rate = to_yaw_rate * across
        _hand_on(halfway, lane, along, own_rate, *own)
        turn_unit(state, agent, unit, lane, state.heading[agent, unit, lane] + h * own_rate)


@kernel
def _hand_on(motion, lane, speed, yaw_rate, cosine, sine):
    """Store the values of this unit that the unit behind needs."""
    motion.speed[lane], motion.yaw_rate[lane] = speed, yaw_rate
    motion.cosine[lane], motion.sine[lane] = cosine, sine
