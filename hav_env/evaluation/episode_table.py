"""This module makes the episode table of an evaluation: one row for each HAV and episode.

A new column is one entry of ``COLUMNS``, ``GOAL_COLUMNS`` or ``MISS_COLUMNS``; docs/metrics.md
defines all columns. Tables of worlds with obstacles also have ``OBSTACLE_COLUMNS``, those of
filtered policies ``FILTER_COLUMNS``.
"""

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa

from hav_env.evaluation.hav_records import HavRecords
from hav_env.policies.filtered import Filtered
from hav_env.world.arrays import (
    CLOSEST,
    DUBINS,
    EPISODE,
    EUCLIDEAN_MISS,
    FOOTPRINT,
    HEADING_MISS,
    HIT_DISTANCE,
    HIT_HEADING,
    HIT_STEP,
    INTERVENTIONS,
    JACKKNIFE,
    LARGEST,
    MISS_DISTANCE,
    MISS_HEADING,
    MOVED,
    PATH,
    STABLE,
    STEP,
    WHEN,
    WHERE,
    World,
)
from hav_env.world.event_table import EVENTS, Event
from hav_env.world.task import Task


class Column(NamedTuple):
    """A column of the table.

    Its functions take the records. Those of a goal also take its number g, from 0; those of a close
    miss also take its kind.
    """

    name: str
    """Name, in which "{goal}" stands for the number of the goal, from 1, and "{kind}" for the kind
    of close miss.
    """
    unit: str
    values: Callable[..., Any]
    """Values (R,) of all rows."""
    known: Callable[..., np.ndarray] | None = None
    """(R,) bool: rows that have a value; None if all have one."""


def _poses(name: str, poses: Callable[..., np.ndarray]) -> tuple[Column, ...]:
    """Return the columns of a pose, given (R, 3)."""
    return (
        Column(f"{name}_x", "m", lambda *at: poses(*at)[:, 0]),
        Column(f"{name}_y", "m", lambda *at: poses(*at)[:, 1]),
        Column(f"{name}_heading", "rad", lambda *at: poses(*at)[:, 2]),
    )


def _of_event(event: Event) -> tuple[Column, ...]:
    """Return the columns of an event: whether it happened, and when and where it first did."""

    def known(records: HavRecords) -> np.ndarray:
        return records.happened(event)

    def first(what: int) -> Callable[[HavRecords], np.ndarray]:
        return lambda records: records.first[:, event.row, what]

    return (
        Column(event.name, "bool", known),
        Column(f"{event.stem}_step", "steps", first(WHEN), known),
        Column(f"{event.stem}_{event.place}", "1", first(WHERE), known),
    )


def _of_events(events: Iterable[Event]) -> tuple[Column, ...]:
    return tuple(column for event in events for column in _of_event(event))


_JACKKNIFE_EVENT = EVENTS[JACKKNIFE]


def _jackknifed(records: HavRecords) -> np.ndarray:
    return records.happened(_JACKKNIFE_EVENT)


def _joint(records: HavRecords) -> np.ndarray:
    return records.joint_of(_JACKKNIFE_EVENT)


def _trailer_lengths(records: HavRecords) -> pa.ListArray:
    """Return the lengths of the trailers of each HAV, as a list."""
    counts, values = records.num_trailers, records.length[:, 1:]
    offsets = np.concatenate([[0], np.cumsum(counts)])
    kept = np.arange(values.shape[1]) < counts[:, None]
    return pa.ListArray.from_arrays(pa.array(offsets, pa.int32()), pa.array(values[kept]))


def _joint_position(records: HavRecords) -> np.ndarray:
    """Return the Joint Position Metric (section V): 0 at the front axle, 1 at the last axle."""
    ahead = records.at_joint(records.hitch_places, _joint(records))
    return ahead / records.vehicle_length


