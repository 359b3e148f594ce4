"""One episode again, with everything that happened on the way, and which ones to look at."""

from typing import NamedTuple

import numpy as np
import pyarrow as pa

from baselines.policy import allocate_memory, check_policy, decide
from hav_env import Batch, Task
from hav_env.vehicles import OnAxle
from hav_env.world import FOOTPRINT, PHASE, STEP


class Trajectory(NamedTuple):
    """The states of one episode that were kept, T of them; shapes as in ``hav_env.world``."""

    step: np.ndarray  # (T,) steps done; row 0 is the state after reset
    x: np.ndarray  # (T, N) truck's rear axle [m]
    y: np.ndarray  # (T, N) [m]
    heading: np.ndarray  # (T, N, U) of every unit [rad], not wrapped
    waiting: np.ndarray  # (T, N) bool: at its goal
    phase: np.ndarray  # (T,) goal under way
    speed: np.ndarray  # (T, N) decided in this state [m/s]; nan in the last, where nothing is
    steering: np.ndarray  # (T, N) [rad], left positive
    num_trailers: np.ndarray  # (N,)
    length: np.ndarray  # (N, U) wheelbase and trailer lengths [m], 1 beyond the last
    footprint: np.ndarray  # (N,) radius d_i [m]
    goals: np.ndarray  # (N, G, 3) x [m], y [m], heading [rad]


