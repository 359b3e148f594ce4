"""Invalid commands print one line on stderr and exit with code 2 before they make any file."""

import pathlib

import pytest

from baselines.__main__ import main
from baselines.experiments import reserve_ablations as variants
from baselines.experiments import survey
from baselines.figures import safety as illustrations
from train import compare, ppo

HUGE = ["10000000000", str(10**12), str(10**30), "-1", "0", "1.5", "nan", "many", ""]
SEEDS = ["-1", str(2**32), str(10**30), "1.5", "x"]
EVALUATE, WATCH = ["evaluate", "random"], ["watch", "random", "--output", "new/x.html"]
TRAIN = ["--preset", "smoke", "--output", "new"]


def each(command, option, values):
    return [[*command, option, value] for value in values]


BASELINES = [
    *each([*EVALUATE, "--output", "new"], "--episodes", HUGE),
    *each(["evaluate", "avoid_jack", "--scenario", "paper-pair"], "--episodes", [str(10**8)]),
    *each(["reproduce", "--output", "new"], "--experiments", HUGE),
    *each(["calibrate", "--output", "new"], "--experiments", HUGE),
    *each([*EVALUATE, "--output", "new"], "--seed", SEEDS),
    *each(["reproduce", "--output", "new"], "--seed", SEEDS),
    *each(["calibrate", "--output", "new"], "--seed", SEEDS),
    *each(WATCH, "--seed", SEEDS),
    *each([*EVALUATE, "--output", "new"], "--threads", ["0", "-3", "100000", str(10**30), "x"]),
    *each(["reproduce", "--output", "new"], "--threads", ["0", str(10**30)]),
    *each(["calibrate", "--output", "new"], "--threads", ["0", str(10**30)]),
    *each(WATCH, "--episode", ["-1", str(2**32), str(10**30), "1.5"]),
    *each(WATCH, "--every", ["0", "-1", str(10**30), "0.5"]),
    *each(WATCH, "--fps", ["0", "-1", "1000", str(10**30), "nan"]),
    *each(WATCH, "--speed", ["0", "-1", "nan", "inf", "1e-300", "1e300", "fast"]),
    *each(["watch", "random"], "--output", ["x.png", "new/x", "", "folder.html", "file/x.html"]),
    *each(["watch", "random"], "--record", ["x.html", "", "folder.npz", "file/x.npz"]),
    *each(EVALUATE, "--output", ["file", "file/below"]),
    *each(["reproduce"], "--output", ["file", "file/below"]),
    *each(EVALUATE, "--output", ["x.html", "new/x.csv", "x.JSON", "x.parquet", "x.mp4"]),
    *each(["reproduce"], "--output", ["x.html", "x.csv", "x.png"]),
    *each(["evaluate"], "--scenario", ["", "paper-pair"]),
    ["evaluate", "random", "--scenario", "docks-6", "--output", "new"],
    ["evaluate", ""],
    ["evaluate", ":"],
    ["evaluate", "random", "\x1b[2J"],
    ["evaluate", "random", "[/]"],
    ["watch"],
    ["watch", "random", "reserve"],
    ["watch", "none.npz"],
    ["watch", "folder.npz", "--output", "new/x.html"],
    ["watch", "file.npz", "--output", "new/x.html"],
    ["wa\ntch"],
    ["[/]"],
    ["reproduce", "--policy"],
    ["reproduce", "stray"],
]
OTHERS = [
    *((survey.main, ["--output", "new", *words]) for words in (
        ["--share", "nan"], ["--share", "-1"], ["--share", "1e300"], ["--threads", "0"],
        ["--threads", str(10**30)], ["--seed", str(10**30)], ["--policies", "[/]"],
        ["--scenarios", "a\nb"],
    )),
    *((variants.main, ["--output", "new", *words]) for words in (
        ["--share", "0"], ["--threads", str(10**9)], ["--seed", "-1"],
    )),
    *((compare.main, ["--output", "new", *words]) for words in (
        ["--episodes", str(10**12)], ["--episodes", "0"], ["--shown", "-1"],
        ["--shown", str(10**30)], ["--threads", "0"], ["--seed", str(2**32)],
        ["--single", "[/].policy"],
    )),
    *((illustrations.main, ["--output", "new", *words]) for words in (
        ["--episodes", str(10**12)], ["--worlds", str(10**12)], ["--havs", str(10**12)],
        ["--steps", str(10**12)], ["--threads", str(10**9)], ["--episodes", "0"],
    )),
    (compare.main, ["--output", "file"]),
    (survey.main, ["--output", "file"]),
    (illustrations.main, ["--output", "file"]),
    (ppo.main, [*TRAIN, "--seed", str(10**30)]),
    (ppo.main, [*TRAIN, "--layers", "0"]),
    (ppo.main, ["--resume", "file"]),
    (ppo.main, ["--resume", "\x1b[2J"]),
]  # fmt: skip


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    """Work in a folder with a file and folders in the way."""
    monkeypatch.chdir(tmp_path)
    pathlib.Path("file").write_text("mine")
    pathlib.Path("file.npz").write_text("mine")
    for name in ("folder.npz", "folder.html"):
        pathlib.Path(name).mkdir()


def check(run, words, capsys):
    before = sorted(pathlib.Path().rglob("*"))
    assert run(words) == 2
    told = capsys.readouterr().err
    assert told.startswith("error: ")
    assert told.count("\n") == 1
    assert told[:-1].isprintable()
    assert sorted(pathlib.Path().rglob("*")) == before


@pytest.mark.parametrize("words", BASELINES, ids=" ".join)
def test_a_command_of_the_baselines(words, capsys):
    check(main, words, capsys)


def name(value):
    """Return the name of a parameter that is the same in all processes."""
    return value.__module__ if callable(value) else " ".join(value)


@pytest.mark.parametrize(("run", "words"), OTHERS, ids=name)
def test_another_command(run, words, capsys):
    check(run, words, capsys)


def test_there_are_many():
    assert len(BASELINES) + len(OTHERS) >= 100


@pytest.mark.parametrize("threads", ["none", "0", "1000000", "-1"])
def test_a_number_of_threads_from_the_environment_is_checked_first(threads, monkeypatch, capsys):
    monkeypatch.setenv("HAV_THREADS", threads)
    for words in ([*EVALUATE, "--output", "new"], ["reproduce", "--output", "new"]):
        check(main, words, capsys)