COLUMNS = (
    Column("episode", "1", lambda records: records.clock[EPISODE]),
    Column("hav", "1", lambda records: records.hav),
    Column("num_trailers", "1", lambda records: records.num_trailers),
    Column("truck_length", "m", lambda records: records.length[:, 0]),
    Column("trailer_lengths", "m", _trailer_lengths),
    Column("vehicle_length", "m", lambda records: records.vehicle_length),
    Column("footprint_radius", "m", lambda records: records.radius[:, FOOTPRINT]),
    Column("stable_radius", "m", lambda records: records.radius[:, STABLE]),
    *_poses("start", lambda records: records.start),
    *_of_event(_JACKKNIFE_EVENT),
    Column("joint_position", "1", _joint_position, _jackknifed),
    Column(
        "joint_length_difference",
        "1",
        lambda records: (
            records.at_joint(records.length_differences, _joint(records)) / records.vehicle_length
        ),
        _jackknifed,
    ),
    Column(
        "length_difference",
        "1",
        lambda records: records.length_differences.sum(axis=1) / records.vehicle_length,
    ),
    *_of_events(event for event in EVENTS if not (event is _JACKKNIFE_EVENT or event.obstacles)),
    Column("steps", "steps", lambda records: records.clock[STEP]),
    Column("moving_steps", "steps", lambda records: records.total[:, MOVED].astype(np.int64)),
    Column("path_length", "m", lambda records: records.total[:, PATH]),
    Column("largest_articulation", "rad", lambda records: records.total[:, LARGEST]),
    Column("folded_through", "bool", lambda records: records.total[:, LARGEST] > np.pi),
)
# for worlds that have obstacles
OBSTACLE_COLUMNS = _of_events(event for event in EVENTS if event.obstacles)
# for policies whose commands pass the safety filter
FILTER_COLUMNS = (
    Column(
        "interventions", "steps", lambda records: records.total[:, INTERVENTIONS].astype(np.int64)
    ),
)

GOAL_COLUMNS = (
    *_poses("goal_{goal}", lambda records, g: records.goals[:, g]),
    Column("goal_{goal}_hit", "bool", HavRecords.hit),
    Column(
        "goal_{goal}_step",
        "steps",
        lambda records, g: records.goal[:, g, HIT_STEP].astype(np.int64),
        HavRecords.hit,
    ),
    Column(
        "goal_{goal}_distance",
        "m",
        lambda records, g: records.goal[:, g, HIT_DISTANCE],
        HavRecords.hit,
    ),
    Column(
        "goal_{goal}_heading_difference",
        "rad",
        lambda records, g: records.goal[:, g, HIT_HEADING],
        HavRecords.hit,
    ),
    Column(
        "goal_{goal}_closest",
        "m",
        lambda records, g: records.goal[:, g, CLOSEST],
        HavRecords.assigned,
    ),
    Column(
        "goal_{goal}_dubins_length",
        "m",
        lambda records, g: records.goal[:, g, DUBINS],
        HavRecords.assigned,
    ),
    Column("goal_{goal}_driven_length", "m", HavRecords.driven, HavRecords.hit),
    Column(
        "goal_{goal}_length_ratio",
        "1",
        lambda records, g: records.driven(g) / records.goal[:, g, DUBINS],
        HavRecords.hit,
    ),
)

MISSES = {"heading": HEADING_MISS, "euclidean": EUCLIDEAN_MISS}


def _missed(records: HavRecords, g: int, kind: int) -> np.ndarray:
    return records.misses(g, kind) != 0


MISS_COLUMNS = (
    Column("goal_{goal}_{kind}_miss_steps", "steps", HavRecords.misses),
    Column(
        "goal_{goal}_{kind}_miss_distance",
        "m",
        lambda records, g, kind: records.miss[:, g, kind, MISS_DISTANCE],
        _missed,
    ),
    Column(
        "goal_{goal}_{kind}_miss_heading_difference",
        "rad",
        lambda records, g, kind: records.miss[:, g, kind, MISS_HEADING],
        _missed,
    ),
    Column("goal_{goal}_{kind}_miss_jackknife_weight", "1", HavRecords.miss_weight, _missed),
)


def tabulate(worlds: World, start: np.ndarray, policy, task: Task = Task()) -> pa.Table:
    """Turn the records of ended episodes into rows, in the order of episodes and HAVs.

    Args:
        worlds: Batch at the end of its episodes.
        start: (N, 3, W) start poses.
        policy: Policy whose jackknife weights are reported; the paper's weights for policies
            without any.
        task: The rules of the episodes.
    """
    records = HavRecords(worlds, start, policy, task)
    columns: dict[str, Any] = {}

    def add(column: Column, at: tuple[int, ...] = (), **words: Any) -> None:
        with np.errstate(divide="ignore", invalid="ignore"):  # in rows without a value
            values = column.values(records, *at)
        if column.known is not None:
            values = pa.array(values, mask=~column.known(records, *at))
        columns[column.name.format(**words)] = values

    obstacles = OBSTACLE_COLUMNS if records.obstacles else ()
    filtered = FILTER_COLUMNS if isinstance(policy, Filtered) else ()
    for column in (*COLUMNS, *obstacles, *filtered):
        add(column)
    for g in range(records.num_goals):
        for column in GOAL_COLUMNS:
            add(column, (g,), goal=g + 1)
        for kind, row in MISSES.items():
            for column in MISS_COLUMNS:
                add(column, (g, row), goal=g + 1, kind=kind)
    return pa.table(columns)
