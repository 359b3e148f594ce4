"""The survey: separate counts, shortest times, its table, and the inputs that it rejects."""

import math

import numpy as np
import pyarrow as pa
import pytest
import shapely

from baselines.evaluation.feasibility import goals_crossing, shortest_times, starts_touching
from baselines.experiments.survey import SURVEY, look_at, main, rows_of
from baselines.policies.avoid_jack import AvoidJack
from baselines.policies.reserve import Reserve
from hav_env import RandomFleet, RandomPoses, Task, explicit, find_scenario
from hav_env.evaluation.rollout import rollout
from tests.support.budgets import budget

# long trucks with short trailers, which the rule of the starts does not keep apart
CROWD = RandomPoses(num_havs=6, area_factor=1.5, fleet=RandomFleet(max_trailers=1))


@pytest.fixture(scope="module")
def crowd():
    """Return a table of worlds so crowded that goals and starts are in each other's way."""
    return rollout(AvoidJack(), CROWD, 3, np.arange(budget(40, 12)), task=Task(max_steps=2))


def line(x, y, heading, ahead):
    return shapely.LineString(
        [(x, y), (x + ahead * math.cos(heading), y + ahead * math.sin(heading))]
    )


def crossing_in(rows, place):
    lines = [line(*(row[place + part] for part in ("x", "y", "heading")), row["truck_length"])
             for row in rows]  # fmt: skip
    return any(a.intersects(b) for k, a in enumerate(lines) for b in lines[:k])


def test_goals_cross_when_shapely_says_so(crowd):
    worlds = [crowd.slice(first, 6).to_pylist() for first in range(0, crowd.num_rows, 6)]
    expected = [crossing_in(w, "goal_1_") or crossing_in(w, "goal_2_") for w in worlds]
    assert goals_crossing(crowd, 6).tolist() == expected
    assert 0 < sum(expected) < len(expected)


def test_worlds_that_start_in_collision_are_those_whose_trucks_and_trailers_touch():
    first, goals = (0.0, 0.0, 0.0), [[(80.0, 0.0, 0.0)], [(80.0, 30.0, 0.0)]]
    for second, touches in (((6.0, -5.0, -math.pi / 2), False), ((6.0, -5.0, math.pi / 2), True)):
        scenario = explicit([[12.0, 2.0]] * 2, [first, second], goals)
        table = rollout(AvoidJack(), scenario, 0, [0], task=Task(max_steps=2))
        assert starts_touching(table, 2).tolist() == [touches]


def test_the_shortest_time_straight_ahead_is_the_distance_over_the_speed():
    goals = [(30.0, 0.0, 0.0), (42.0, 0.0, 0.0)]
    table = rollout(AvoidJack(), explicit([[4.0, 5.0]], [(0.0, 0.0, 0.0)], [goals]), 0, [0],
                    task=Task(max_steps=2))  # fmt: skip
    fleet = RandomFleet(speed_max=2.0)
    for times in shortest_times(table, fleet):
        assert times == pytest.approx(np.array([[30.0], [12.0]]) / (2.0 * 0.2))


def test_shortest_times_are_for_the_radii_that_are_said(crowd):
    """Back to the start, turned round: a path that is as long as its radius, 7 pi / 3 of it."""
    steep, stable = shortest_times(crowd, CROWD.fleet)
    truck = crowd["truck_length"].to_numpy()
    trailers = [math.hypot(*lengths) for lengths in crowd["trailer_lengths"].to_pylist()]
    assert (stable >= steep - 1e-9).all()
    same = crowd
    for part in ("x", "y", "heading"):
        turned = crowd[f"start_{part}"].to_numpy() + (math.pi if part == "heading" else 0.0)
        same = same.set_column(
            same.column_names.index(f"goal_1_{part}"), f"goal_1_{part}", pa.array(turned)
        )
    steep, stable = shortest_times(same, CROWD.fleet)
    own = truck / math.tan(CROWD.fleet.steering_max)
    round_about = 7.0 * math.pi / 3.0 / (CROWD.fleet.speed_max * 0.2)
    assert steep[0] == pytest.approx(own * round_about)
    assert stable[0] == pytest.approx(1.02 * np.maximum(own, trailers) * round_about)


