"""This module has scenarios that are written down: given lengths, start poses and goal poses."""

import math
from collections.abc import Sequence
from typing import Annotated, NamedTuple

import numpy as np

from hav_env.compiled import canonical
from hav_env.models.annotations import Range, kinds_of, show
from hav_env.models.checks import check_fields, check_relations, check_value
from hav_env.models.quantities import Articulation, Goals, Havs, Share, Speed, Steering, Trailers
from hav_env.scenarios.written import (
    check_apart,
    check_lengths,
    check_poses,
    check_shapes,
    read_numbers,
)
from hav_env.world.arrays import derive_radii, put_straight, set_limits

# its numbers are checked HAV by HAV, below
Numbers = Annotated[np.ndarray, Range(-math.inf, math.inf)]


class Explicit(NamedTuple):
    """Given HAVs at given poses; every episode is the same. Build it with ``explicit``."""

    num_havs: Havs
    num_goals: Goals
    max_trailers: Trailers
    num_trailers: np.ndarray  # (N,)
    length: Numbers  # (N, U) [m], inf beyond the last unit
    start: Numbers  # (N, 3) x [m], y [m], heading [rad]
    goals: Numbers  # (N, G, 3)
    speed_max: Speed
    steering_max: Steering
    articulation_max: Articulation
    footprint_truck_share: Share = 0.0

    @property
    def fleet(self) -> "Explicit":
        """The HAVs: those that are written down."""
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
    lengths: Sequence[Sequence[float]],
    start: Sequence[Sequence[float]],
    goals: Sequence[Sequence[Sequence[float]]],
    *,
    speed_max: float = 1.0,
    steering_max: float = math.radians(40.0),
    articulation_max: float = math.pi / 2,
    footprint_truck_share: float = 0.0,
) -> Explicit:
    """Write a scenario down; docs/ranges.md says what numbers may be.

    Args:
        lengths: for each HAV the lengths [m] of its truck and its trailers, at least one trailer.
        start: for each HAV x [m], y [m], heading [rad].
        goals: for each HAV its goal poses, as many as the others have.
        speed_max: largest speed of all HAVs [m/s].
        steering_max: largest steering angle of all HAVs [rad].
        articulation_max: articulation beyond which HAVs are jackknifed [rad].
        footprint_truck_share: share of the truck's length in the footprint radius d_i.

    Raises:
        TypeError: naming what is no list or no number.
        ValueError: naming the HAV and what is wrong with it.
    """
    units = read_numbers("lengths", lengths, 2)
    poses, targets = read_numbers("start", start, 2), read_numbers("goals", goals, 3)
    if len(units) == 0:
        raise ValueError("a scenario needs at least one HAV")
    if not len(units) == len(poses) == len(targets):
        raise ValueError(
            f"{len(units)} HAVs have lengths, {len(poses)} a start and {len(targets)} goals"
        )
    for agent, (own, pose, own_goals) in enumerate(zip(units, poses, targets, strict=True)):
        if len(own) < 2:
            raise ValueError(f"HAV {agent} needs the lengths of a truck and at least one trailer")
        if len(own_goals) == 0 or len(own_goals) != len(targets[0]):
            raise ValueError(
                f"HAV {agent} has {len(own_goals)} goals; all need the same number, at least 1"
            )
        for place in (pose, *own_goals):
            if len(place) != 3:
                raise ValueError(f"HAV {agent}: {show(place)} is not a pose [x, y, heading]")
    most = max(map(len, units))
    shape = {"num_havs": len(units), "num_goals": len(targets[0]), "max_trailers": most - 1}
    for name, count in shape.items():  # before anything is allocated
        check_value(f"scenario {name}", kinds_of(Explicit)[name], count)
    scenario = Explicit(
        **shape,
        num_trailers=np.array([len(own) - 1 for own in units]),
        length=np.array([[*own, *[math.inf] * (most - len(own))] for own in units], float),
        start=np.array(poses, float),
        goals=np.array(targets, float),
        speed_max=speed_max,
        steering_max=steering_max,
        articulation_max=articulation_max,
        footprint_truck_share=footprint_truck_share,
    )
    check_fields("scenario", scenario)
    return canonical(scenario)


@check_relations.register
def _(scenario: Explicit) -> None:
    check_shapes(scenario)
    check_lengths(scenario.length, scenario.num_trailers)
    places = np.concatenate([scenario.start[:, None], scenario.goals], axis=1)  # (N, 1 + G, 3)
    check_poses(places)
    trailers = np.arange(1, scenario.max_trailers + 1) <= scenario.num_trailers[:, None]
    radius = np.where(trailers, scenario.length[:, 1:], 0.0).sum(axis=1)
    check_apart(places, radius + scenario.footprint_truck_share * scenario.length[:, 0])


def populate_explicit(scenario, world, lane):
    """Copy the scenario into one lane."""
    fleet = world.fleet
    for agent in range(scenario.num_havs):
        fleet.num_trailers[agent, lane] = scenario.num_trailers[agent]
        fleet.length[agent, :, lane] = math.inf
        for unit in range(scenario.num_trailers[agent] + 1):
            fleet.length[agent, unit, lane] = scenario.length[agent, unit]
        set_limits(scenario, fleet, agent, lane)
        derive_radii(fleet, agent, lane, scenario.footprint_truck_share)
        x, y, heading = scenario.start[agent]
        put_straight(world.state, agent, lane, x, y, heading)
        for goal in range(scenario.num_goals):
            for part in range(3):
                world.goals[agent, goal, part, lane] = scenario.goals[agent, goal, part]
    return True