class Excerpt(NamedTuple):
    """Which part of an episode to look at, and at what."""

    episode: int
    num_havs: int
    first: int = 0
    """The steps from here ..."""
    last: int | None = None
    """... to here; None for the end."""
    moment: int | None = None
    """The step at which it happens."""
    evading: bool = False
    """The HAVs evade each other at that moment."""
    joint: tuple[int, int] | None = None
    """HAV and joint that jackknife at that moment."""


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
        policy, scenario, seed, episode, task, vehicle: as for ``rollout``.
        every: keep the states after each so many steps, and the last one in any case.

    Raises:
        ValueError, TypeError: for parameters that are not allowed, naming them.
        PlacementError: when the scenario has no room for its HAVs.
    """
    check_policy(policy, scenario)
    if every < 1:
        raise ValueError(f"every is {every}, but must be at least 1")
    batch = Batch(scenario, 1, task, vehicle)
    batch.reset(seed, np.array([episode]))
    state, fleet = batch.worlds.state, batch.worlds.fleet
    memory = allocate_memory(policy, len(state.x), 1)
    rows = []

    def keep(speed: np.ndarray, steering: np.ndarray) -> None:
        now = (state.x, state.y, state.heading, state.waiting, speed, steering)
        rows.append([*state.clock[[STEP, PHASE], 0], *(values[..., 0].copy() for values in now)])

    while not batch.ended[0]:
        speed, steering = decide(policy, memory, batch)
        if state.clock[STEP, 0] % every == 0:
            keep(speed, steering)
        batch.step(speed, steering)
    keep(*np.full((2, *state.x.shape), np.nan))
    step, phase, x, y, heading, waiting, speed, steering = map(np.array, zip(*rows, strict=True))
    return Trajectory(
        step,
        x,
        y,
        heading,
        waiting,
        phase,
        speed,
        steering,
        fleet.num_trailers[:, 0].copy(),
        fleet.length[:, :, 0].copy(),
        fleet.radius[:, FOOTPRINT, 0].copy(),
        batch.worlds.goals[..., 0].copy(),
    )


def chain_points(trajectory: Trajectory, hav: int, rows: int | slice | np.ndarray) -> np.ndarray:
    """Return where the axles of a HAV are, the polygonal chain P_i.

    Args:
        trajectory: the states.
        hav: which HAV.
        rows: which of the T states: an index, a slice or an array of indices.

    Returns:
        (..., K, 2) x and y [m], rows first: the truck's front axle, its rear axle, then the axle of
        each of the K - 2 trailers.
    """
    units = trajectory.num_trailers[hav] + 1
    heading = trajectory.heading[rows, hav, :units]
    direction = np.stack([np.cos(heading), np.sin(heading)], axis=-1)  # (..., units, 2)
    along = trajectory.length[hav, :units, None] * direction
    rear = np.stack([trajectory.x[rows, hav], trajectory.y[rows, hav]], axis=-1)
    front = (rear + along[..., 0, :])[..., None, :]
    return np.concatenate([front, front - np.cumsum(along, axis=-2)], axis=-2)


def round_closest(trajectory: Trajectory, excerpt: Excerpt) -> Excerpt:
    """Return the part of an excerpt in which HAV 0 comes nearest to its first goal."""
    rows = np.flatnonzero(trajectory.phase == 0)
    dx = trajectory.x[rows, 0] - trajectory.goals[0, 0, 0]
    dy = trajectory.y[rows, 0] - trajectory.goals[0, 0, 1]
    moment = int(trajectory.step[rows[np.argmin(np.hypot(dx, dy))]])
    return excerpt._replace(first=max(moment - 300, 0), last=moment + 600, moment=moment)


def choose_episodes(single: pa.Table, pair: pa.Table) -> dict[str, Excerpt | None]:
    """Choose excerpts that show what happens, None for what does not occur in the tables.

    Args:
        single, pair: tables of one and of two HAVs per episode, each with two goals.

    Returns:
        hit: both goals hit, three to five trailers, detours near the median. jackknife: the first
        one, and before it. evasion: a pair that evades and still hits its goals. miss: a first
        goal missed most narrowly, after a close miss. orbit: a first goal missed as most are, at
        the median distance; the last six turns of the circle R_min.
    """
    return {
        "hit": _choose_hit(single),
        "jackknife": _choose_jackknife(single, 1) or _choose_jackknife(pair, 2),
        "evasion": _choose_evasion(pair),
        "miss": _choose_miss(single),
        "orbit": _choose_orbit(single),
    }


def _choose_hit(table: pa.Table) -> Excerpt | None:
    trailers = table["num_trailers"].to_numpy()
    fit = ~_flags(table, "jackknifed") & (trailers >= 3) & (trailers <= 5)
    odd = np.zeros(len(table))
    for goal in ("goal_1", "goal_2"):
        fit &= _flags(table, f"{goal}_hit")
        odd += _distance_from_median(np.log(table[f"{goal}_length_ratio"].to_numpy()))
    row = _least(table, odd, fit)
    return None if row is None else Excerpt(row["episode"], 1)


def _choose_jackknife(table: pa.Table, num_havs: int) -> Excerpt | None:
    row = _least(table, table["episode"].to_numpy(), _flags(table, "jackknifed"))
    if row is None:
        return None
    moment, where = row["jackknife_step"], (row["hav"], row["jackknife_joint"])
    return Excerpt(
        row["episode"], num_havs, max(moment - 300, 0), moment + 100, moment, joint=where
    )


def _choose_evasion(table: pa.Table) -> Excerpt | None:
    """Look for a pair that has time to come near, and whose size is usual."""
    good = _flags(table, "goal_2_hit") & ~_flags(table, "jackknifed")
    good &= ~_flags(table, "actual_collision")
    episode, step = table["episode"].to_numpy(), table["potential_collision_step"].to_numpy()
    good &= (step >= 100) & ~np.isin(episode, episode[~good])
    row = _least(table, _distance_from_median(table["vehicle_length"].to_numpy()), good)
    if row is None:
        return None
    moment = row["potential_collision_step"]
    return Excerpt(row["episode"], 2, moment - 100, moment + 400, moment, evading=True)


def _choose_miss(table: pa.Table) -> Excerpt | None:
    """Its step is not in the table: see ``round_closest``."""
    narrow = np.zeros(len(table), np.bool_)
    for kind in ("heading", "euclidean"):
        narrow |= table[f"goal_1_{kind}_miss_steps"].to_numpy() > 0
    closest = table["goal_1_closest"].to_numpy()
    row = _least(table, closest, narrow & ~_flags(table, "goal_1_hit"))
    return None if row is None else Excerpt(row["episode"], 1)


def _choose_orbit(table: pa.Table) -> Excerpt | None:
    missed = ~_flags(table, "goal_1_hit") & ~_flags(table, "jackknifed")
    gap = table["goal_1_closest"].to_numpy() / table["stable_radius"].to_numpy()
    row = _least(table, _distance_from_median(np.where(missed, gap, np.nan)), missed)
    if row is None:
        return None
    if row["path_length"] == 0.0:  # a policy that stands
        return Excerpt(row["episode"], 1)
    turn = 2.0 * np.pi * row["stable_radius"] * row["moving_steps"] / row["path_length"]
    return Excerpt(row["episode"], 1, max(row["steps"] - round(6 * turn), 0), row["steps"])


def _flags(table: pa.Table, name: str) -> np.ndarray:
    return table[name].to_numpy().astype(np.bool_)


def _distance_from_median(values: np.ndarray) -> np.ndarray:
    known = values[~np.isnan(values)]
    return np.abs(values - (np.median(known) if len(known) else 0.0))


def _least(table: pa.Table, values: np.ndarray, allowed: np.ndarray) -> dict | None:
    """Return the first allowed row with the least value, None when none is allowed."""
    rows = np.flatnonzero(allowed & ~np.isnan(values))
    return table.slice(rows[np.argmin(values[rows])], 1).to_pylist()[0] if len(rows) else None
