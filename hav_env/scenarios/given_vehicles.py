"""This module defines vehicles given unit by unit, for explicit scenarios."""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from hav_env.compiled import kernel
from hav_env.models.annotations import show
from hav_env.models.checks import check_fields, check_value
from hav_env.models.quantities import Articulation, BodyWidth, Overhang, Speed, Steering
from hav_env.scenarios.written import check_lengths, read_numbers
from hav_env.vehicles import Combination, catalogue
from hav_env.world.arrays import (
    ARTICULATION,
    SPEED,
    STEERING,
    Fleet,
    World,
    derive_radii,
    set_limits,
)
from hav_env.world.units.joints import hitch_trailer
from hav_env.world.units.outlines import shape_unit
from hav_env.world.units.parts import FRONT, HALF_WIDTH, REAR, Hitches, Outlines

_PARTS, _SIZES = ("half width", "front", "rear"), (BodyWidth, Overhang, Overhang)
_USUAL = [-1.0, -1.0, -1.0]  # stands for a body that the fleet does not state


class GivenVehicle(NamedTuple):
    """One vehicle of K units; unit 0 is the truck."""

    length: np.ndarray
    """(K,) lengths of the units [m]."""
    offset: np.ndarray
    """(K,) distance of a unit's axle to the hitch of its trailer behind it [m]; 0 for the last."""
    limit: np.ndarray
    """(K,) articulation of each trailer beyond which the HAV is jackknifed [rad]."""
    shape: np.ndarray
    """(K, 3) half width, front and rear overhang of each body [m]; -1 for the usual body."""
    speed: float
    """Largest speed [m/s]."""
    steering: float
    """Largest steering angle [rad]."""


class HavLimits(NamedTuple):
    """Limits of one HAV, in the form that ``set_limits`` reads."""

    speed_max: float
    steering_max: float
    articulation_max: float


def plain_vehicle(lengths: Sequence[float], limits: HavLimits) -> GivenVehicle:
    """Return a vehicle of given lengths [m], hitched on the axles, with the usual bodies."""
    units = len(lengths)
    return GivenVehicle(
        np.array(lengths, float),
        np.zeros(units),
        np.full(units, limits.articulation_max),
        np.full((units, 3), -1.0),
        limits.speed_max,
        limits.steering_max,
    )


def real_vehicle(vehicle: Combination) -> GivenVehicle:
    """Return a vehicle of the catalogue, or one of the same form.

    Raises:
        ValueError, TypeError: if a number is wrong; the message names it.
    """
    if len(vehicle.units) < 2:
        raise ValueError(f"vehicle {vehicle.name} has no trailer, but must have at least one")
    for number, unit in enumerate(vehicle.units):
        check_fields(f"vehicle {vehicle.name} unit {number}", unit)
    return GivenVehicle(
        np.array(vehicle.lengths, float),
        np.array([*vehicle.offsets[1:], 0.0]),
        np.array(vehicle.limits),
        np.stack(vehicle.bodies, axis=-1),
        vehicle.speed_max,
        vehicle.steering_max,
    )


def read_vehicle(name: str, value: Any, limits: HavLimits) -> GivenVehicle:
    """Return a vehicle: lengths of its units [m], a name in the catalogue, or a vehicle itself.

    Args:
        name: name of the argument, for messages.
        value: value that the user passed.
        limits: limits of vehicles given by lengths alone.

    Raises:
        TypeError, ValueError: if a value is no vehicle; the message names it.
    """
    if isinstance(value, GivenVehicle):
        return value
    if isinstance(value, Combination | str):
        return real_vehicle(value if isinstance(value, Combination) else catalogue(value))
    return plain_vehicle(read_numbers(name, value, 1), limits)


def vehicle_in(fleet: Fleet, agent: int, lane: int) -> GivenVehicle:
    """Return the vehicle of a HAV in one lane."""
    units = slice(0, fleet.num_trailers[agent, lane] + 1)
    limit = fleet.limit[agent, :, lane]
    lengths = fleet.length[agent, units, lane]
    usual = HavLimits(*(float(limit[column]) for column in (SPEED, STEERING, ARTICULATION)))
    vehicle = plain_vehicle(lengths.tolist(), usual)
    if isinstance(fleet.joints, Hitches):
        offset, bend = (part[agent, units, lane].copy() for part in fleet.joints[:2])
        vehicle = vehicle._replace(offset=offset, limit=bend)
    if isinstance(fleet.bodies, Outlines):
        vehicle = vehicle._replace(shape=fleet.bodies.shape[agent, units, :, lane].copy())
    return vehicle


def bends_in(worlds: World, lane: int) -> list[list[float]]:
    """Return the articulations of all trailers of every HAV in one lane [rad]."""
    heading, last = worlds.state.heading[..., lane], worlds.fleet.num_trailers[:, lane]
    bends = np.remainder(np.diff(heading) + math.pi, 2.0 * math.pi) - math.pi
    # a HAV placed straight is straight, in spite of rounding
    bends[np.diff(heading) == 0.0] = 0.0
    return [own[:count].tolist() for own, count in zip(bends, last, strict=True)]


