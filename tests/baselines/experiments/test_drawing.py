"""Figures are drawn beside the simulation: errors, interrupts and the order of the report."""

import itertools
import threading

import pytest

from baselines.__main__ import main
from baselines.experiments import reproduce
from baselines.experiments.side_thread import side_thread
from baselines.figures import all_figures
from tests.support.budgets import COMPILED

pytestmark = pytest.mark.skipif(not COMPILED, reason="whole episodes take minutes as plain Python")


def run(folder):
    words = ["reproduce", "--experiments", 4, "--seed", 3, "--output", folder]
    return main(list(map(str, words)))


def files(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    folder = tmp_path_factory.mktemp("finished")
    assert run(folder) == 0
    return files(folder)


def test_the_report_shows_every_picture_in_order(finished):
    lines = finished["report.md"].decode().splitlines()
    shown = [line.rpartition("(")[2].rstrip(")") for line in lines if line.startswith("![")]
    assert sorted(shown) == sorted(name for name in finished if name.endswith(".png"))
    kinds = ["jackknife_weight", "jackknife_single", "goals_single", "misses_single"]
    kinds += ["jackknife_pair", "goals_pair", "misses_pair"]
    assert shown[: len(kinds)] == [f"{kind}.png" for kind in kinds]
    assert all(name.startswith("trajectory_") for name in shown[len(kinds) :])
    assert len(shown) > len(kinds)


def test_an_error_of_a_drawing_is_reported_once_the_tables_are_written(
    tmp_path, finished, monkeypatch, capsys
):
    def refuse(*arguments):
        raise OSError("no space left for figures")

    with monkeypatch.context() as broken:
        broken.setattr(all_figures, "save_figure", refuse)
        assert run(tmp_path) == 2
    assert capsys.readouterr().err.splitlines()[-1] == "error: no space left for figures"
    left = files(tmp_path)
    assert left["pair.parquet"] == finished["pair.parquet"]
    assert "report.md" not in left
    assert run(tmp_path) == 0
    assert files(tmp_path) == finished


def test_an_interrupt_ends_the_drawing_and_the_same_command_goes_on(
    tmp_path, finished, monkeypatch, capsys
):
    drawing, interrupted = threading.Event(), threading.Event()

    def interrupt(job, folder, name, *how):
        if name == "pair":
            assert drawing.wait(60)
            interrupted.set()
            raise KeyboardInterrupt
        return run_experiments(job, folder, name, *how)

    def save_slowly(*arguments):
        drawing.set()
        assert interrupted.wait(60)
        return save_figure(*arguments)

    run_experiments, save_figure = reproduce.run_experiments, all_figures.save_figure
    with monkeypatch.context() as broken:
        broken.setattr(reproduce, "run_experiments", interrupt)
        broken.setattr(all_figures, "save_figure", save_slowly)
        assert run(tmp_path) == 130
    left = files(tmp_path)
    whole = {name for name in left if name.endswith((".png", ".svg"))}
    assert whole == {"jackknife_weight.png", "jackknife_weight.svg"}  # the figure under way
    assert all(left[name] == finished[name] for name in whole)
    assert not any(name.startswith(".") for name in set(left) - {".lock"})
    assert run(tmp_path) == 0
    assert files(tmp_path) == finished


def test_a_side_thread_runs_one_thing_after_the_other():
    places = []

    def steps(name):
        for step in range(100):
            places.append((name, threading.get_ident()))
            yield step

    with side_thread("test") as submit:
        jobs = [submit(steps(name)) for name in "ab"]
    assert [job.result() for job in jobs] == [list(range(100))] * 2
    assert [name for name, _ in places] == [*"a" * 100, *"b" * 100]
    assert {place for _, place in places}.isdisjoint({threading.get_ident()})
    assert len({place for _, place in places}) == 1


def test_an_error_ends_a_side_thread_between_two_elements():
    begun = threading.Event()

    def endless():
        for step in itertools.count():
            begun.set()
            yield step

    def fail():
        with side_thread("test") as submit:
            jobs.extend([submit(endless()), submit(iter(range(3)))])
            assert begun.wait(60)
            raise ValueError("the rest is of no use")

    jobs = []
    with pytest.raises(ValueError, match="of no use"):
        fail()
    assert jobs[0].done()
    assert jobs[1].cancelled()
