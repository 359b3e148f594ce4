"""This module defines the actuators of trucks: how speed and steering follow commands.

With ``Instant`` both jump to the command, as in the paper. With ``Limited`` a truck accelerates,
brakes and turns its wheels at limited rates.
"""

import math
from typing import Any, NamedTuple

from hav_env.compiled import generic, kernel
from hav_env.maths.elementary import sincos, sqrt
from hav_env.maths.geometry import clip
from hav_env.models.annotations import show
from hav_env.models.checks import check_fields
from hav_env.models.quantities import Acceleration, SteeringRate
from hav_env.world.arrays import SPEED, STEERING, World
from hav_env.world.lanes import moving_block, rolling_block

_TINY_SINE = 1e-300  # keeps the fastest speed of straight wheels from a division by zero
_PI_SQUARED = math.pi * math.pi
_ABOVE_PI_SQUARED = 1.01 * _PI_SQUARED


class Instant(NamedTuple):
    """Speed and steering equal the command at once, as in the paper."""


class Limited(NamedTuple):
    """Speed and steering follow commands at limited rates; trucks slow down in curves.

    In each step the steering changes first. Then the limit of the lateral acceleration v^2 tan(phi)
    / l_0 clips the target speed. A truck that cannot brake as quickly as its wheels turn exceeds
    the lateral limit until it has slowed down.

    A HAV that hits its goal waits from then on: it brakes, with the wheels as they are, and may
    come to rest beyond the goal's tolerance. ``Task.goal_speed`` requires slow arrivals. Defaults
    are those of a loaded truck; 1e9 means no limit.
    """

    acceleration: Acceleration = 1.0
    """Largest increase of the speed [m/s^2]."""
    braking: Acceleration = 2.0
    """Largest decrease of the speed [m/s^2]."""
    steering_rate: SteeringRate = 0.5
    """Largest change of the steering angle [rad/s]; 0.52 of Apollo's truck, 0.71 of CommonRoad's
    truck (vehicle 4)."""
    lateral: Acceleration = 2.0
    """Largest lateral acceleration of the truck's rear axle [m/s^2]; trucks roll over from 3.4
    on."""


@generic
def actuate(actuators: Any, dt: float, world: World, agent: int, speed: Any, steering: Any) -> None:
    """Compute speed and steering of one HAV from its commands, in every lane of a block.

    Reads and writes ``state.speed[agent]`` and ``state.steering[agent]``, which hold the values of
    the previous step and stay within the HAV's limits. A HAV that waits ignores commands: its speed
    goes to zero and stays there.

    Args:
        actuators: the parameters; their type selects the kernel.
        dt: duration of the step [s].
        world: a block of worlds.
        agent: number of the HAV.
        speed: (N, W) commanded speeds [m/s].
        steering: (N, W) commanded steering angles [rad].
    """


@actuate.register(Instant)
def follow_at_once(actuators, dt, world, agent, speed, steering):
    """Clip speed and steering to the limits of a HAV; a HAV that waits stands."""
    state, limit = world.state, world.fleet.limit
    for lane in range(world.lanes):
        v = clip(speed[agent, lane], 0.0, limit[agent, SPEED, lane])
        steepest = limit[agent, STEERING, lane]
        state.speed[agent, lane] = 0.0 if state.waiting[agent, lane] else v
        state.steering[agent, lane] = clip(steering[agent, lane], -steepest, steepest)


