"""This module makes the guidance of a batch: lattices, witness routes or plans."""

import functools
from typing import Any, get_args

import numpy as np

from hav_env.guidance import Feasible, Lattice, Roads, Witness
from hav_env.guidance.feasible_chains import planning_rows
from hav_env.guidance.lattices import load_lattices
from hav_env.guidance.roads.files import load_networks
from hav_env.guidance.roads.model import RoadVehicle
from hav_env.models.annotations import show
from hav_env.models.checks import check_fields
from hav_env.models.names import Registry
from hav_env.places.site import BOUNDARY
from hav_env.scenarios import Explicit, SitePoses
from hav_env.scenarios.given_vehicles import vehicle_in, write_vehicle
from hav_env.scenarios.sites.field import Field
from hav_env.vehicles import Lines, OnAxle, bodies_of, is_instant, needs_hitches
from hav_env.world.arrays import allocate_worlds
from hav_env.world.place.guidance import Dubins, OnFeasible, OnLattices, OnRoads, OnWitnesses
from hav_env.world.sensing import drivable_radius
from hav_env.world.units.outlines import shape_as_usual

Guidance = Dubins | Witness | Lattice | Roads | Feasible
_DECIMALS = 6  # of radii [m]: equal vehicles share a lattice
_AROUND = 4.0  # radii of space around all walls and poses, if a site has no boundary


def check_guidance(guidance: Any, scenario: Any, vehicle: Any) -> None:
    """Check guidance before its use in a scenario.

    Raises:
        TypeError: If this is no guidance, or a field has another type.
        ValueError: If a field is out of range, or the scenario or the vehicle has no such routes.
    """
    if type(guidance) not in get_args(Guidance):
        told = f"guidance is {show(guidance)}"
        raise TypeError(f"{told}, but must be one of {', '.join(GUIDANCES.names())}")
    check_fields("guidance", guidance)
    needed = ""
    if isinstance(guidance, Witness) and not isinstance(scenario, Field):
        needed = "a field: no other scenario keeps a way free for each HAV"
    site = getattr(scenario, "site", None)
    fixed = len(poses_of(scenario)[0]) > 0 and site is not None and site.num_segments > 0
    if isinstance(guidance, Lattice | Roads) and not fixed:
        needed = "a scenario with a site and with the same goal poses in all episodes"
    if isinstance(guidance, Feasible) and not _is_predicted(vehicle):
        raise ValueError(f"vehicle is {vehicle}, but Feasible predicts {OnAxle()} alone")
    if needed:
        name = type(guidance).__name__
        raise ValueError(f"scenario is a {type(scenario).__name__}, but {name} needs {needed}")


@functools.singledispatch
def guide(guidance: Any, scenario: Any, vehicle: Any, task: Any) -> Any:
    """Return the guidance of the worlds, with empty arrays for HAVs.

    Args:
        guidance: a model that passed ``check_guidance``.
        scenario: scenario with the goals and the walls.
        vehicle: kinematics of the HAVs; their turning radii depend on it.
        task: rules with the length of a step and the tolerances of goals.
    """
    return guidance


@guide.register
def _(guidance: Witness, scenario: Any, vehicle: Any, task: Any) -> OnWitnesses:
    return OnWitnesses(float(scenario.widening), np.zeros((0, 0, 0)))


@guide.register
def _(guidance: Lattice, scenario: Any, vehicle: Any, task: Any) -> OnLattices:
    goals, others = poses_of(scenario)
    kinds = _vehicles_in(scenario, vehicle)
    least = np.array([kind.radius for kind in kinds])
    radii = np.unique(np.round(guidance.widening * least, _DECIMALS))
    bounds = _bounds_of(scenario.site, np.concatenate([goals, others]), radii[-1])
    lattices = load_lattices(guidance, scenario.site.segment, goals, radii.tolist(), bounds)
    return OnLattices(lattices, np.zeros((0, 0), np.int16), np.zeros((0, 0, 0)))


@guide.register
def _(guidance: Roads, scenario: Any, vehicle: Any, task: Any) -> OnRoads:
    poses, joins = road_poses_of(scenario)
    kinds = _vehicles_in(scenario, vehicle)
    apart = np.hypot(*(poses[:, None, :2] - poses[None, :, :2]).T).T
    through = joins[-1]
    joins[:-1] &= (apart <= guidance.reach) | ~(through | through[:, None])
    widest = guidance.widening * max(kind.radius for kind in kinds)
    walls = scenario.site.segment
    bounds = _bounds_of(scenario.site, poses, widest)
    networks = load_networks(guidance, walls, poses, joins, kinds, bounds)
    return OnRoads(networks, np.zeros((0, 0, 0), np.int32), np.zeros((0, 0, 0)))