def test_what_is_apart_is_not_counted(crowd):
    apart = goals_crossing(crowd, 6) | starts_touching(crowd, 6)
    found = look_at(crowd, CROWD.fleet, 2)
    assert found.apart == apart.sum()
    assert found.size == 6 * (~apart).sum()
    told = crowd["actual_collision"].to_numpy(zero_copy_only=False).reshape(-1, 6)
    assert found.harmed[1].value == pytest.approx(told[~apart].mean())


def test_tables_tell_of_obstacles_where_there_are_some(crowd):
    shown = np.arange(crowd.num_rows) % 4 == 0
    among = crowd.append_column("obstacle_collision", pa.array(shown))
    found = [look_at(table, CROWD.fleet, 2) for table in (crowd, among)]
    head, plane, walls = rows_of([("a", "b", found[0]), ("c", "d", found[1])])
    place = head.index("hit an obstacle")
    kept = ~np.repeat(goals_crossing(crowd, 6) | starts_touching(crowd, 6), 6)
    assert walls[place].startswith(f"{100 * shown[kept].mean():.2f} %")
    assert plane[2:] == [*walls[2:place], "-", *walls[place + 1 :]]
    assert "hit an obstacle" not in rows_of([("a", "b", found[0])])[0]
    assert len({len(row) for row in (head, plane, walls)}) == 1


def test_who_never_arrives_counts_at_the_cap_and_the_interval_is_of_worlds(crowd):
    """All episodes end after two steps, so no HAV arrives."""
    kept = ~(goals_crossing(crowd, 6) | starts_touching(crowd, 6))
    _, stable = shortest_times(crowd, CROWD.fleet)
    shortest = stable[0].reshape(-1, 6).sum(1)[kept]
    found = look_at(crowd, CROWD.fleet, 2)
    assert found.time.value == pytest.approx(6 * 2 * kept.sum() / shortest.sum())
    assert found.time.size == kept.sum()
    assert found.time.low < found.time.value < found.time.high
    cell = rows_of([("a", "b", found)])[1][-2]
    assert cell == f"{found.time.value:.3f} [{found.time.low:.3f}, {found.time.high:.3f}]"


@pytest.mark.exhaustive
def test_reserve_is_in_time():
    table = rollout(
        *(Reserve(), find_scenario("paper-single"), 31, np.arange(budget(40, 1))),
        task=Task(max_steps=budget(20_000, 60)),
    )
    found = look_at(table, find_scenario("paper-single").fleet, 20_000)
    assert found.harmed[0].value == 0
    if budget(1, 0):
        assert [(hit.value, hit.size) for hit in found.hits] == [(1.0, 40), (1.0, 40)]
        assert 1.0 <= found.time.low < found.time.value < 1.15


def test_the_table_and_going_on(tmp_path, capsys):
    words = ["--scenarios", "paper-single", "dense-2", "--policies", "random", "--share", "0.0002",
             "--output", str(tmp_path), "--threads", "1", "--format", "md"]  # fmt: skip
    assert main(words) == 0
    first = capsys.readouterr().out
    assert first.splitlines()[4].startswith("| paper-single | random | 1 | 0.00 %")
    assert first.splitlines()[5].startswith("| dense-2 | random | 2 |")
    table = (tmp_path / "dense-2-random.parquet").stat()
    assert main(words) == 0
    assert capsys.readouterr().out == first
    assert (tmp_path / "dense-2-random.parquet").stat().st_mtime_ns == table.st_mtime_ns


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--scenarios", "swarm-3"], "error: scenarios has 'swarm-3' (did you mean 'swarm-"),
        (["--share", "1.5"], "error: share is 1.5, but must be above 0 and at most 1"),
        (["--policies", "nobody"], "error: unknown policy 'nobody'"),
        (["--seed", "-1", "--scenarios", "dense-5", "--share", "0.01"], "error: seed is -1"),
    ],
)
def test_what_is_refused(words, said, capsys, tmp_path):
    assert main([*words, "--output", str(tmp_path)]) == 2
    assert said in capsys.readouterr().err.splitlines()[-1]


def test_every_scenario_of_the_survey_can_be_found():
    assert all(find_scenario(entry.scenario) for entry in SURVEY)