@actuate.register(Limited)
def follow_within_limits(actuators, dt, world, agent, speed, steering):
    """Change speed and steering within the rates; a waiting HAV brakes and keeps its steering."""
    state, limit, lateral = world.state, world.fleet.limit, actuators.lateral
    turn, quick = actuators.steering_rate * dt, 0
    for lane in range(world.lanes):
        steepest, held = limit[agent, STEERING, lane], state.steering[agent, lane]
        wanted = clip(steering[agent, lane], -steepest, steepest)
        turned = clip(held if state.waiting[agent, lane] else wanted, held - turn, held + turn)
        state.steering[agent, lane] = turned
        aim = _aim(world, agent, lane, speed)
        quick += _may_be_quick(aim, turned, world.fleet.length[agent, 0, lane], lateral)
    faster, slower = actuators.acceleration * dt, actuators.braking * dt
    if quick > 0:
        for lane in range(world.lanes):
            wheelbase, turned = world.fleet.length[agent, 0, lane], state.steering[agent, lane]
            fastest = speed_in_curve(turned, wheelbase, lateral)
            aim, before = _aim(world, agent, lane, speed), state.speed[agent, lane]
            state.speed[agent, lane] = clip(min(aim, fastest), before - slower, before + faster)
    else:
        for lane in range(world.lanes):
            aim, before = _aim(world, agent, lane, speed), state.speed[agent, lane]
            state.speed[agent, lane] = clip(aim, before - slower, before + faster)


@kernel
def _aim(world, agent, lane, speed):
    """Return the target speed of a HAV [m/s], clipped to its limit."""
    v = clip(speed[agent, lane], 0.0, world.fleet.limit[agent, SPEED, lane])
    return 0.0 if world.state.waiting[agent, lane] else v


@kernel
def _may_be_quick(speed, steering, wheelbase, lateral):
    """Return whether a speed [m/s] may exceed ``speed_in_curve``; False implies that it does not.

    tan(x) is at most x pi^2 / (pi^2 - 4 x^2) up to a quarter turn (Becker and Stark, 1978). A
    margin of one hundredth covers rounding.
    """
    x = abs(steering)
    return speed * speed * (_ABOVE_PI_SQUARED * x) > lateral * wheelbase * (
        _PI_SQUARED - 4.0 * x * x
    )


@kernel
def speed_in_curve(steering, wheelbase, lateral):
    """Return the speed [m/s] at which v^2 tan(phi) / l_0 is a lateral acceleration [m/s^2]."""
    sine, cosine = sincos(steering)
    return sqrt(lateral * (wheelbase * cosine) / max(abs(sine), _TINY_SINE))


@generic
def acting_block(actuators: Any, world: World, agent: int) -> World:
    """Return the lanes in which a HAV moves in this step, as ``moving_block`` does."""
    raise NotImplementedError


@acting_block.register(Instant)
def _who_waits_stands(actuators, world, agent):
    return moving_block(world, agent)


@acting_block.otherwise
def _who_waits_may_roll(actuators, world, agent):
    return rolling_block(world, agent)


@generic
def actuators_of(vehicle: Any) -> Any:
    """Return the actuators of a vehicle: those in its field, if it is registered, or instant ones.

    To use a field ``actuators`` of a vehicle of your own, register
    ``actuators_of.register(MyVehicle)(actuators_in_field)``.
    """


@kernel
def actuators_in_field(vehicle):
    """Return the field ``actuators`` of a vehicle."""
    return vehicle.actuators


@actuators_of.otherwise
def _instant_actuators(vehicle):
    return _INSTANT


_INSTANT = Instant()


def is_instant(vehicle: Any) -> bool:
    """Return whether a vehicle follows commands at once, so that no waiting HAV rolls."""
    return isinstance(actuators_of(vehicle), Instant)


def check_actuators(vehicle: Any) -> None:
    """Check the actuators of a vehicle.

    Raises:
        TypeError: if they are no actuators, or a field has a value of another kind.
        ValueError: if a field is outside its range; the message names its value and the rule.
    """
    actuators = actuators_of(vehicle)
    if type(actuators) not in actuate.table:
        known = " or ".join(sorted(kind.__name__ for kind in actuate.table))
        told = f"vehicle actuators is {show(actuators)}, but must be {known}"
        raise TypeError(f"{told}: register your own class with actuate")
    check_fields("actuators", actuators)
