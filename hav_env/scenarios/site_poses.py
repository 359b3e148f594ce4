"""This module defines scenarios at a site with places and connections between them.

Each HAV starts at one place and has goals at others. A table lists which place may follow which.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, NamedTuple

import numpy as np

from hav_env.compiled import kernel
from hav_env.maths.random_numbers import uniform
from hav_env.models.annotations import Range, show
from hav_env.models.checks import check_relations, require
from hav_env.models.quantities import Goals, Havs, WorldAttempts
from hav_env.places import Site
from hav_env.scenarios.catalogue_fleet import CatalogueFleet
from hav_env.scenarios.clearance import check_places
from hav_env.scenarios.fleets import draw_fleet, scenario_key
from hav_env.scenarios.written import read_numbers
from hav_env.world.arrays import HEADING, X, Y, put_straight
from hav_env.world.place.segments import place_site

Poses = Annotated[np.ndarray, Range(-1e8, 1e8)]
Flags = Annotated[np.ndarray, Range(0, 1)]
_SAME = 1e-6  # [m], [rad]: poses that differ by less are the same


class SitePoses(NamedTuple):
    """HAVs that drive from place to place of a site. Build it with ``site_poses``.

    The starts of an episode differ from each other, and so do all first goals, all second ones and
    so on. Every place has a connection onwards, so there may be any number of goals.
    """

    num_havs: Havs
    """Number of HAVs, at most the number of start places."""
    num_goals: Goals
    """Number of consecutive goals of each HAV."""
    fleet: CatalogueFleet
    """Distribution of the vehicles."""
    site: Site
    """Walls, kerbs and bounds."""
    place: Poses
    """(P, 3) x [m], y [m] and heading [rad] of the truck at each place; trailers are straight."""
    first: Flags
    """(P,) 1 where HAVs may start."""
    follows: Flags
    """(P, P) 1 where the place of the column may be the next goal after that of the row."""
    world_attempts: WorldAttempts = 1_000
    """Attempts to draw a world before the scenario fails. A draw fails if no place is left."""
    road: Poses = np.zeros((0, 4))  # a NamedTuple is immutable
    """(R, 4) x [m], y [m], heading [rad] and curvature [1/m] of poses on roads between the places,
    for ``hav_env.guidance.Roads``."""

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
        """Number S of segments of the site."""
        return self.site.num_segments


def site_poses(
    site: Site,
    fleet: CatalogueFleet,
    places: Mapping[str, Sequence[Sequence[float]]],
    ways: Mapping[str, Sequence[str]],
    starts: Sequence[str],
    num_havs: int,
    num_goals: int = 2,
    road: Sequence[Sequence[float]] = (),
) -> SitePoses:
    """Return a scenario whose places come in groups.

    Args:
        site: walls, kerbs and bounds.
        fleet: distribution of the vehicles.
        places: poses (x [m], y [m], heading [rad]) of each group.
        ways: for each group the groups whose places may follow. A place never follows itself.
        starts: groups of start places.
        num_havs: number of HAVs.
        num_goals: number of goals of each HAV.
        road: poses (x [m], y [m], heading [rad], curvature [1/m]) on roads between the places.

    Raises:
        TypeError, ValueError: if a group, a place or a road pose is wrong; the message names it.
    """
    _check_groups(places, ways, starts)
    _check_parts("road", road, ("x", "y", "heading", "curvature"))
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
        road=np.array(road, float).reshape(len(road), 4),
    )


def turn_pose(pose: Sequence[float], angle: float) -> tuple[float, float, float, float]:
    """Return a road pose (x [m], y [m], heading [rad], curvature [1/m]) turned round the origin."""
    x, y, heading, curvature = pose
    cosine, sine = math.cos(angle), math.sin(angle)
    turned = math.remainder(heading + angle, 2.0 * math.pi)
    return cosine * x - sine * y, sine * x + cosine * y, turned, curvature


def _check_groups(places: Mapping, ways: Mapping, starts: Sequence[str]) -> None:
    """Check that each group has poses and connections, and that all names exist."""
    for name, poses in places.items():
        _check_parts(f"places[{name!r}]", poses, ("x", "y", "heading"))
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


def _check_parts(name: str, poses: Sequence[Sequence[float]], parts: Sequence[str]) -> None:
    """Check that all poses have their parts, and that these are numbers."""
    for k, pose in enumerate(read_numbers(name, poses, 2)):
        if len(pose) != len(parts):
            told = f"{name}[{k}] is {show(pose)}"
            raise ValueError(f"{told}, but must be a pose [{', '.join(parts)}]")


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
    if scenario.road.ndim != 2 or scenario.road.shape[1] != 4:
        raise ValueError(f"scenario road has shape {scenario.road.shape}, but must have (R, 4)")
    _check_distinct(place, scenario.road)
    starts = int(np.count_nonzero(first))
    require(
        scenario.num_havs <= starts,
        "scenario",
        scenario,
        "num_havs",
        f"at most {starts}, the number of places where HAVs start",
    )
    check_places(scenario)
    dead = np.flatnonzero(follows.sum(axis=1) == 0)
    if len(dead):
        told = f"scenario follows has no place after place {show(int(dead[0]))}"
        raise ValueError(f"{told}, but every place must have a next one")


def _check_distinct(place: np.ndarray, road: np.ndarray) -> None:
    """Check that no road pose is the same as a place or as another road pose."""
    poses = np.concatenate([place, road[:, :3]])
    for number, pose in enumerate(road[:, :3]):
        before = poses[: len(place) + number] - pose
        turned = np.remainder(before[:, 2] + math.pi, 2.0 * math.pi) - math.pi
        same = (np.abs(before[:, :2]) < _SAME).all(axis=1) & (np.abs(turned) < _SAME)
        if same.any():
            other = int(same.argmax())
            name = f"place {other}" if other < len(place) else f"road pose {other - len(place)}"
            told = f"scenario has road pose {number} at {show(pose.tolist())}"
            raise ValueError(f"{told}, but must have no road pose there: it has {name}")


def populate_site_poses(scenario, world, lane):
    """Draw the fleet and the places of one lane; repeat draws that leave a HAV no place."""
    place_site(world.place, scenario.site, lane)
    key = scenario_key(world, lane)
    draw = draw_fleet(scenario.fleet, world.fleet, lane, key, 0)
    for _ in range(scenario.world_attempts):
        found = True
        # phase -1 means the starts, which are kept in the rows of the first goals
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
    """Write the number of a free place into the heading of a goal; return whether there is one.

    The pose comes later: until then the number determines which place may follow.
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
    """Return whether a place is free in a phase: no HAV with a smaller number has it."""
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
