"""This module records the trajectory of one episode: poses, actions, events."""

from typing import NamedTuple

import numpy as np

from baselines.replay.recording import run_and_record
from hav_env import Batch, Task
from hav_env.maths.random_numbers import Seed
from hav_env.models.checks import check_value
from hav_env.models.quantities import Steps
from hav_env.policies.checks import check_driven, check_models
from hav_env.policies.demands import bind, check_guided
from hav_env.vehicles import OnAxle
from hav_env.world.arrays import ARTICULATION, FOOTPRINT, HIT_STEP
from hav_env.world.chain import axles_of, corners_of, fronts_of
from hav_env.world.place.guidance import Dubins
from hav_env.world.place.reading import segments_in
from hav_env.world.units.reading import limits_in, offsets_in, shapes_in


class Trajectory(NamedTuple):
    """The T recorded states of one episode.

    Shapes as in ``hav_env.world.arrays``.
    """

    step: np.ndarray  # (T,) number of steps since the reset; row 0 is the state after reset
    x: np.ndarray  # (T, N) truck's rear axle [m]
    y: np.ndarray  # (T, N) [m]
    heading: np.ndarray  # (T, N, U) of every unit [rad], not wrapped
    waiting: np.ndarray  # (T, N) bool: at its goal
    removed: np.ndarray  # (T, N) bool: has left the world; x and y are its last position
    phase: np.ndarray  # (T, N) number of the current goal, from 0
    speed: np.ndarray  # (T, N) decision in this state [m/s]; nan in the last state, which has none
    steering: np.ndarray  # (T, N) [rad], left positive
    motion: np.ndarray  # (T, N, 2) speed and steering of the truck in the next step
    evaded: np.ndarray  # (T, N) the HAV evaded in this state, NEVER for none
    reserved: np.ndarray  # (T, N) number of the outline that the HAV has reserved, NEVER for none
    outline: np.ndarray  # (K, 24, 2) corners of the reserved outlines, x and y [m]; K may be 0
    num_trailers: np.ndarray  # (N,)
    length: np.ndarray  # (N, U) wheelbase and trailer lengths [m], inf beyond the last
    offset: np.ndarray  # (N, U) hitch offset of the trailer behind a unit [m]
    shape: np.ndarray | None  # (N, U, 3) bodies, columns HALF_WIDTH .. REAR [m]; None for lines
    footprint: np.ndarray  # (N,) radius d_i [m]
    articulation_max: np.ndarray  # (N, U) limit of the articulation [rad]; undefined for trucks
    goals: np.ndarray  # (N, G, 3) x [m], y [m], heading [rad]
    segment: np.ndarray  # (S, 4) obstacles: x, y of one end, x, y of the other [m]; S may be 0
    first: np.ndarray  # (N, E, 2) WHEN (step) and WHERE, or NEVER, of ``events_in(first)``
    hit_step: np.ndarray  # (N, G) step of the hit of each goal, or NEVER
    dt: float  # duration of a step [s]
    max_steps: int  # time is up after so many steps
    policy: str  # a name for titles, like scenario
    scenario: str
    seed: int
    episode: int


