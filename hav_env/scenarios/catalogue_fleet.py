"""This module draws fleets of real vehicles, with hitches, bodies and limits of their own."""

import math
from collections.abc import Sequence
from typing import Annotated, Any, NamedTuple

import numpy as np

from hav_env.compiled import kernel
from hav_env.maths.random_numbers import uniform
from hav_env.models.annotations import Range, is_number, show
from hav_env.models.checks import check_relations, require
from hav_env.models.quantities import Articulation, Length, Share, Speed, Steering, Trailers
from hav_env.vehicles import Combination, catalogue
from hav_env.world.arrays import derive_radii, set_limits
from hav_env.world.units.joints import hitch_trailer
from hav_env.world.units.outlines import shape_unit
from hav_env.world.units.parts import FRONT, HALF_WIDTH, REAR

_TABLES = ("num_trailers", "length", "offset", "limit", "shape", "share", "speed", "steering")
Table = Annotated[np.ndarray, Range(-math.inf, math.inf)]  # checked against the others, below


class CatalogueFleet(NamedTuple):
    """Vehicles of V kinds, drawn HAV by HAV. Build it with ``catalogue_fleet``.

    Fields without a row for each kind are the limits of all.
    """

    max_trailers: Trailers
    """U - 1, the most that a vehicle pulls."""
    min_length: Length
    """Least length of a unit [m]."""
    max_length: Length
    """Largest length of a unit [m]."""
    speed_max: Speed
    """Largest speed of the fastest vehicle [m/s]."""
    steering_max: Steering
    """Largest steering angle of any vehicle [rad]."""
    articulation_max: Articulation
    """Least limit of the joints of all vehicles [rad]: a policy that keeps below it keeps all."""
    num_trailers: Table
    """(V,) numbers of trailers."""
    length: Table
    """(V, U) of units [m], inf beyond the last."""
    offset: Table
    """(V, U) how far behind the axle of a unit its trailer is hitched [m]; 0 for the last unit."""
    limit: Table
    """(V, U) articulation of each trailer beyond which the HAV is jackknifed [rad]."""
    shape: Table
    """(V, U, 3) half width, front and rear overhang of each body [m]."""
    share: Table
    """(V,) with which probability a HAV is of this kind or one before."""
    speed: Table
    """(V,) largest speeds [m/s]."""
    steering: Table
    """(V,) largest steering angles [rad]."""
    footprint_truck_share: Share = 0.0
    """Share of the truck's length in the footprint radius d_i."""


def catalogue_fleet(
    vehicles: Sequence[str | Combination] | str | Combination,
    weights: Sequence[float] | None = None,
    *,
    speed_max: float | None = None,
) -> CatalogueFleet:
    """Return a fleet of vehicles of the catalogue, or of your own.

    Use it as the ``fleet`` of a scenario, with a vehicle model that knows hitches:
    ``parallel_env(scenario=RandomPoses(fleet=catalogue_fleet("wb-67")), vehicle="realistic")``.

    Args:
        vehicles: names in the catalogue, or ``Combination`` models; one, or a list.
        weights: how often each of them is drawn, relative to the others; equally by default.
        speed_max: largest speed of all [m/s]; by default the working speed of each.

    Raises:
        ValueError: when there is no such vehicle, or a weight is no number above 0.
        TypeError: when a vehicle is neither a name nor a ``Combination``.
    """
    listed = [vehicles] if isinstance(vehicles, str | Combination) else list(vehicles)
    if not listed:
        raise ValueError("vehicles is empty, but must name at least one vehicle of the catalogue")
    kinds = [one if isinstance(one, Combination) else catalogue(one) for one in listed]
    relative = [1.0] * len(kinds) if weights is None else list(weights)
    if len(relative) != len(kinds):
        raise ValueError(f"weights has {len(relative)} numbers, but must have {len(kinds)}")
    for weight in relative:
        if not (is_number(weight) and 0.0 < weight < math.inf):
            raise ValueError(f"weights holds {show(weight)}, but must hold finite numbers above 0")
    units = max(len(kind.units) for kind in kinds)
    length = np.full((len(kinds), units), math.inf)
    offset, limit = np.zeros((2, len(kinds), units))
    shape = np.zeros((len(kinds), units, 3))
    for k, kind in enumerate(kinds):
        for j, unit in enumerate(kind.units):
            length[k, j], limit[k, j] = unit.length, unit.articulation_max
            shape[k, j] = unit.half_width, unit.front, unit.rear
            if j > 0:
                offset[k, j - 1] = unit.hitch
    speed = np.array([kind.speed_max if speed_max is None else speed_max for kind in kinds])
    steering = np.array([kind.steering_max for kind in kinds])
    return CatalogueFleet(
        units - 1,
        float(length.min()),
        float(length[np.isfinite(length)].max()),
        float(speed.max()),
        float(steering.max()),
        min(unit.articulation_max for kind in kinds for unit in kind.units[1:]),
        np.array([len(kind.units) - 1 for kind in kinds]),
        length,
        offset,
        limit,
        shape,
        np.cumsum(relative) / np.sum(relative),
        speed,
        steering,
    )


