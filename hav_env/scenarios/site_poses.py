"""This module has scenarios among walls and kerbs: a site, its places, and ways between them.

Each HAV starts at one place and gets goals at others. A table tells which place may follow which.
"""

from collections.abc import Mapping, Sequence
from typing import Annotated, NamedTuple

import numpy as np

from hav_env.compiled import kernel
from hav_env.maths.random_numbers import uniform
from hav_env.models.annotations import Range, show
from hav_env.models.checks import check_relations, require
from hav_env.models.quantities import Goals, Havs, WorldAttempts
from hav_env.places import Site
from hav_env.places.contact import place_is_inside
from hav_env.scenarios.catalogue_fleet import CatalogueFleet
from hav_env.scenarios.fleets import draw_fleet, scenario_key
from hav_env.scenarios.written import read_numbers
from hav_env.world.arrays import HEADING, X, Y, put_straight
from hav_env.world.place.segments import place_site

Poses = Annotated[np.ndarray, Range(-1e8, 1e8)]
Flags = Annotated[np.ndarray, Range(0, 1)]


class SitePoses(NamedTuple):
    """HAVs that drive from place to place of a site. Build it with ``site_poses``.

    The starts of an episode differ from each other, and so do all first goals, all second ones and
    so on. Every place leaves a way on, so there may be any number of goals.
    """

    num_havs: Havs
    """Number of HAVs, at most that of the places where HAVs start."""
    num_goals: Goals
    """Number of goals that each HAV gets, one after the other."""
    fleet: CatalogueFleet
    """Vehicles that are drawn."""
    site: Site
    """Walls, kerbs and bounds."""
    place: Poses
    """(P, 3) x [m], y [m] and heading [rad] of the truck at each place; trailers are straight."""
    first: Flags
    """(P,) 1 where HAVs may start."""
    follows: Flags
    """(P, P) 1 where the place of the column may be the next goal after that of the row."""
    world_attempts: WorldAttempts = 1_000
    """Worlds drawn before the scenario gives up. A draw fails when no place is left for a HAV."""

    @property
    def max_trailers(self) -> int:
        """The fleet's."""
        return self.fleet.max_trailers

    @property
    def articulation_max(self) -> float:
        """The fleet's [rad]."""
        return self.fleet.articulation_max

    @property
    def num_segments(self) -> int:
        """S, how many segments the site has."""
        return self.site.num_segments


def site_poses(
    site: Site,
    fleet: CatalogueFleet,
    places: Mapping[str, Sequence[Sequence[float]]],
    ways: Mapping[str, Sequence[str]],
    starts: Sequence[str],
    num_havs: int,
    num_goals: int = 2,
) -> SitePoses:
    """Return a scenario whose places come in groups.

    Args:
        site: walls, kerbs and bounds.
        fleet: vehicles that are drawn.
        places: poses (x [m], y [m], heading [rad]) of each group.
        ways: for each group those whose places may follow. A place never follows itself.
        starts: groups where HAVs start.
        num_havs: how many HAVs there are.
        num_goals: how many goals each of them gets.

    Raises:
        TypeError, ValueError: naming the group or the place that is wrong.
    """
    _check_groups(places, ways, starts)
    owner = [name for name, poses in places.items() for _ in poses]
    follows = np.array([[later in ways[name] for later in owner] for name in owner], np.int64)
    np.fill_diagonal(follows, 0)
    return SitePoses(
        num_havs,
        num_goals,
        fleet,
        site,
        np.array([pose for poses in places.values() for pose in poses], float),
        np.array([name in starts for name in owner], np.int64),
        follows,
    )


def _check_groups(places: Mapping, ways: Mapping, starts: Sequence[str]) -> None:
    """Check that groups have poses, that each has ways on, and that all names are known."""
    for name, poses in places.items():
        for k, pose in enumerate(read_numbers(f"places[{name!r}]", poses, 2)):
            if len(pose) != 3:
                told = f"places[{name!r}][{k}] is {show(pose)}"
                raise ValueError(f"{told}, but must be a pose [x, y, heading]")
        if name not in ways:
            raise ValueError(f"ways has no entry for the group {name!r}, but must have one")
    named = {"starts": starts, "ways": ways, **{f"ways[{k!r}]": later for k, later in ways.items()}}
    for argument, names in named.items():
        for name in names:
            if name not in places:
                known = ", ".join(places) or "none"
                raise ValueError(f"{argument} names {show(name)}, but must name a group: {known}")
    if not any(map(len, places.values())):
        raise ValueError("places is empty, but must hold at least one pose")


