"""This module defines the scene: the visible state of one world at one moment.

A scene needs neither the simulator nor a drawing. Shapes are as in ``hav_env.world.arrays``: N
HAVs, U units of a HAV. Its real numbers are float64, whatever the precision of the worlds, because
pygame rejects float32.
"""

from typing import Any, NamedTuple

import numpy as np

from hav_env.world.arrays import (
    ARTICULATION,
    FOOTPRINT,
    HIT_STEP,
    NEVER,
    OBSTACLE,
    PHASE,
    STEP,
    WHERE,
    World,
    is_removed,
)
from hav_env.world.chain import axles_of, corners_of, fronts_of
from hav_env.world.event_table import HARM, Event, events_in, happened
from hav_env.world.place.reading import segments_in
from hav_env.world.units.reading import limits_in, offsets_in, shapes_in

NO_SEGMENTS = np.zeros((0, 4))


class Scene(NamedTuple):
    """One moment of one world."""

    time: float  # [s]
    phase: np.ndarray  # (N,) number of the current goal, from 0
    x: np.ndarray  # (N,) truck's rear axle [m]
    y: np.ndarray  # (N,) [m]
    heading: np.ndarray  # (N, U) of every unit [rad]
    speed: np.ndarray  # (N,) of the truck [m/s]
    steering: np.ndarray  # (N,) of the truck [rad], left positive
    num_trailers: np.ndarray  # (N,)
    length: np.ndarray  # (N, U) wheelbase, trailer lengths [m]; anything beyond the last unit
    offset: np.ndarray  # (N, U) distance of a unit's axle to the hitch of its trailer [m]
    shape: np.ndarray | None  # (N, U, 3) bodies, columns HALF_WIDTH .. REAR [m]; None for lines
    footprint: np.ndarray  # (N,) radius d_i round the truck's rear axle [m]
    articulation_max: np.ndarray  # (N, U) of the joint at the front of a unit [rad]; of trailers
    goal: np.ndarray  # (N, 3) current goal pose: x [m], y [m], heading [rad]
    hits: np.ndarray  # (N,) goals hit so far
    num_goals: int
    waiting: np.ndarray  # (N,) bool: at its goal
    removed: np.ndarray  # (N,) bool: has left the world and is not drawn
    happened: np.ndarray  # (N, E) bool: each of ``EVENTS`` that can happen, ever
    potential: np.ndarray  # (N,) bool: in potential collision now, footprints overlap
    evaded: np.ndarray  # (N,) number of the HAV that it evades now, -1 for none or unknown
    command: np.ndarray | None = None  # (N, 2) commanded speed [m/s], steering [rad], if known
    segment: np.ndarray = NO_SEGMENTS  # (S, 4) obstacles: x, y of one end, x, y of the other [m]
    struck: np.ndarray | None = None  # (N,) segment that each HAV hit first, or NEVER
    reserved: np.ndarray | None = None  # (N, K, 2) corners of reserved areas [m], nan for none


def scene_of(
    worlds: World,
    w: int,
    dt: float,
    evaded: np.ndarray | None = None,
    command: np.ndarray | None = None,
) -> Scene:
    """Return the scene of one world; its arrays are copies, in double precision.

    Args:
        worlds: worlds of a batch.
        w: number of the world.
        dt: duration of a step [s].
        evaded: (N,) number of the HAV that each one evades, -1 for none; None if unknown. The
            scene ignores HAVs that wait, since they decide nothing.
        command: (N, 2) commanded speed [m/s] and steering [rad]; None if unknown.
    """
    state, fleet, record = worlds.state, worlds.fleet, worlds.record
    x, y = state.x[:, w].astype(float), state.y[:, w].astype(float)
    waiting, removed = state.waiting[:, w].copy(), is_removed(worlds, slice(None), w)
    footprint = fleet.radius[:, FOOTPRINT, w].astype(float)
    first = record.first[..., w]
    known = np.full(len(x), -1) if evaded is None else np.asarray(evaded).astype(np.int64)
    scene = Scene(
        time=float(state.clock[STEP, w] * dt),
        phase=state.goal[:, PHASE, w].astype(np.int64),
        x=x,
        y=y,
        heading=state.heading[:, :, w].copy(),
        speed=state.speed[:, w].copy(),
        steering=state.steering[:, w].copy(),
        num_trailers=fleet.num_trailers[:, w].copy(),
        length=fleet.length[:, :, w].copy(),
        offset=offsets_in(fleet, w),
        shape=shapes_in(fleet, w),
        footprint=footprint,
        articulation_max=limits_in(fleet, w, fleet.limit[:, ARTICULATION, w]),
        goal=state.goal[:, :3, w].copy(),
        hits=np.count_nonzero(record.goal[:, :, HIT_STEP, w] != NEVER, axis=1),
        num_goals=worlds.goals.shape[1],
        waiting=waiting,
        removed=removed,
        happened=np.stack([happened(first, event) for event in events_in(first)], axis=1),
        potential=find_potential(x, y, footprint, ~removed),
        evaded=np.where(waiting | removed, -1, known),
        command=command,
        segment=segments_in(worlds.place, w),
        struck=struck_in(first),
    )
    return Scene(*map(_in_double, scene))