class _Limits(NamedTuple):
    """What ``set_limits`` reads, of one HAV."""

    speed_max: float
    steering_max: float
    articulation_max: float


def draw_catalogue_fleet(catalogue_fleet, fleet, lane, key, draw):
    """Draw the HAVs of one lane; see ``hav_env.scenarios.fleets.draw_fleet``."""
    for agent in range(fleet.num_trailers.shape[0]):
        kind, share = 0, uniform(*key, draw)
        while kind < catalogue_fleet.share.shape[0] - 1 and share >= catalogue_fleet.share[kind]:
            kind += 1
        draw += 1
        _write_vehicle(catalogue_fleet, fleet, agent, lane, kind)
    return draw


@kernel
def _write_vehicle(catalogue_fleet, fleet, agent, lane, kind):
    """Give a HAV lengths, limits, hitches and bodies of a kind of vehicle."""
    last = catalogue_fleet.num_trailers[kind]
    fleet.num_trailers[agent, lane] = last
    fleet.length[agent, :, lane] = math.inf
    least = math.pi
    for unit in range(1, last + 1):
        least = min(least, catalogue_fleet.limit[kind, unit])
    speed, steering = catalogue_fleet.speed[kind], catalogue_fleet.steering[kind]
    set_limits(_Limits(speed, steering, least), fleet, agent, lane)
    for unit in range(last + 1):
        fleet.length[agent, unit, lane] = catalogue_fleet.length[kind, unit]
        offset, limit = catalogue_fleet.offset[kind, unit], catalogue_fleet.limit[kind, unit]
        hitch_trailer(fleet.joints, agent, unit, lane, offset, limit)
        shape = catalogue_fleet.shape[kind, unit]
        shape_unit(fleet.bodies, agent, unit, lane, shape[HALF_WIDTH], shape[FRONT], shape[REAR])
    derive_radii(fleet, agent, lane, catalogue_fleet.footprint_truck_share)


@check_relations.register
def _(fleet: CatalogueFleet) -> None:
    kinds, units = fleet.share.size, fleet.max_trailers + 1
    sizes: dict[str, tuple] = {
        "length": (kinds, units),
        "offset": (kinds, units),
        "limit": (kinds, units),
    }
    sizes |= {"shape": (kinds, units, 3)}
    for field in _TABLES:
        table: Any = getattr(fleet, field)
        told = f"an array of shape {sizes.get(field, (kinds,))}"
        require(table.shape == sizes.get(field, (kinds,)), "fleet", fleet, field, told)
    for k in range(kinds):
        own = slice(0, fleet.num_trailers[k] + 1)
        length, offset = fleet.length[k, own], fleet.offset[k, own]
        require(
            bool((abs(offset[:-1]) <= length[1:]).all()),
            "fleet",
            fleet,
            "offset",
            "at most the length of the trailer: articulations would grow down the chain",
        )
