"""This module refuses single precision where float32 is too coarse: far away, in short steps.

A position is rounded after every step. Straight ahead, all these errors have the same sign, so they
grow with the distance from the origin, and with the number of steps in a second.
"""

from typing import Any

import numpy as np

from hav_env.guidance import Feasible
from hav_env.places import Site
from hav_env.scenarios import Explicit, SitePoses
from hav_env.world.arrays import World, X, Y
from hav_env.world.place.guidance import Dubins
from hav_env.world.task import Task

FARTHEST_SINGLE = 2_048.0
"""Largest coordinate [m]: up to here float32 has every 0.12 mm.

In 120 steps a HAV moves away from its way in double precision by up to 2 mm within 1,000 m of the
origin, and by up to 6 mm at 2,000 m. ``swarm-200`` reaches 1,400 m.
"""
SHORTEST_SINGLE = 0.05
"""Shortest step [s]: near the origin, a HAV moves away by up to 2 mm in 24 s."""
_OTHERWISE = 'or use precision="double"'


def check_single(scenario: Any, task: Task, guidance: Any) -> None:
    """Check that a scenario, rules and guidance suit single precision.

    Raises:
        ValueError: If a coordinate of the scenario or of its site is too far from the origin, steps
            are too short, or the guidance needs double precision; the message names it.
    """
    if not isinstance(guidance, Dubins | Feasible):
        raise ValueError(
            f"precision is 'single', but must be 'double' with {type(guidance).__name__}:"
            " only the routes of Dubins and Feasible are found in single precision"
        )
    if task.dt < SHORTEST_SINGLE:
        raise ValueError(
            f"task dt is {task.dt:g} s, but must be at least {SHORTEST_SINGLE:g} s with"
            ' precision="single", which rounds positions after every step: use a longer step,'
            f" {_OTHERWISE}"
        )
    check_near_origin(scenario)


def check_near_origin(scenario: Any) -> None:
    """Check the coordinates that a scenario states: those of its site, starts, goals and places.

    Raises:
        ValueError: If one is too far from the origin; the message names it.
    """
    if isinstance(getattr(scenario, "site", None), Site):
        _require_near("the site has a segment", scenario.site.segment.reshape(-1, 2))
    if isinstance(scenario, SitePoses):
        _require_near("the scenario has a place", scenario.place[:, :2])
        _require_near("the scenario has a road pose", scenario.road[:, :2])
    if isinstance(scenario, Explicit):
        for agent, (start, goals) in enumerate(zip(scenario.start, scenario.goals, strict=True)):
            _require_near(f"HAV {agent} starts", start[None, :2])
            _require_near(f"HAV {agent} has a goal", goals[:, :2])


def check_drawn(worlds: World, places: np.ndarray, placed: np.ndarray) -> None:
    """Check where the scenario has put HAVs and goals.

    Args:
        worlds: Worlds in single precision.
        places: Indices of the worlds whose episodes have just begun.
        placed: (len(places),) bool, worlds that the scenario has filled; cleared before an error,
            so that no world has an episode.

    Raises:
        ValueError: If a start or a goal is too far from the origin.
    """
    full = places[placed]
    starts = np.stack([worlds.state.x[:, full], worlds.state.y[:, full]])
    goals = np.moveaxis(worlds.goals[:, :, [X, Y]][..., full], 2, 0)
    try:
        _require_near("the scenario has put a HAV", starts.reshape(2, -1).T)
        _require_near("the scenario has put a goal", goals.reshape(2, -1).T)
    except ValueError:
        placed[:] = False
        raise


def _require_near(what: str, points: np.ndarray) -> None:
    """Raise ValueError if one of the points (P, 2) [m] is too far from the origin."""
    far = np.argwhere(np.abs(points) > FARTHEST_SINGLE)
    if len(far):
        point, axis = far[0]
        raise ValueError(
            f"{what} at {'xy'[axis]} = {points[point, axis]:.10g} m, but must be within"
            f' {FARTHEST_SINGLE:,.0f} m of the origin with precision="single", because float32'
            f" rounds positions to {np.spacing(np.float32(points[point, axis])):.1g} m there: move"
            f" the origin of the map nearer, {_OTHERWISE}"
        )
