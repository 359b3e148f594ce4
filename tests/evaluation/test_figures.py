"""Columns and figures are declared once: a new one is one entry."""

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from baselines.policies.dubins_pursuit import DubinsPursuit
from hav_env import Batch, RandomPoses, Task
from hav_env.evaluation import episode_table, figures
from hav_env.evaluation.comparison import compare, read_columns
from hav_env.evaluation.episode_table import COLUMNS, Column, tabulate
from hav_env.evaluation.figures import FIGURES, Figure, figures_of, goals_of, measure
from hav_env.evaluation.rollout import rollout
from hav_env.mdp.info import OBSTACLE_REPORT, REPORT
from hav_env.world.arrays import MOVED, PATH
from hav_env.world.event_table import EVENTS

MEAN_SPEED = Column(
    "mean_speed",
    "m/s",
    lambda records: records.total[:, PATH] / (records.total[:, MOVED] * records.dt),
    lambda records: records.total[:, MOVED] > 0,
)


@pytest.fixture(scope="module")
def table():
    return rollout(DubinsPursuit(), RandomPoses(2), 0, np.arange(2), Task(max_steps=20))


def test_a_new_column_and_its_figure_are_one_entry_each(monkeypatch):
    monkeypatch.setattr(episode_table, "COLUMNS", (*COLUMNS, MEAN_SPEED))
    shown = Figure("mean speed [m/s]", "mean_speed", percent=False, more_is_better=True)
    monkeypatch.setattr(figures, "FIGURES", (*FIGURES, shown))
    batch = Batch(RandomPoses(2), 1)
    batch.reset(0)
    batch.worlds.record.total[:, [PATH, MOVED], 0] = [[12.0, 20.0], [0.0, 0.0]]
    table = tabulate(batch.worlds, np.zeros((2, 3, 1)), DubinsPursuit(), Task(dt=0.3))
    assert table["mean_speed"].to_pylist() == [pytest.approx(2.0), None]
    assert compare(["one"], [table])[-1] == ["mean speed", "2.00 m/s"]


def test_figures_come_in_their_order_and_those_of_company_only_in_company(table):
    known = [
        *("jackknifed", "goal 1 hit", "goal 2 hit", "potential collision", "actual collision"),
        *("folded through", "goal 1 step", "goal 2 step"),
        *("goal 1 driven / Dubins", "goal 2 driven / Dubins", "largest articulation [rad]"),
    ]
    names = [figure.name for figure in figures_of(table)]
    assert [name for name in names if name in known] == known  # the added ones are between them
    alone = table.filter(np.equal(table["hav"].to_numpy(), 0))
    assert not {figure.name for figure in figures_of(alone)} & {
        event.label for event in EVENTS if event.company
    }
    assert list(goals_of(alone.column_names)) == [1, 2]


def test_a_joint_that_folded_through_counts_as_half_a_turn(table):
    angles = np.resize([0.5, 3.0, 9.0, 500.0], table.num_rows)
    place = table.column_names.index("largest_articulation")
    turned = table.set_column(place, "largest_articulation", pa.array(angles))
    (figure,) = (one for one in figures_of(turned) if one.column == "largest_articulation")
    expected = np.array([0.5, 3.0, np.pi, np.pi])
    assert measure(turned, figure).value == pytest.approx(np.resize(expected, angles.size).mean())


def test_what_is_read_of_a_file_is_what_the_figures_need(table, tmp_path):
    pq.write_table(table, tmp_path / "table.parquet")
    read = read_columns(tmp_path / "table.parquet")
    assert compare(["one"], [read]) == compare(["one"], [table])
    needed = {figure.column for figure in figures_of(table)}
    assert set(read.column_names) == {"episode", "hav", *needed}


def test_every_event_has_its_columns_its_figure_and_its_entry_in_the_report(table):
    assert [event.row for event in EVENTS] == list(range(len(EVENTS)))
    first = REPORT.index(EVENTS[0].name)
    told = [event for event in EVENTS if not event.obstacles]  # there are none
    assert REPORT[first : first + len(told)] == tuple(event.name for event in told)
    assert tuple(event.name for event in EVENTS if event.obstacles) == OBSTACLE_REPORT
    for event in told:
        columns = {event.name, f"{event.stem}_step", f"{event.stem}_{event.place}"}
        assert columns <= set(table.column_names)
        assert event.name in {figure.column for figure in FIGURES}