def tabulate_vehicles(vehicles: Sequence[GivenVehicle]) -> dict[str, Any]:
    """Return the arrays of V vehicles, by the names that ``write_vehicle`` reads, and U - 1."""
    units = max(len(vehicle.length) for vehicle in vehicles)

    def padded(field: str, empty: float) -> np.ndarray:
        parts = [getattr(vehicle, field) for vehicle in vehicles]
        table = np.full((len(vehicles), units, *parts[0].shape[1:]), empty)
        for row, part in zip(table, parts, strict=True):
            row[: len(part)] = part
        return table

    return {
        "max_trailers": units - 1,
        "num_trailers": np.array([len(vehicle.length) - 1 for vehicle in vehicles]),
        "length": padded("length", math.inf),
        "offset": padded("offset", 0.0),
        "limit": padded("limit", math.pi),
        "shape": padded("shape", -1.0),
        "speed": np.array([vehicle.speed for vehicle in vehicles], float),
        "steering": np.array([vehicle.steering for vehicle in vehicles], float),
    }


def check_vehicles(kind: str, tables: Any, count: int) -> None:
    """Check arrays of vehicles from any source, not only from ``tabulate_vehicles``.

    Args:
        kind: kind of the model with these arrays, for messages.
        tables: the model.
        count: V, number of vehicles.

    Raises:
        ValueError: if an array or a vehicle is wrong; the message names it and the rule.
    """
    units = tables.max_trailers + 1
    shapes: dict[str, tuple] = dict.fromkeys(("length", "offset", "limit"), (count, units))
    shapes |= {"shape": (count, units, 3)}
    for field in ("num_trailers", *shapes, "speed", "steering"):
        found, shape = getattr(tables, field).shape, shapes.get(field, (count,))
        if found != shape:
            raise ValueError(f"{kind} {field} has shape {found}, but must have {shape}")
    counts = tables.num_trailers
    if counts.dtype.kind not in "iu" or counts.min() < 1 or counts.max() >= units:
        told = f"whole numbers from 1 to {units - 1}"
        raise ValueError(f"{kind} num_trailers is {show(counts, str)}, but must be {told}")
    check_lengths(tables.length, counts)
    for field, quantity in (("speed", Speed), ("steering", Steering)):
        for value in getattr(tables, field).tolist():
            check_value(f"{kind} {field}", quantity, value)
    for k, last in enumerate(counts):
        for limit in tables.limit[k, 1 : last + 1].tolist():
            check_value(f"{kind} limit of vehicle {k}", Articulation, limit)
        offset, length = tables.offset[k], tables.length[k]
        behind = (abs(offset[:last]) <= length[1 : last + 1]).all() and not offset[last:].any()
        if not (behind and (offset[:last] >= -length[:last]).all()):
            raise ValueError(
                f"{kind} offset of vehicle {k} is {show(offset.tolist())}, but must be at most the"
                " length of the trailer behind it, not ahead of the unit's own front end, and 0"
                " for the last unit"
            )
        for bodies in tables.shape[k, : last + 1].tolist():
            for part, quantity, value in zip(_PARTS, _SIZES, bodies, strict=True):
                if bodies != _USUAL:
                    check_value(f"{kind} {part} of vehicle {k}", quantity, value)


@kernel
def write_vehicle(table, kind, truck_share, fleet, agent, lane):
    """Set lengths, limits, hitches and bodies of a HAV, and the quantities derived from them.

    Args:
        table: arrays with a row for each vehicle: ``num_trailers`` (V,), ``length``, ``offset`` and
            ``limit`` (V, U), ``shape`` (V, U, 3), ``speed`` and ``steering`` (V,).
        kind: number of its row.
        truck_share: share of the truck's length in the footprint radius d_i.
        fleet: fleet of a block of worlds.
        agent: number of the HAV.
        lane: number of the world.
    """
    last = table.num_trailers[kind]
    fleet.num_trailers[agent, lane] = last
    fleet.length[agent, :, lane] = math.inf
    least = math.pi
    for unit in range(1, last + 1):
        least = min(least, table.limit[kind, unit])
    set_limits(HavLimits(table.speed[kind], table.steering[kind], least), fleet, agent, lane)
    for unit in range(last + 1):
        fleet.length[agent, unit, lane] = table.length[kind, unit]
        offset, limit = table.offset[kind, unit], table.limit[kind, unit]
        hitch_trailer(fleet.joints, agent, unit, lane, offset, limit)
        shape = table.shape[kind, unit]
        if shape[HALF_WIDTH] >= 0.0:
            shape_unit(
                fleet.bodies, agent, unit, lane, shape[HALF_WIDTH], shape[FRONT], shape[REAR]
            )
    derive_radii(fleet, agent, lane, truck_share)
