"""This module records the trajectory of one episode: poses, actions, events."""

from typing import NamedTuple

import numpy as np

from baselines.replay.recording import run_and_record
from hav_env import Batch, Task
from hav_env.maths.random_numbers import Seed
from hav_env.models.checks import check_value
from hav_env.models.quantities import Steps
from hav_env.policies.interface import check_models
from hav_env.vehicles import OnAxle
from hav_env.world.arrays import ARTICULATION, FOOTPRINT, HIT_STEP
from hav_env.world.chain import axles_of, corners_of, fronts_of
from hav_env.world.place.reading import segments_in
from hav_env.world.units.reading import limits_in, offsets_in, shapes_in


class Trajectory(NamedTuple):
    """The states of one episode that were kept, T of them.

    Shapes as in ``hav_env.world.arrays``.
    """

    step: np.ndarray  # (T,) steps done; row 0 is the state after reset
    x: np.ndarray  # (T, N) truck's rear axle [m]
    y: np.ndarray  # (T, N) [m]
    heading: np.ndarray  # (T, N, U) of every unit [rad], not wrapped
    waiting: np.ndarray  # (T, N) bool: at its goal
    removed: np.ndarray  # (T, N) bool: has left the world; x and y are where it was last
    phase: np.ndarray  # (T, N) which of its goals is under way, from 0
    speed: np.ndarray  # (T, N) decided in this state [m/s]; nan in the last, where nothing is
    steering: np.ndarray  # (T, N) [rad], left positive
    motion: np.ndarray  # (T, N, 2) what the truck made of both in the step that follows
    evaded: np.ndarray  # (T, N) the HAV evaded in this state, NEVER for none
    num_trailers: np.ndarray  # (N,)
    length: np.ndarray  # (N, U) wheelbase and trailer lengths [m], inf beyond the last
    offset: np.ndarray  # (N, U) how far behind the axle of a unit its trailer is hitched [m]
    shape: np.ndarray | None  # (N, U, 3) bodies, columns HALF_WIDTH .. REAR [m]; None for lines
    footprint: np.ndarray  # (N,) radius d_i [m]
    articulation_max: np.ndarray  # (N, U) jackknifed beyond it [rad]; void for trucks
    goals: np.ndarray  # (N, G, 3) x [m], y [m], heading [rad]
    segment: np.ndarray  # (S, 4) obstacles: x, y of one end, x, y of the other [m]; S may be 0
    first: np.ndarray  # (N, E, 2) WHEN (step) and WHERE, or NEVER, of ``events_in(first)``
    hit_step: np.ndarray  # (N, G) at which each goal was hit, or NEVER
    dt: float  # duration of a step [s]
    policy: str  # a name to be shown, like the next
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
) -> Trajectory:
    """Run one episode as ``rollout`` does, and keep its states.

    Args:
        policy: drives every HAV.
        scenario: scenario of the world.
        seed: of the episode.
        episode: its number.
        task: the rules.
        vehicle: the kinematics.
        every: keep the states after each so many steps, and the last one in any case.

    Raises:
        ValueError, TypeError: for parameters that are not allowed, naming them.
        PlacementError: when the scenario has no room for its HAVs.
    """
    check_models(policy, scenario, task, vehicle)
    check_value("episode", Seed, episode)
    check_value("every", Steps, every)
    batch = Batch(scenario, 1, task, vehicle)
    batch.reset(seed, np.array([episode]))
    states = run_and_record(policy, batch, every)
    fleet, record = batch.worlds.fleet, batch.worlds.record
    return Trajectory(
        **states._asdict(),
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
        policy=type(policy).__name__,
        scenario=type(scenario).__name__,
        seed=int(seed),
        episode=int(episode),
    )


def chain_points(trajectory: Trajectory, hav: int, rows: int | slice | np.ndarray) -> np.ndarray:
    """Return where the axles of a HAV are; hitched on axles, they are the polygonal chain P_i.

    Args:
        trajectory: the states.
        hav: which HAV.
        rows: which of the T states: an index, a slice or an array of indices.

    Returns:
        (..., K, 2) x and y [m], rows first: the truck's front axle, its rear axle, then the axle of
        each of the K - 2 trailers.
    """
    return axles_of(*_units_at(trajectory, hav, rows))


def front_points(trajectory: Trajectory, hav: int, rows: int | slice | np.ndarray) -> np.ndarray:
    """Return where the front ends of a HAV's units are, the truck's front axle and the hitches.

    Args are those of ``chain_points``.

    Returns:
        (..., K, 2) x and y [m], rows first, of K units.
    """
    return fronts_of(*_units_at(trajectory, hav, rows))


def body_corners(
    trajectory: Trajectory, hav: int, rows: int | slice | np.ndarray
) -> np.ndarray | None:
    """Return the corners of a HAV's bodies, None where they are lines.

    Args are those of ``chain_points``.

    Returns:
        (..., K, 4, 2) x and y [m], rows first, of K units, as from ``corners_of``.
    """
    if trajectory.shape is None:
        return None
    shape = trajectory.shape[hav, : trajectory.num_trailers[hav] + 1]
    return corners_of(shape, *_units_at(trajectory, hav, rows))


def _units_at(trajectory: Trajectory, hav: int, rows: int | slice | np.ndarray) -> tuple:
    """Return the poses of a HAV, and of its units headings, lengths and offsets."""
    units = trajectory.num_trailers[hav] + 1
    x, y = trajectory.x[rows, hav], trajectory.y[rows, hav]
    heading, length = trajectory.heading[rows, hav, :units], trajectory.length[hav, :units]
    return x, y, heading, length, trajectory.offset[hav, :units]