def _in_double(part: Any) -> Any:
    """Return a part of a scene, an array of float32 as float64."""
    narrow = isinstance(part, np.ndarray) and part.dtype == np.float32
    return part.astype(float) if narrow else part


def struck_in(first: np.ndarray) -> np.ndarray | None:
    """Return the first segment that each HAV hit, (N,) or NEVER; None without obstacles.

    Args:
        first: (N, E, 2), ``Record.first`` of the world.
    """
    return first[:, OBSTACLE, WHERE].copy() if first.shape[1] > OBSTACLE else None


def find_potential(
    x: np.ndarray, y: np.ndarray, footprint: np.ndarray, present: np.ndarray
) -> np.ndarray:
    """Return which HAVs are in potential collision, equation (5) of the paper.

    Args:
        x: (N,) x of the trucks' rear axles [m].
        y: (N,) y of the trucks' rear axles [m].
        footprint: (N,) radii [m].
        present: (N,) bool, HAVs in the world.
    """
    distance = np.hypot(x[:, None] - x, y[:, None] - y)
    overlap = (distance <= footprint[:, None] + footprint) & present[:, None] & present
    np.fill_diagonal(overlap, False)
    return overlap.any(axis=1)


def chain_of(scene: Scene, hav: int) -> np.ndarray:
    """Return the axles of a HAV, (trailers + 2, 2) as from ``axles_of`` [m]."""
    return axles_of(*_units_of(scene, hav))


def ends_of(scene: Scene, hav: int) -> np.ndarray:
    """Return the front axle and the hitches of a HAV, (trailers + 1, 2) [m]."""
    return fronts_of(*_units_of(scene, hav))


def outlines_of(scene: Scene, hav: int) -> np.ndarray | None:
    """Return the corners of a HAV's bodies, (trailers + 1, 4, 2) [m]; None for lines."""
    if scene.shape is None:
        return None
    shape = scene.shape[hav, : scene.num_trailers[hav] + 1]
    return corners_of(shape, *_units_of(scene, hav))


def _units_of(scene: Scene, hav: int) -> tuple:
    """Return the pose of a HAV, and the headings, lengths and offsets of its units."""
    units = scene.num_trailers[hav] + 1
    columns = (scene.heading, scene.length, scene.offset)
    return scene.x[hav], scene.y[hav], *(column[hav, :units] for column in columns)


def has_had(scene: Scene, hav: int, event: Event) -> bool:
    """Return whether an event has happened to a HAV."""
    return event.row < scene.happened.shape[1] and bool(scene.happened[hav, event.row])


def known_harms(scene: Scene) -> list[Event]:
    """Return the events that mean failure and can happen in the world."""
    return [event for event in HARM if event.row < scene.happened.shape[1]]


def harms_of(scene: Scene, hav: int) -> list[Event]:
    """Return the events that mean failure and have happened to a HAV."""
    return [event for event in HARM if has_had(scene, hav, event)]


def bends_of(scene: Scene, hav: int) -> np.ndarray:
    """Return the size of every articulation of a HAV, (trailers,) [rad]."""
    return np.abs(np.diff(scene.heading[hav, : scene.num_trailers[hav] + 1]))


def shares_of(scene: Scene, hav: int) -> np.ndarray:
    """Return the size of every articulation of a HAV over its limit, (trailers,)."""
    return bends_of(scene, hav) / scene.articulation_max[hav, 1 : scene.num_trailers[hav] + 1]


