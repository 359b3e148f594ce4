"""Damaged data on disk are made again or refused; runs keep out of each other."""

import errno
import json
import multiprocessing
import pathlib
import shutil
import threading

import numpy as np
import pyarrow.parquet as pq
import pytest

from baselines.evaluation import run_parts as parts
from baselines.evaluation import runs as results
from baselines.evaluation.runs import Experiments, run_experiments, spans_of
from baselines.policies.avoid_jack import AvoidJack
from baselines.policies.random import Random
from baselines.storage.locks import sole_user
from hav_env import OffAxle, RandomPoses, Task, rollout
from hav_env.guidance import Lattice
from tests.guidance.yards import yard
from tests.support.budgets import budget

JOB = Experiments(Random(), RandomPoses(), 9, 5, Task(max_steps=budget(20, 3)))
FLIPS = budget(40, 10)


@pytest.fixture(autouse=True)
def small_parts(monkeypatch):
    monkeypatch.setattr(results, "PART", 3)


@pytest.fixture(scope="module")
def stages(tmp_path_factory):
    """Return a finished folder, and one in which two of three parts are done."""
    base = tmp_path_factory.mktemp("stages")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(results, "PART", 3)
        run_experiments(JOB, base / "done", "a")
        left = iter([None])

        def stop(episodes, steps):
            next(left)

        with pytest.raises(StopIteration):
            run_experiments(JOB, base / "begun", "a", advance=stop)
    assert len(list((base / "begun/a.parts").iterdir())) == 2
    return base / "done", base / "begun"


