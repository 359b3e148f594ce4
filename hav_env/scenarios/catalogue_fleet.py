"""This module draws fleets of real vehicles, with hitches, bodies and limits of their own."""

import math
from collections.abc import Sequence
from typing import Annotated, Any, NamedTuple

import numpy as np

from hav_env.maths.random_numbers import uniform
from hav_env.models.annotations import Range, is_number, show
from hav_env.models.checks import check_relations
from hav_env.models.quantities import Articulation, Length, Share, Speed, Steering, Trailers
from hav_env.scenarios.given_vehicles import (
    check_vehicles,
    real_vehicle,
    tabulate_vehicles,
    write_vehicle,
)
from hav_env.vehicles import Combination, catalogue

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
    """Least limit of the joints of all vehicles [rad]; a policy below it satisfies all limits."""
    num_trailers: Table
    """(V,) numbers of trailers."""
    length: Table
    """(V, U) of units [m], inf beyond the last."""
    offset: Table
    """(V, U) distance of a unit's axle to the hitch of its trailer behind it [m]; 0 for the
    last."""
    limit: Table
    """(V, U) articulation of each trailer beyond which the HAV is jackknifed [rad]."""
    shape: Table
    """(V, U, 3) half width, front and rear overhang of each body [m]."""
    share: Table
    """(V,) cumulative probability: a HAV is of this kind or one before."""
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

    Use it as the ``fleet`` of a scenario, with a vehicle model that has hitches:
    ``parallel_env(scenario=RandomPoses(fleet=catalogue_fleet("wb-67")), vehicle="realistic")``.

    Args:
        vehicles: names in the catalogue, or ``Combination`` models; one, or a list.
        weights: relative frequency of each; equal by default.
        speed_max: largest speed of all [m/s]; by default the working speed of each.

    Raises:
        ValueError: if there is no such vehicle, or a weight is not a number above 0.
        TypeError: if a vehicle is neither a name nor a ``Combination``.
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
    given = [real_vehicle(kind) for kind in kinds]
    if speed_max is not None:
        given = [vehicle._replace(speed=speed_max) for vehicle in given]
    tables = tabulate_vehicles(given)
    length = tables["length"]
    return CatalogueFleet(
        min_length=float(length.min()),
        max_length=float(length[np.isfinite(length)].max()),
        speed_max=float(tables["speed"].max()),
        steering_max=float(tables["steering"].max()),
        articulation_max=min(float(vehicle.limit[1:].min()) for vehicle in given),
        share=np.cumsum(relative) / np.sum(relative),
        **tables,
    )


def fleet_of(fleet: Any) -> Any:
    """Return a fleet.

    Args:
        fleet: a model of a fleet, or what ``catalogue_fleet`` takes: names with commas between
            them, a ``Combination``, or a list of both.

    Raises:
        ValueError: if there is no such vehicle.
        TypeError: if this is neither a fleet nor a vehicle.
    """
    if isinstance(fleet, str):
        return catalogue_fleet([name.strip() for name in fleet.split(",")])
    if isinstance(fleet, Combination) or not hasattr(fleet, "_fields"):
        listed = isinstance(fleet, Combination | list | tuple)
        if not listed:
            rule = "must be a fleet, a vehicle of the catalogue or a list of vehicles"
            raise TypeError(f"fleet is {show(fleet)}, but {rule}")
        return catalogue_fleet(fleet)
    return fleet


def draw_catalogue_fleet(catalogue_fleet, fleet, lane, key, draw):
    """Draw the HAVs of one lane; see ``hav_env.scenarios.fleets.draw_fleet``."""
    for agent in range(fleet.num_trailers.shape[0]):
        kind, share = 0, uniform(*key, draw)
        while kind < catalogue_fleet.share.shape[0] - 1 and share >= catalogue_fleet.share[kind]:
            kind += 1
        draw += 1
        share_of_truck = catalogue_fleet.footprint_truck_share
        write_vehicle(catalogue_fleet, kind, share_of_truck, fleet, agent, lane)
    return draw


@check_relations.register
def _(fleet: CatalogueFleet) -> None:
    check_vehicles("fleet", fleet, fleet.share.size)
    share = fleet.share
    ascending = (np.diff(share, prepend=0.0) >= 0.0).all() and abs(share[-1] - 1.0) <= 1e-9
    if not ascending:
        told = f"fleet share is {show(share.tolist())}"
        raise ValueError(f"{told}, but must ascend from at least 0 to 1")