@check_relations.register
def _(scenario: SitePoses) -> None:
    place, first, follows = scenario.place, scenario.first, scenario.follows
    if place.ndim != 2 or place.shape[1] != 3 or len(place) == 0:
        raise ValueError(f"scenario place has shape {place.shape}, but must have (P, 3)")
    for field, shape in (("first", (len(place),)), ("follows", (len(place), len(place)))):
        table = getattr(scenario, field)
        if table.shape != shape:
            raise ValueError(f"scenario {field} has shape {table.shape}, but must have {shape}")
        if not np.isin(table, (0, 1)).all():
            raise ValueError(f"scenario {field} must hold 0 and 1 alone")
    starts = int(np.count_nonzero(first))
    require(
        scenario.num_havs <= starts,
        "scenario",
        scenario,
        "num_havs",
        f"at most {starts}, the number of places where HAVs start",
    )
    for number, (x, y, _) in enumerate(place):
        if not place_is_inside(scenario.site, x, y):
            told = f"scenario place {number} is at ({x:g}, {y:g})"
            raise ValueError(f"{told}, but must be inside the boundary and outside polygons")
    dead = np.flatnonzero(follows.sum(axis=1) == 0)
    if len(dead):
        told = f"scenario follows has no place after place {show(int(dead[0]))}"
        raise ValueError(f"{told}, but every place must leave a way on")


def populate_site_poses(scenario, world, lane):
    """Draw the fleet and the places of one lane; draws that leave no place are drawn afresh."""
    place_site(world.place, scenario.site, lane)
    key = scenario_key(world, lane)
    draw = draw_fleet(scenario.fleet, world.fleet, lane, key, 0)
    for _ in range(scenario.world_attempts):
        found = True
        # phase -1 stands for the starts, which are kept where the first goals will be
        for phase in range(-1, scenario.num_goals):
            for agent in range(scenario.num_havs):
                found = found and _draw_place(scenario, world, agent, phase, lane, key, draw)
                draw += 1
        if found:
            _write_goals(scenario, world.goals, lane)
            return True
    return False


@kernel
def _draw_place(scenario, world, agent, phase, lane, key, draw):
    """Write a place that is free into the heading of a goal; tell whether there is one.

    The pose comes later: until then the number of the place tells which one may follow.
    """
    goals, row, before = world.goals, max(phase, 0), 0
    if phase >= 0:
        before = int(goals[agent, max(phase - 1, 0), HEADING, lane])
    free = 0
    for place in range(scenario.place.shape[0]):
        free += 1 if _is_free(scenario, goals, agent, phase, before, place, lane) else 0
    if free == 0:
        return False
    left = int(free * uniform(*key, draw))
    for place in range(scenario.place.shape[0]):
        if _is_free(scenario, goals, agent, phase, before, place, lane):
            if left == 0:
                goals[agent, row, HEADING, lane] = place
                if phase < 0:
                    x, y, heading = scenario.place[place]
                    put_straight(world.state, agent, lane, x, y, heading)
                break
            left -= 1
    return True


@kernel
def _is_free(scenario, goals, agent, phase, before, place, lane):
    """Tell whether a HAV may have a place in a phase: no HAV with a smaller number has it."""
    allowed = scenario.first[place] if phase < 0 else scenario.follows[before, place]
    free = allowed == 1
    for other in range(agent):
        free = free and int(goals[other, max(phase, 0), HEADING, lane]) != place
    return free


@kernel
def _write_goals(scenario, goals, lane):
    for agent in range(scenario.num_havs):
        for phase in range(scenario.num_goals):
            x, y, heading = scenario.place[int(goals[agent, phase, HEADING, lane])]
            goals[agent, phase, X, lane] = x
            goals[agent, phase, Y, lane] = y
            goals[agent, phase, HEADING, lane] = heading
