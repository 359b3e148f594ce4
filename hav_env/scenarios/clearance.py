"""This module reads the site of a world, and checks the given starts and goals of HAVs on it."""

import itertools
from typing import Any

import numpy as np

from hav_env.places.contact import bodies_touch, place_is_inside, touched_segment
from hav_env.places.site import BOUNDARY, LINE, NOWHERE, POLYGON, Site, join_outlines
from hav_env.world.chain import corners_of
from hav_env.world.place.segments import Plane

_NAMES = {BOUNDARY: "the boundary", POLYGON: "a polygon", LINE: "a line"}


def site_in(scenario: Any, place: Any, w: int) -> Site:
    """Return the site of a world: its scenario's site, or the drawn segments as lines.

    Args:
        scenario: scenario of the batch.
        place: place of the batch.
        w: number of the world.
    """
    if hasattr(scenario, "site"):
        return scenario.site
    if isinstance(place, Plane):
        return NOWHERE
    x, y, cosine, sine, half = place.segment[: place.count[w], :, w].T
    along = np.stack([half * cosine, half * sine], axis=-1)
    middle = np.stack([x, y], axis=-1)
    ends = np.stack([middle - along, middle + along], axis=1)  # (S, 2, 2)
    return join_outlines([(LINE, [points]) for points in ends])


def check_clear(scenario: Any) -> None:
    """Check the given starts and goals of a scenario against its site.

    At its start no part of a HAV may touch a segment, at its goals no part of its truck. Its rear
    axle must be inside the boundary and outside polygons. A body that the scenario does not state
    counts as a line. A vehicle model may give it a width later: a wider body that then touches a
    segment collides in step 1.

    Raises:
        ValueError: if a pose touches a segment; the message names HAV, place and segment.
    """
    site = scenario.site
    if site.num_segments == 0:
        return
    for agent in range(scenario.num_havs):
        units = slice(0, int(scenario.num_trailers[agent]) + 1)
        shape = scenario.shape[agent, units]
        shape = np.where(shape >= 0.0, shape, 0.0)
        length, offset = scenario.length[agent, units], scenario.offset[agent, units]
        x, y, heading = scenario.start[agent]
        bend = scenario.bend[agent, units]
        corners = corners_of(shape, x, y, heading + np.cumsum(bend), length, offset)
        _check_place(site, f"the start of HAV {agent}", "it", corners, x, y)
        for number, (x, y, heading) in enumerate(scenario.goals[agent], 1):
            truck = np.array([heading])
            corners = corners_of(shape[:1], x, y, truck, length[:1], offset[:1])
            _check_place(site, f"goal {number} of HAV {agent}", "its truck", corners, x, y)


def check_places(scenario: Any) -> None:
    """Check that each straight vehicle of the fleet fits at each place of a site.

    Vehicles also keep apart from each other at their start places. A body that the fleet
    does not state counts as a line.

    Raises:
        ValueError: if a vehicle does not fit; the message names place, vehicle and obstacle.
    """
    fleet, bodies = scenario.fleet, {}
    for number, (x, y, heading) in enumerate(scenario.place):
        for kind, last in enumerate(fleet.num_trailers):
            units = slice(0, int(last) + 1)
            shape = np.where(fleet.shape[kind, units] >= 0.0, fleet.shape[kind, units], 0.0)
            length, offset = fleet.length[kind, units], fleet.offset[kind, units]
            headings = np.full(len(length), heading)
            corners = corners_of(shape, x, y, headings, length, offset)
            who = f"vehicle {kind} of the fleet"
            _check_place(scenario.site, f"scenario place {number}", who, corners, x, y)
            bodies[number, kind] = corners
    starts = [at for at in bodies if scenario.first[at[0]] == 1]
    for one, other in itertools.combinations(starts, 2):
        if one[0] != other[0] and bodies_touch(bodies[one], bodies[other]):
            told = " and ".join(
                f"vehicle {kind} at place {number}" for number, kind in (one, other)
            )
            raise ValueError(f"scenario has {told} in contact, but HAVs may start at both")


def _check_place(site: Site, place: str, who: str, corners: np.ndarray, x: float, y: float) -> None:
    touched = touched_segment(site, corners)
    if touched is not None:
        ends = ", ".join(f"({a:.6g}, {b:.6g})" for a, b in site.segment[touched].reshape(2, 2))
        name = _NAMES[int(site.kind[site.outline[touched]])]
        told = f"{place} is at ({x:.6g}, {y:.6g})"
        raise ValueError(f"{told}, but {who} must not touch {name} there, from {ends}")
    if not place_is_inside(site, x, y):
        told = f"{place} is at ({x:.6g}, {y:.6g})"
        raise ValueError(f"{told}, but must be inside the boundary of the site, outside polygons")