def damages(content: bytes, seed: int):
    """Yield a file's content with one bit flipped, with one byte changed, and cut anywhere."""
    generator = np.random.default_rng(seed)
    for place in generator.integers(len(content), size=FLIPS):
        damaged = bytearray(content)
        damaged[place] ^= 1 << int(generator.integers(8))
        yield bytes(damaged)
        damaged[place] = (content[place] + int(generator.integers(1, 256))) % 256
        yield bytes(damaged)
    for place in generator.integers(len(content), size=FLIPS // 4):
        yield content[:place]
    yield content + b"\n"


def files_of(folder: pathlib.Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.parametrize(
    "what", ["a.parquet", "a.json", "a.parts/000000000*", "a.parts/000000003*"]
)
def test_no_damage_is_passed_on(what, stages, tmp_path, caplog):
    done, begun = stages
    whole = files_of(done)
    source = begun if "parts" in what else done
    mended = refused = 0
    for number, content in enumerate(damages(next(source.glob(what)).read_bytes(), 1)):
        folder = shutil.copytree(source, tmp_path / str(number))
        path = next(folder.glob(what))
        path.write_bytes(content)
        caplog.clear()
        try:
            run_experiments(JOB, folder, "a")
        except ValueError as error:
            refused += str(folder) in str(error)
        else:
            assert files_of(folder) == whole
            mended += 1
            if what != "a.json":
                assert len(caplog.messages) == 1
                assert str(path) in caplog.messages[0]
        shutil.rmtree(folder)
    assert mended + refused == number + 1
    # a description decides what runs: one of another run is not overwritten
    assert refused == 0 or what == "a.json"


def test_parts_that_are_whole_are_not_run_again(stages, tmp_path):
    folder = shutil.copytree(stages[1], tmp_path / "begun")
    (folder / "a.parts/notes.txt").write_text("mine")
    told = []
    run_experiments(JOB, folder, "a", advance=lambda *numbers: told.append(numbers))
    assert [episodes for episodes, _ in told] == [3, 3, 3]
    assert [steps > 0 for _, steps in told] == [False, False, True]
    assert files_of(folder) == files_of(stages[0])


def test_a_part_that_breaks_while_others_run_is_named(stages, tmp_path):
    folder = shutil.copytree(stages[1], tmp_path / "begun")
    broken = next((folder / "a.parts").glob("000000000*"))

    def spoil(episodes, steps):
        if steps:
            broken.write_bytes(b"")

    with pytest.raises(OSError, match=broken.name):
        run_experiments(JOB, folder, "a", advance=spoil)
    run_experiments(JOB, folder, "a")
    assert files_of(folder) == files_of(stages[0])


@pytest.mark.parametrize("kept", ["a.parquet", "a.json", "a.parts"])
@pytest.mark.parametrize("overwrite", [False, True])
def test_something_else_in_the_place_of_a_file_is_named_and_kept(kept, overwrite, tmp_path):
    if kept.endswith("parts"):
        (tmp_path / kept).write_text("mine")
    else:
        (tmp_path / kept).mkdir()
        (tmp_path / kept / "note").write_text("mine")
    with pytest.raises(ValueError, match=f"{kept} is a (folder|file), but must be a (file|folder)"):
        run_experiments(JOB, tmp_path, "a", overwrite=overwrite)
    assert [path.name for path in tmp_path.iterdir()] == [kept]


@pytest.mark.parametrize(
    ("name", "advice"),
    [("x.html", "hav-env watch draws"), ("x.CSV", "--format csv"), ("x.json", "for each table")],
)
def test_no_folder_gets_the_name_of_a_file(name, advice, tmp_path):
    with pytest.raises(ValueError, match=f"{name}, but must be a folder: .*{advice}"):
        run_experiments(JOB, tmp_path / name, "a")
    assert not list(tmp_path.iterdir())


def test_a_file_in_the_place_of_the_folder_is_named(tmp_path):
    (tmp_path / "file").write_text("mine")
    with pytest.raises(ValueError, match="file is a file, but must be a folder"):
        run_experiments(JOB, tmp_path / "file", "a")
    with pytest.raises(OSError, match="file"):
        run_experiments(JOB, tmp_path / "file/below", "a")
    assert (tmp_path / "file").read_text() == "mine"


@pytest.mark.parametrize(
    "text",
    [b"[]", b"null", b"3", b'"a"', b"{", b"", b"\xff\xfe", b"[" * 100_000, b"\xef\xbb\xbf{}"],
)
def test_a_description_that_is_none_is_one_line(text, stages, tmp_path):
    folder = shutil.copytree(stages[0], tmp_path / "done")
    (folder / "a.json").write_bytes(text)
    with pytest.raises(ValueError, match="describes no run") as told:
        run_experiments(JOB, folder, "a")
    assert "--overwrite" in str(told.value)
    run_experiments(JOB, folder, "a", overwrite=True)
    assert files_of(folder) == files_of(stages[0])


def test_a_digest_that_is_lost_or_no_text_makes_the_table_anew(stages, tmp_path):
    for digest in (None, 3, [], "0" * 64, ...):
        folder = shutil.copytree(stages[0], tmp_path / repr(digest))
        told = json.loads((folder / "a.json").read_text())
        told["table_sha256"] = digest
        if digest is ...:
            del told["table_sha256"]
        (folder / "a.json").write_text(json.dumps(told))
        run_experiments(JOB, folder, "a")
        assert files_of(folder) == files_of(stages[0])


@pytest.mark.parametrize("function", ["write_part", "join_parts"])
def test_a_full_disk_is_told_and_a_later_run_goes_on(function, stages, tmp_path, monkeypatch):
    def full(*arguments, **keywords):
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        module, name = (parts.pathlib.Path, "write_bytes") if function[6:] == "part" else (
            parts.pq, "ParquetWriter")  # fmt: skip
        patch.setattr(module, name, full)
        with pytest.raises(OSError, match="No space left"):
            run_experiments(JOB, tmp_path / "r", "a")
    assert not list((tmp_path / "r").rglob("*.parquet.*"))
    run_experiments(JOB, tmp_path / "r", "a")
    assert files_of(tmp_path / "r") == files_of(stages[0])


def _hold(folder, entered, leave):
    with sole_user(folder):
        entered.set()
        leave.wait()


@pytest.mark.parametrize("overwrite", [False, True])
def test_a_second_run_is_told_of_the_first(overwrite, stages, tmp_path):
    folder = shutil.copytree(stages[0], tmp_path / "r")
    context = multiprocessing.get_context("spawn")
    entered, leave = context.Event(), context.Event()
    first = context.Process(target=_hold, args=(folder, entered, leave))
    first.start()
    assert entered.wait(100)
    with pytest.raises(BlockingIOError, match="another run works in"):
        run_experiments(JOB, folder, "a", overwrite=overwrite)
    first.kill()  # leaves the lock file, and no process that holds it
    first.join()
    assert (folder / ".lock").exists()
    run_experiments(JOB, folder, "a")
    assert files_of(folder) == files_of(stages[0])


def test_threads_keep_out_of_each_other_and_may_enter_again(tmp_path):
    entered, leave = threading.Event(), threading.Event()
    other = threading.Thread(target=_hold, args=(tmp_path, entered, leave))
    other.start()
    assert entered.wait(100)
    with pytest.raises(BlockingIOError), sole_user(tmp_path):
        pass
    leave.set()
    other.join()
    with sole_user(tmp_path), sole_user(tmp_path / "." / "x" / ".."):
        assert (tmp_path / ".lock").exists()
    assert not list(tmp_path.glob(".*"))


def test_spans_cover_all_episodes_once_and_are_made_as_they_are_needed():
    for havs in (1, 2, 7):
        job = Experiments(Random(), RandomPoses(num_havs=havs), 10)
        assert [k for span in spans_of(job) for k in span] == list(range(10))
    assert next(spans_of(JOB._replace(num_episodes=10**15))) == range(3)


def test_rows_are_those_of_the_episodes(stages):
    table = pq.read_table(stages[0] / "a.parquet")
    assert table["episode"].to_pylist() == list(range(9))


@pytest.mark.exhaustive
def test_the_guidance_of_a_run_guides_its_havs(tmp_path):
    task, guidance = Task(max_steps=budget(400, 10)), Lattice(headings=24, clearance=4.0)
    job = Experiments(AvoidJack(), yard(), 1, 0, task, OffAxle(), guidance)
    table = pq.read_table(run_experiments(job, tmp_path, "a"))
    models = job.policy, job.scenario, 0, [0], task, job.vehicle
    assert table.equals(rollout(*models, guidance=guidance))
