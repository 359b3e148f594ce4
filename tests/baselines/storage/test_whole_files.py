"""Files are complete or absent; leftovers of killed writers are removed, others are kept."""

import multiprocessing
import os
import pathlib
import threading

import pytest

from baselines.storage.atomic_files import digest_of, read_object, whole_file, write_text


def _write_for_ever(path, begun):
    with whole_file(path) as unfinished:
        unfinished.write_text("half")
        begun.set()
        threading.Event().wait()


def killed_writer(path):
    """Run a writer until it has begun; return its process."""
    context = multiprocessing.get_context("spawn")
    begun = context.Event()
    writer = context.Process(target=_write_for_ever, args=(path, begun))
    writer.start()
    assert begun.wait(100)
    return writer


def hidden(folder: pathlib.Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir() if path.name.startswith("."))


def test_what_a_killed_process_left_goes_and_what_a_living_one_writes_stays(tmp_path):
    path = tmp_path / "a.txt"
    writer = killed_writer(path)
    (left,) = hidden(tmp_path)
    write_text("whole", path)
    assert hidden(tmp_path) == [left]  # is being written
    writer.kill()
    writer.join()
    write_text("other", tmp_path / "b.txt")
    assert hidden(tmp_path) == [left]  # is none of that file
    write_text("again", path)
    assert hidden(tmp_path) == []
    assert path.read_text() == "again"


def test_a_number_of_a_process_that_is_in_use_again_keeps_nothing(tmp_path):
    for name in (f".{os.getpid()}.0.a.txt", ".1.0.a.txt", f".{os.getppid()}.a.txt"):
        (tmp_path / name).write_text("left")
    mine = [".a.txt", ".x.a.txt", ".5.b.txt", "5.0.a.txt", ".5.0.a.txt.bak"]
    for name in mine:
        (tmp_path / name).write_text("mine")
    write_text("whole", tmp_path / "a.txt")
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([*mine, "a.txt"])


def test_threads_that_write_the_same_file_do_not_meet(tmp_path):
    path, failed = tmp_path / "a.txt", []

    def write(letter):
        try:
            for _ in range(100):
                write_text(letter * 10_000, path)
        except OSError as error:
            failed.append(error)

    threads = [threading.Thread(target=write, args=(letter,)) for letter in "abcd"]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failed
    assert len(path.read_text()) == 10_000
    assert len(set(path.read_text())) == 1
    assert hidden(tmp_path) == []


def test_a_writer_that_fails_leaves_what_was_there(tmp_path):
    path = tmp_path / "a.txt"
    write_text("first", path)

    def fail():
        with whole_file(path) as unfinished:
            unfinished.write_text("half")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail()
    assert path.read_text() == "first"
    assert hidden(tmp_path) == []


def test_no_digest_of_what_is_no_file(tmp_path):
    assert digest_of(tmp_path) is None
    assert digest_of(tmp_path / "none") is None


@pytest.mark.parametrize("text", [b"", b"[]", b"null", b"{", b"\xff", b"[" * 100_000, b'{"a": }'])
def test_a_broken_object_is_named(text, tmp_path):
    (tmp_path / "a.json").write_bytes(text)
    with pytest.raises(ValueError, match=r"a\.json is broken: "):
        read_object(tmp_path / "a.json")
