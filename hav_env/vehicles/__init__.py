"""How a truck and its trailers move: one file for each model, chosen by its type."""

from hav_env.compiled import generic
from hav_env.vehicles.on_axle import OnAxle, move_on_axle


@generic
def move(vehicle, dt, world, agent, speed, steering):
    """Move one HAV of a world for ``dt`` [s] at a truck speed [m/s] and steering angle [rad].

    Writes the pose and the headings of the HAV. Speed and steering are within its limits.
    """


move.register(OnAxle)(move_on_axle)

__all__ = ["OnAxle", "move"]
