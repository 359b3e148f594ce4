"""The search for readings: selection from round to round, separate seeds, and resuming."""

import functools
import itertools

import pyarrow.parquet as pq
import pytest

from baselines.__main__ import main
from baselines.commands import calibrate
from baselines.experiments import search as searching
from baselines.experiments import search_report
from baselines.experiments.published import PAPER_SIZES
from baselines.experiments.readings import TEXT, vary
from baselines.experiments.search import Plan, Round, search
from baselines.experiments.search_report import compare_words, names_of, show_found
from baselines.experiments.search_space import pair_readings, single_readings
from hav_env import Task
from tests.support.budgets import budget

PLAN = Plan(Round(3, 3), Round(4, 2), Round(2, 4), Round(3, 2), Round(4, 2), Round(5, 1), 6)
STEPS = {"max_steps": budget(500, 5)}


@pytest.fixture
def small(monkeypatch):
    """Let the search have a few readings, of short episodes."""
    singles = [
        vary(TEXT, f"single {factor}", policy={"close_factor": factor}, task=STEPS)
        for factor in (1.0, 3.0, 3.5)
    ]
    monkeypatch.setattr(searching, "single_readings", lambda: iter(singles))
    monkeypatch.setattr(
        searching,
        "pair_readings",
        lambda reading: itertools.islice(pair_readings(reading), 0, 70, 14),
    )


def test_each_round_takes_the_nearest_of_the_one_before(small, tmp_path):
    found = search(9, tmp_path, plan=PLAN)
    rounds = {name: list(ones) for name, ones in itertools.groupby(found, lambda one: one.round)}
    assert list(rounds) == [
        "single",
        "more singles",
        "pair",
        "more pairs",
        "both",
        "full",
        "confirm",
    ]
    assert [len(ones) for ones in rounds.values()] == [3, 3, 10, 4, 6, 2, 3]
    for name in ("single", "both", "full"):
        scores = [one.near.score for one in rounds[name]]
        assert scores == sorted(scores)
    best = {one.reading.name for one in rounds["more singles"][:2]}
    assert {one.reading.name.partition(";")[0] for one in rounds["pair"]} == best
    assert {one.reading.task.record_every for one in rounds["both"]} == {1, 10, 100}
    nearest = {one.reading.name for one in rounds["both"][:2]}
    assert {one.reading.name for one in rounds["full"]} == nearest
    assert [one.reading for one in rounds["confirm"]] == [rounds["full"][0].reading] * 3
    assert [one.seed for one in rounds["confirm"]] == [10, 11, 12]
    assert {one.seed for one in found if one.round != "confirm"} == {9}
    table = pq.read_table(tmp_path / "search.parquet")
    assert table["reading"].to_pylist() == [one.reading.name for one in found]
    met = [one.near.shares.get("pair potential collision") for one in found]
    assert table["pair potential collision"].to_pylist() == met
    assert table["single first goal"].null_count == len(rounds["pair"]) + len(rounds["more pairs"])
    assert len(show_found(found)) == 2 + 2 + 3
    assert names_of(found) == [one.reading.name for one in rounds["full"]]
    assert [row[0] for row in show_found(found)[2:]] == ["1", "2", "1", "1", "1"]


def test_an_interrupted_search_goes_on_where_it_stopped(small, tmp_path, monkeypatch):
    whole = search(9, tmp_path / "whole", plan=PLAN)
    runs, rollout = [], searching.rollout

    def interrupted(*arguments):
        if len(runs) == 12:
            raise KeyboardInterrupt
        runs.append(arguments)
        return rollout(*arguments)

    monkeypatch.setattr(searching, "rollout", interrupted)
    with pytest.raises(KeyboardInterrupt):
        search(9, tmp_path / "broken", plan=PLAN)
    path = tmp_path / "broken/search.jsonl"
    path.write_text(path.read_text()[:-20])  # killed while it wrote a line
    monkeypatch.setattr(
        searching, "rollout", lambda *arguments: runs.append(0) or rollout(*arguments)
    )
    assert search(9, tmp_path / "broken", plan=PLAN) == whole
    first = len(runs)
    assert search(9, tmp_path / "broken", plan=PLAN) == whole
    assert len(runs) == first  # all measurements are stored
    tables = [tmp_path / name / "search.parquet" for name in ("whole", "broken")]
    assert tables[0].read_bytes() == tables[1].read_bytes()
    with pytest.raises(ValueError, match="has another seed"):
        search(8, tmp_path / "broken", plan=PLAN)


def test_the_field_is_what_the_choices_span():
    singles = list(single_readings())
    assert len(singles) == len({reading.name for reading in singles}) == 9 * 11 * 2 * 4 * 2
    pairs = list(pair_readings(singles[0]))
    assert len(pairs) == len({reading.name for reading in pairs}) == 2 * 2 * (3 + 3 * 2) * 2
    assert {reading.fleet for reading in pairs} == {singles[0].fleet}
    assert len({(*reading.policy, *reading.task) for reading in pairs}) == len(pairs)
    assert TEXT.task == Task()  # nothing wrote into it


def test_the_number_of_experiments_is_known_before(small, tmp_path, monkeypatch):
    done = []
    monkeypatch.setattr(searching, "Progress", lambda total: _Counted(done, total))
    search(9, tmp_path, plan=PLAN)
    assert done[0] == sum(done[1:])
    assert PAPER_SIZES == ("single", "pair")


class _Counted:
    def __init__(self, done, total):
        self.done = done
        done.append(total)

    def __enter__(self):
        return self

    def __exit__(self, *error):
        pass

    def advance(self, experiments, steps):
        self.done.append(experiments)


def test_the_command_shows_readings_by_number_and_their_words(small, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(search_report, "_RECORDED", 2)
    monkeypatch.setattr(calibrate, "search", functools.partial(search, plan=PLAN))
    assert main(["calibrate", "--search", "--seed", "9", "--output", str(tmp_path)]) == 0
    told = capsys.readouterr().out
    names = pq.read_table(tmp_path / "search.parquet")["reading"].to_pylist()
    assert f"{len(set(names))} readings tried" in told
    assert f"1: {names[-1]}" in told
    assert "the paper's words, in pairs" in told


def test_words_are_measured_for_confirmed_readings(small, tmp_path, monkeypatch):
    monkeypatch.setattr(search_report, "_RECORDED", 2)
    rows = compare_words(search(9, tmp_path, plan=PLAN))
    assert rows[0] == ["", "reading 1, seed 10"]
    assert all(len(row) == 2 for row in rows)
    assert "evades" in rows[-1][0]
