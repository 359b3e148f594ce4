"""This package defines the kinematics of trucks and trailers, and a catalogue of real vehicles."""

import functools
from typing import Any

from hav_env.compiled import generic
from hav_env.models.checks import check_model, check_value
from hav_env.models.names import Registry
from hav_env.vehicles.actuators import (
    Instant,
    Limited,
    acting_block,
    actuate,
    actuators_in_field,
    actuators_of,
    check_actuators,
    is_instant,
)
from hav_env.vehicles.bodies import Bodies, Lines, Rectangles
from hav_env.vehicles.combinations import COMBINATIONS, Combination, Unit, catalogue
from hav_env.vehicles.off_axle import OffAxle, lead_off_axle, move_off_axle, pull_off_axle
from hav_env.vehicles.on_axle import OnAxle, lead_on_axle, move_on_axle, pull_on_axle
from hav_env.world.arrays import World


@generic
def move(vehicle: Any, dt: float, world: World, agent: int) -> None:
    """Move one HAV in every lane of a block of worlds, for ``dt`` [s].

    Reads the truck's speed ``state.speed[agent]`` [m/s] and ``state.steering[agent]`` [rad]. The
    actuators set both, within the HAV's limits. Writes the pose, and the headings with their
    cosines and sines. Units beyond a HAV's last have infinite length, so they do not turn.
    """


@generic
def pull(vehicle: Any, h: float, world: World, agent: int, unit: int) -> None:
    """Move one trailer in every lane of a block of worlds, for a substep ``h`` [s].

    It follows the motion of the unit ahead that ``lead`` or ``pull`` has stored in the block, and
    stores its own. ``move`` consists of such moves, so both give the same bits.
    """


@generic
def lead(vehicle: Any, world: World, lane: int, speed: float, cosine: float, sine: float) -> None:
    """Store the motion of a truck that drives straight on, for ``pull`` of its first trailer."""


def check_vehicle(vehicle: Any) -> None:
    """Check a vehicle model before its use.

    Raises:
        ValueError: if a field is outside its range; the message names its value and the rule.
        TypeError: if this is no vehicle, or a field has a value of another kind.
    """
    check_model("vehicle", vehicle, move)
    check_actuators(vehicle)
    check_value("vehicle bodies", Bodies, bodies_of(vehicle))


@functools.singledispatch
def needs_hitches(vehicle: Any) -> bool:
    """Return whether a vehicle's trailers may have off-axle hitches."""
    return False


def bodies_of(vehicle: Any) -> Any:
    """Return the bodies of a vehicle, lines by default."""
    return getattr(vehicle, "bodies", Lines())


needs_hitches.register(OffAxle, lambda vehicle: True)
move.register(OnAxle)(move_on_axle)
move.register(OffAxle)(move_off_axle)
pull.register(OnAxle)(pull_on_axle)
pull.register(OffAxle)(pull_off_axle)
lead.register(OnAxle)(lead_on_axle)
lead.register(OffAxle)(lead_off_axle)
for _vehicle in (OnAxle, OffAxle):
    actuators_of.register(_vehicle)(actuators_in_field)

VEHICLES = Registry(
    "vehicle",
    "hav_env.vehicles",
    move.table.__contains__,
    "register it with move.register",
    {
        "on_axle": OnAxle,
        "limited": OnAxle(actuators=Limited()),
        "off_axle": OffAxle,
        "rectangular": OffAxle(bodies=Rectangles()),
        "realistic": OffAxle(bodies=Rectangles(), actuators=Limited()),
    },
)

ACTUATORS = Registry(
    "actuators",
    "hav_env.actuators",
    actuate.table.__contains__,
    "register it with actuate.register",
    {"instant": Instant, "limited": Limited},
)

BODIES = Registry(
    "bodies",
    "hav_env.bodies",
    lambda model_class: model_class in (Lines, Rectangles),
    "it must be hav_env.vehicles.Lines or hav_env.vehicles.Rectangles",
    {"lines": Lines, "rectangles": Rectangles},
)

__all__ = [
    "ACTUATORS",
    "BODIES",
    "COMBINATIONS",
    "VEHICLES",
    "Combination",
    "Instant",
    "Limited",
    "Lines",
    "OffAxle",
    "OnAxle",
    "Rectangles",
    "Unit",
    "acting_block",
    "actuate",
    "actuators_of",
    "bodies_of",
    "catalogue",
    "check_vehicle",
    "is_instant",
    "lead",
    "move",
    "needs_hitches",
    "pull",
]
