"""This module defines explicit scenarios: given lengths, start poses and goal poses."""

import math
from collections.abc import Sequence
from typing import Annotated, Any, NamedTuple

import numpy as np

from hav_env.compiled import canonical
from hav_env.models.annotations import Range, kinds_of, show
from hav_env.models.checks import check_fields, check_relations, check_value
from hav_env.models.quantities import Articulation, Goals, Havs, Share, Speed, Steering, Trailers
from hav_env.places.site import NOWHERE, Site
from hav_env.scenarios.clearance import check_clear
from hav_env.scenarios.given_vehicles import (
    HavLimits,
    check_vehicles,
    read_vehicle,
    tabulate_vehicles,
    write_vehicle,
)
from hav_env.scenarios.written import (
    check_apart,
    check_poses,
    check_shapes,
    read_list,
    read_numbers,
)
from hav_env.world.arrays import put_straight, turn_unit
from hav_env.world.place.segments import place_site

# its numbers are checked HAV by HAV, below
Numbers = Annotated[np.ndarray, Range(-math.inf, math.inf)]


class Explicit(NamedTuple):
    """Given HAVs at given poses; every episode is the same. Build it with ``explicit``."""

    num_havs: Havs
    num_goals: Goals
    max_trailers: Trailers
    num_trailers: np.ndarray  # (N,)
    length: Numbers  # (N, U) [m], inf beyond the last unit
    offset: Numbers  # (N, U) how far behind the axle of a unit its trailer is hitched [m]
    limit: Numbers  # (N, U) of the articulation of each trailer [rad]
    shape: Numbers  # (N, U, 3) half width, front and rear overhang of bodies [m], -1 if usual
    speed: Numbers  # (N,) largest speeds [m/s]
    steering: Numbers  # (N,) largest steering angles [rad]
    bend: Numbers  # (N, U) articulation of each trailer at the start [rad]
    start: Numbers  # (N, 3) x [m], y [m], heading [rad]
    goals: Numbers  # (N, G, 3)
    speed_max: Speed
    steering_max: Steering
    articulation_max: Articulation
    footprint_truck_share: Share = 0.0
    site: Site = NOWHERE

    @property
    def num_segments(self) -> int:
        """The site's."""
        return self.site.num_segments

    @property
    def fleet(self) -> "Explicit":
        """The given HAVs."""
        return self

    @property
    def min_length(self) -> float:
        """Least length of a unit [m]."""
        return float(np.min(self.length))

    @property
    def max_length(self) -> float:
        """Largest length of a unit [m]."""
        return float(np.max(self.length[np.isfinite(self.length)]))


def explicit(
    lengths: Sequence[Any],
    start: Sequence[Sequence[float]],
    goals: Sequence[Sequence[Sequence[float]]],
    *,
    speed_max: float = 1.0,
    steering_max: float = math.radians(40.0),
    articulation_max: float = math.pi / 2,
    footprint_truck_share: float = 0.0,
    bends: Sequence[Sequence[float]] | None = None,
    site: Site = NOWHERE,
) -> Explicit:
    """Return an explicit scenario; docs/ranges.md lists the ranges of numbers.

    Args:
        lengths: for each HAV the lengths [m] of its truck and its trailers, at least one trailer;
            or a vehicle: a name in the catalogue, or a ``Combination``.
        start: for each HAV x [m], y [m], heading [rad].
        goals: for each HAV its goal poses, as many as the others have.
        speed_max: largest speed of all HAVs [m/s] whose lengths are given.
        steering_max: their largest steering angle [rad].
        articulation_max: articulation above which they are jackknifed [rad].
        footprint_truck_share: share of the truck's length in the footprint radius d_i.
        bends: for each HAV the articulations of its trailers at the start [rad]; 0 by default.
        site: walls and bounds that no HAV may touch, such as ``load_site`` returns. Starts and
            goals must be clear of them.

    Raises:
        TypeError: if a value is no list or no number; the message names it.
        ValueError: if a HAV is wrong; the message names the HAV and the rule.
    """
    poses, targets = read_numbers("start", start, 2), read_numbers("goals", goals, 3)
    limits = HavLimits(speed_max, steering_max, articulation_max)
    for name, limit in limits._asdict().items():
        check_value(f"scenario {name}", kinds_of(Explicit)[name], limit)
    units = [
        read_vehicle(f"lengths[{k}]", given, limits) for k, given in enumerate(read_list(lengths))
    ]
    if len(units) == 0:
        raise ValueError("a scenario needs at least one HAV")
    if not len(units) == len(poses) == len(targets):
        raise ValueError(
            f"{len(units)} HAVs have lengths, {len(poses)} a start and {len(targets)} goals"
        )
    for agent, (own, pose, own_goals) in enumerate(zip(units, poses, targets, strict=True)):
        if len(own.length) < 2:
            raise ValueError(f"HAV {agent} needs the lengths of a truck and at least one trailer")
        if len(own_goals) == 0 or len(own_goals) != len(targets[0]):
            raise ValueError(
                f"HAV {agent} has {len(own_goals)} goals; all need the same number, at least 1"
            )
        for place in (pose, *own_goals):
            if len(place) != 3:
                raise ValueError(f"HAV {agent}: {show(place)} is not a pose [x, y, heading]")
    most = max(len(own.length) for own in units)
    shape = {"num_havs": len(units), "num_goals": len(targets[0]), "max_trailers": most - 1}
    for name, count in shape.items():  # before anything is allocated
        check_value(f"scenario {name}", kinds_of(Explicit)[name], count)
    scenario = Explicit(
        num_havs=len(units),
        num_goals=len(targets[0]),
        **tabulate_vehicles(units),
        bend=_read_bends(bends, [len(own.length) - 1 for own in units]),
        start=np.array(poses, float),
        goals=np.array(targets, float),
        speed_max=float(max(own.speed for own in units)),
        steering_max=float(max(own.steering for own in units)),
        articulation_max=min(float(own.limit[1:].min()) for own in units),
        footprint_truck_share=footprint_truck_share,
        site=site,
    )
    check_fields("scenario", scenario)
    return canonical(scenario)