def has_arrived(scene: Scene, hav: int) -> bool:
    """Return whether a HAV is at its last goal."""
    return bool(scene.waiting[hav]) and scene.phase[hav] == scene.num_goals - 1


def distance_shown(scene: Scene, hav: int) -> float:
    """Return the distance to the current goal [m]."""
    return float(np.hypot(scene.goal[hav, 0] - scene.x[hav], scene.goal[hav, 1] - scene.y[hav]))


def lags_behind(scene: Scene, hav: int) -> bool:
    """Return whether a HAV visibly deviates from its command; False if it waits.

    Its speed or steering differs if its actuators are limited, or the command is beyond limits.
    """
    if scene.command is None or scene.waiting[hav] or scene.removed[hav]:
        return False
    speed, steering = scene.command[hav]
    slow = abs(speed - scene.speed[hav]) > _VISIBLE_SPEED
    return slow or abs(steering - scene.steering[hav]) > _VISIBLE_STEERING


def motion_shown(scene: Scene, hav: int) -> str:
    """Return the actual and the commanded motion of a HAV as text."""
    assert scene.command is not None
    speed, steering = scene.command[hav]
    turned, wanted = np.degrees([scene.steering[hav], steering])
    return f"{scene.speed[hav]:.1f} of {speed:.1f} m/s, {turned:.0f} of {wanted:.0f} deg"


def goals_shown(scene: Scene) -> str:
    """Return the current goals, from 1: one number, or the least and the greatest."""
    least, most = scene.phase.min() + 1, scene.phase.max() + 1
    return f"{least}" if least == most else f"{least}-{most}"


def count_flags(scene: Scene) -> dict[str, int]:
    """Return the number of HAVs in each state, by its name."""
    flags = {
        "at goal": scene.waiting,
        "evading": scene.evaded >= 0,
        "in potential collision": scene.potential,
        **{event.state: scene.happened[:, event.row] for event in known_harms(scene)},
        "removed": scene.removed,
    }
    return {name: int(np.count_nonzero(flag)) for name, flag in flags.items()}


_VISIBLE_SPEED, _VISIBLE_STEERING = 0.05, 0.01  # [m/s, rad], least shown difference
_MOST_DESCRIBED = 5  # largest number of HAVs with a text each
_DIRECTIONS = (
    *("ahead", "ahead-left", "left", "behind-left"),
    *("behind", "behind-right", "right", "ahead-right"),
)


def describe(scene: Scene) -> str:
    """Return one line of text that describes the scene."""
    head = f"{scene.time:.1f} s"
    num_havs = len(scene.x)
    if num_havs <= _MOST_DESCRIBED:
        return "; ".join([head, *(_describe_hav(scene, hav) for hav in range(num_havs))])
    told = [f"{count} {name}" for name, count in count_flags(scene).items() if count]
    summary = f"{num_havs} HAVs: {', '.join(told) or 'all under way'}"
    return f"{head}; goal {goals_shown(scene)}/{scene.num_goals}; {summary}"


def _describe_hav(scene: Scene, hav: int) -> str:
    name = f"HAV {hav}"
    if scene.removed[hav]:
        return f"{name} removed"
    dx, dy = scene.goal[hav, :2] - (scene.x[hav], scene.y[hav])
    bearing = np.arctan2(dy, dx) - scene.heading[hav, 0]
    side = _DIRECTIONS[round(bearing / (np.pi / 4)) % 8]
    joint = int(np.argmax(shares_of(scene, hav)))
    bend = np.degrees(bends_of(scene, hav)[joint])
    limit = np.degrees(scene.articulation_max[hav, joint + 1])
    told = [
        f"{name} goal {scene.phase[hav] + 1}/{scene.num_goals}"
        f" {distance_shown(scene, hav):.1f} m {side}",
        f"bend {bend:.0f}/{limit:.0f} deg",
    ]
    states = {
        "waits": scene.waiting[hav] and not has_arrived(scene, hav),
        "arrived": has_arrived(scene, hav),
        f"evades HAV {scene.evaded[hav]}": scene.evaded[hav] >= 0,
    }
    told += [name for name, holds in states.items() if holds]
    told += [f"drives {motion_shown(scene, hav)}"] if lags_behind(scene, hav) else []
    return ", ".join([*told, *(event.state for event in harms_of(scene, hav))])
