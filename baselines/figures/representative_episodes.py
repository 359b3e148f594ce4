"""This module selects representative episodes of a table, and excerpts that show an event."""

from typing import NamedTuple

import numpy as np
import pyarrow as pa

from baselines.replay.trajectory import Trajectory


class Excerpt(NamedTuple):
    """A part of an episode, and the event that it shows."""

    episode: int
    num_havs: int
    first: int = 0
    """First step ..."""
    last: int | None = None
    """... to here; None for the end."""
    moment: int | None = None
    """Step at which it happens."""
    evading: bool = False
    """Whether the HAVs evade each other at that moment."""
    joint: tuple[int, int] | None = None
    """HAV and joint that jackknife at that moment."""


def round_closest(trajectory: Trajectory, excerpt: Excerpt) -> Excerpt:
    """Return the part of an excerpt in which HAV 0 comes nearest to its first goal."""
    rows = np.flatnonzero(trajectory.phase[:, 0] == 0)
    dx = trajectory.x[rows, 0] - trajectory.goals[0, 0, 0]
    dy = trajectory.y[rows, 0] - trajectory.goals[0, 0, 1]
    moment = int(trajectory.step[rows[np.argmin(np.hypot(dx, dy))]])
    return excerpt._replace(first=max(moment - 300, 0), last=moment + 600, moment=moment)


def rows_between(trajectory: Trajectory, excerpt: Excerpt) -> np.ndarray:
    """Return the rows of the states of an excerpt.

    Raises:
        ValueError: If the trajectory has no such state.
    """
    last = trajectory.step[-1] if excerpt.last is None else excerpt.last
    kept = (trajectory.step >= excerpt.first) & (trajectory.step <= last)
    if not kept.any():
        raise ValueError(f"no state was stored from step {excerpt.first} to {last}")
    return np.flatnonzero(kept)


def row_of(trajectory: Trajectory, excerpt: Excerpt) -> int:
    """Return the row of the excerpt's moment, or of the next stored state after it."""
    row = int(np.searchsorted(trajectory.step, excerpt.moment or 0))
    return min(row, len(trajectory.step) - 1)


def choose_of_single(table: pa.Table) -> dict[str, Excerpt | None]:
    """Select excerpts of single HAVs' episodes, None for events that do not occur in the table.

    Args:
        table: Table of one HAV per episode, with two goals.

    Returns:
        hit: Both goals hit, three to five trailers, detours near the median. jackknife: the first
        one, and before it. miss: a first goal missed most narrowly, after a close miss. orbit: a
        first goal missed as most are, at the median distance; the last six turns of the circle
        R_min.
    """
    return {
        "hit": _choose_hit(table),
        "jackknife": _choose_jackknife(table, 1),
        "miss": _choose_miss(table),
        "orbit": _choose_orbit(table),
    }


def choose_of_pair(table: pa.Table, single: pa.Table) -> dict[str, Excerpt | None]:
    """Select excerpts of pairs' episodes, None for events that do not occur in the table.

    Args:
        table: Table of two HAVs per episode, with two goals.
        single: Table of one HAV per episode.

    Returns:
        jackknife: The first one, and before it; None when a single HAV shows one. evasion: a pair
        that evades and still hits its goals.
    """
    shown = _flags(single, "jackknifed").any()
    return {
        "jackknife": None if shown else _choose_jackknife(table, 2),
        "evasion": _choose_evasion(table),
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
    """Find a pair of usual size with enough time to come near."""
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
    """Find a close miss; its step is not in the table: see ``round_closest``."""
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
    """Return the first allowed row with the least value, None if no row is allowed."""
    rows = np.flatnonzero(allowed & ~np.isnan(values))
    return table.slice(rows[np.argmin(values[rows])], 1).to_pylist()[0] if len(rows) else None