def _read_bends(bends: Sequence[Sequence[float]] | None, trailers: list[int]) -> np.ndarray:
    """Return the articulations at the start (N, U) [rad], given the numbers of trailers."""
    table = np.zeros((len(trailers), max(trailers) + 1))
    given = [[]] * len(trailers) if bends is None else read_numbers("bends", bends, 2)
    if len(given) != len(trailers):
        raise ValueError(f"bends has {len(given)} lists, but must have one for each HAV")
    for agent, (own, count) in enumerate(zip(given, trailers, strict=True)):
        if len(own) not in (0, count):
            told = f"bends of HAV {agent} has {len(own)} numbers"
            raise ValueError(f"{told}, but must have none or {count}, one for each trailer")
        table[agent, 1 : len(own) + 1] = own
    return table


@check_relations.register
def _(scenario: Explicit) -> None:
    check_vehicles("scenario", scenario, scenario.num_havs)
    check_shapes(scenario)
    beyond = ~(abs(scenario.bend) <= scenario.limit)
    if beyond.any():
        agent = int(np.argwhere(beyond)[0, 0])
        told = f"bends of HAV {agent} is {show(scenario.bend[agent, 1:].tolist())}"
        raise ValueError(f"{told}, but must be within the limits of its joints")
    places = np.concatenate([scenario.start[:, None], scenario.goals], axis=1)  # (N, 1 + G, 3)
    check_poses(places)
    trailers = np.arange(1, scenario.max_trailers + 1) <= scenario.num_trailers[:, None]
    along = np.where(trailers, abs(scenario.length[:, 1:] + scenario.offset[:, 1:]), 0.0)
    radius = along.sum(axis=1) + abs(scenario.offset[:, 0])
    check_apart(places, radius + scenario.footprint_truck_share * scenario.length[:, 0])
    check_clear(scenario)


def populate_explicit(scenario, world, lane):
    """Copy the scenario into one lane."""
    fleet, state = world.fleet, world.state
    place_site(world.place, scenario.site, lane)
    for agent in range(scenario.num_havs):
        write_vehicle(scenario, agent, scenario.footprint_truck_share, fleet, agent, lane)
        x, y, heading = scenario.start[agent]
        put_straight(state, agent, lane, x, y, heading)
        for unit in range(1, scenario.num_trailers[agent] + 1):
            if scenario.bend[agent, unit] != 0.0:
                turned = state.heading[agent, unit - 1, lane] + scenario.bend[agent, unit]
                for behind in range(unit, scenario.num_trailers[agent] + 1):
                    turn_unit(state, agent, behind, lane, turned)
        for goal in range(scenario.num_goals):
            for part in range(3):
                world.goals[agent, goal, part, lane] = scenario.goals[agent, goal, part]
    return True