@guide.register
def _(guidance: Feasible, scenario: Any, vehicle: Any, task: Any) -> OnFeasible:
    none = np.zeros((0, 0, 0))
    return OnFeasible(
        float(task.dt),
        float(task.distance_tolerance),
        float(task.heading_tolerance),
        float(guidance.tightest),
        float(guidance.margin),
        *(none, none, np.zeros((planning_rows(scenario.max_trailers + 1), 0))),
    )


def _is_predicted(vehicle: Any) -> bool:
    """Return whether the prediction of routes holds for a vehicle, with any bodies."""
    if type(vehicle) is not OnAxle or not is_instant(vehicle):
        return False
    return vehicle._replace(bodies=Lines()) == OnAxle()


@functools.singledispatch
def poses_of(scenario: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return the goal poses of a scenario, and its other start poses, (P, 3) each.

    Scenarios register this function if their goals are a finite set of poses, the same in all
    episodes: x, y [m], heading [rad]. Other scenarios have none.
    """
    return np.zeros((0, 3)), np.zeros((0, 3))


@poses_of.register
def _(scenario: SitePoses) -> tuple[np.ndarray, np.ndarray]:
    return scenario.place[scenario.follows.any(axis=0)], scenario.place


@poses_of.register
def _(scenario: Explicit) -> tuple[np.ndarray, np.ndarray]:
    return np.unique(scenario.goals.reshape(-1, 3), axis=0), scenario.start


@functools.singledispatch
def road_poses_of(scenario: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return the poses of a road network, and which of them edges may join.

    Returns:
        (P, 4) x, y [m], heading [rad], curvature [1/m]; and (P + 1, P) bool, see
        ``build_networks``. By default the poses are starts and goals, and paths lead through none.
    """
    goals, others = poses_of(scenario)
    poses = np.unique(np.concatenate([goals, others]), axis=0)
    joins = np.zeros((len(poses) + 1, len(poses)), bool)
    joins[:-1] = (poses[:, None] == goals).all(axis=2).any(axis=1)
    joins[:-1] &= ~np.eye(len(poses), dtype=bool)
    return np.column_stack([poses, np.zeros(len(poses))]), joins


@road_poses_of.register
def _(scenario: SitePoses) -> tuple[np.ndarray, np.ndarray]:
    places, roads = len(scenario.place), len(scenario.road)
    poses = np.concatenate([np.column_stack([scenario.place, np.zeros(places)]), scenario.road])
    joins = np.ones((places + roads + 1, places + roads), bool)
    joins[:-1] &= ~np.eye(places + roads, dtype=bool)
    joins[:places, :places] = scenario.follows == 1
    joins[-1] = np.arange(places + roads) >= places
    return poses, joins


def _bounds_of(site: Any, poses: np.ndarray, radius: float) -> tuple[float, float, float, float]:
    """Return the corners of a rectangle round a site and poses, with space for turns [m]."""
    points = np.concatenate([site.segment.reshape(-1, 2), poses[:, :2]])
    room = 0.0 if BOUNDARY in site.kind else _AROUND * radius
    low, high = points.min(axis=0) - room, points.max(axis=0) + room
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def _vehicles_in(scenario: Any, vehicle: Any) -> list[RoadVehicle]:
    """Return each kind of HAV, with the radius of the tightest circle it can drive for good."""
    fleet, bodies = scenario.fleet, bodies_of(vehicle)
    kinds, units = fleet.length.shape
    hitched = needs_hitches(vehicle)
    worlds = allocate_worlds(1, kinds, units, 1, hitched=hitched, bodies=bodies)
    found = []
    for kind in range(kinds):
        shape_as_usual(worlds.fleet.bodies, kind, 0)
        write_vehicle(fleet, kind, fleet.footprint_truck_share, worlds.fleet, kind, 0)
        given = vehicle_in(worlds.fleet, kind, 0)
        shape = np.maximum(given.shape, 0.0)  # lines have no shape
        radius = float(drivable_radius(worlds, kind, 0))
        found.append(RoadVehicle(given.length, given.offset, given.limit, shape, radius))
    return found


GUIDANCES = Registry(
    "guidance",
    "hav_env.guidances",
    lambda model_class: model_class in get_args(Guidance),
    "it must be hav_env.guidance.Dubins, Witness, Lattice, Roads or Feasible",
    {
        "dubins": Dubins,
        "witness": Witness,
        "lattice": Lattice,
        "roads": Roads,
        "feasible": Feasible,
    },
)
