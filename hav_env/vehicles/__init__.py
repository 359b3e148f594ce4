"""How a truck and its trailers move: one file for each model, chosen by its type."""

import functools

from hav_env.compiled import generic
from hav_env.vehicles.on_axle import OnAxle, check_on_axle, move_on_axle


@generic
def move(vehicle, dt, world, agent, speed, steering):
    """Move one HAV of a world for ``dt`` [s] at a truck speed [m/s] and steering angle [rad].

    Writes the pose and the headings of the HAV. Speed and steering are within its limits.
    """


@functools.singledispatch
def check_vehicle(vehicle) -> None:
    """Check a vehicle model before it is used.

    Raises:
        ValueError: naming the field, its value and what is allowed.
        TypeError: when this is no vehicle.
    """
    raise TypeError(f"{vehicle!r} is not a vehicle: register its type with move")


move.register(OnAxle)(move_on_axle)
check_vehicle.register(OnAxle)(check_on_axle)

__all__ = ["OnAxle", "check_vehicle", "move"]