def record_trajectory(
    policy,
    scenario,
    seed: int,
    episode: int,
    task: Task = Task(),
    vehicle=OnAxle(),
    every: int = 1,
    guidance=Dubins(),
) -> Trajectory:
    """Run one episode as ``rollout`` does, and record its states.

    Args:
        policy: Policy of all HAVs.
        scenario: Scenario of the world.
        seed: Seed of the episode.
        episode: Number of the episode.
        task: Rules of the episode.
        vehicle: Kinematics of the HAVs.
        every: Number of steps between recorded states; the last state is always recorded.
        guidance: Guidance to the goals.

    Raises:
        ValueError, TypeError: If a parameter is invalid, the message names it; or if the policy
            returned a command that is not finite.
        PlacementError: If the scenario has no space for its HAVs.
    """
    policy = bind(policy, task, vehicle)
    check_models(policy, scenario, task, vehicle)
    check_value("episode", Seed, episode)
    check_value("every", Steps, every)
    batch = Batch(scenario, 1, task, vehicle, guidance=guidance)
    check_guided(policy, batch.guidance)
    batch.reset(seed, np.array([episode]))
    states, outlines = run_and_record(policy, batch, every)
    check_driven(policy, batch.worlds)
    fleet, record = batch.worlds.fleet, batch.worlds.record
    return Trajectory(
        **states._asdict(),
        outline=outlines,
        num_trailers=fleet.num_trailers[:, 0].copy(),
        length=fleet.length[:, :, 0].copy(),
        offset=offsets_in(fleet, 0),
        shape=shapes_in(fleet, 0),
        footprint=fleet.radius[:, FOOTPRINT, 0].copy(),
        articulation_max=limits_in(fleet, 0, fleet.limit[:, ARTICULATION, 0]),
        goals=batch.worlds.goals[..., 0].copy(),
        segment=segments_in(batch.worlds.place, 0),
        first=record.first[..., 0].copy(),
        hit_step=record.goal[:, :, HIT_STEP, 0].astype(np.int64),
        dt=float(task.dt),
        max_steps=int(task.max_steps),
        policy=type(policy).__name__,
        scenario=type(scenario).__name__,
        seed=int(seed),
        episode=int(episode),
    )


_OVER_TIME = (
    *("step", "x", "y", "heading", "waiting", "removed", "phase", "speed", "steering"),
    *("motion", "evaded", "reserved"),
)


def cut_trajectory(trajectory: Trajectory, begin: float | None, end: float | None) -> Trajectory:
    """Return the part of an episode between two times.

    Args:
        trajectory: the episode.
        begin: first time [s]; None for the first state.
        end: last time [s]; None for the last state.

    Raises:
        ValueError: If fewer than two states are left.
    """
    times = trajectory.step * trajectory.dt
    first = times[0] if begin is None else begin
    last = times[-1] if end is None else end
    kept = (times >= first - 1e-9) & (times <= last + 1e-9)
    if kept.sum() < min(2, len(times)):
        told = f"the states are from {times[0]:g} s to {times[-1]:g} s"
        raise ValueError(f"from {first:g} s until {last:g} s is too short a part: {told}")
    return trajectory._replace(**{name: getattr(trajectory, name)[kept] for name in _OVER_TIME})


def chain_points(trajectory: Trajectory, hav: int, rows: int | slice | np.ndarray) -> np.ndarray:
    """Return the positions of the axles of a HAV; with on-axle hitching, its chain P_i.

    Args:
        trajectory: the states.
        hav: Index of the HAV.
        rows: Rows of the T states: an index, a slice or an array of indices.

    Returns:
        (..., K, 2) x and y [m], rows first: the truck's front axle, its rear axle, then the axle of
        each of the K - 2 trailers.
    """
    return axles_of(*_units_at(trajectory, hav, rows))


def front_points(trajectory: Trajectory, hav: int, rows: int | slice | np.ndarray) -> np.ndarray:
    """Return the front ends of the units of a HAV: the truck's front axle and the hitches.

    The arguments are those of ``chain_points``.

    Returns:
        (..., K, 2) x and y [m], rows first, of K units.
    """
    return fronts_of(*_units_at(trajectory, hav, rows))


def body_corners(
    trajectory: Trajectory, hav: int, rows: int | slice | np.ndarray
) -> np.ndarray | None:
    """Return the corners of the bodies of a HAV, None if its bodies are lines.

    The arguments are those of ``chain_points``.

    Returns:
        (..., K, 4, 2) x and y [m], rows first, of K units, as from ``corners_of``.
    """
    if trajectory.shape is None:
        return None
    shape = trajectory.shape[hav, : trajectory.num_trailers[hav] + 1]
    return corners_of(shape, *_units_at(trajectory, hav, rows))


def _units_at(trajectory: Trajectory, hav: int, rows: int | slice | np.ndarray) -> tuple:
    """Return the positions of a HAV, and the headings, lengths and offsets of its units."""
    units = trajectory.num_trailers[hav] + 1
    x, y = trajectory.x[rows, hav], trajectory.y[rows, hav]
    heading, length = trajectory.heading[rows, hav, :units], trajectory.length[hav, :units]
    return x, y, heading, length, trajectory.offset[hav, :units]
