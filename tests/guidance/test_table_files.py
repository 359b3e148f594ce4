"""Lattices on disk are found again, never mixed up, and broken ones are made again."""

import hashlib
import logging
import pickle

import numpy as np
import pytest

from hav_env.compiled.cache_folder import find_home
from hav_env.guidance import (
    Lattice,
    LatticeTable,
    array_files,
    find_lengths,
    load_lengths,
    table_files,
)

LATTICE = Lattice(cell=2.0, headings=8, clearance=1.5, direct=10.0)
WALL = np.array([[0.0, 0.0, 12.0, 0.0]])
GIVEN = {
    "lattice": LATTICE,
    "segments": WALL,
    "goal": (6.0, 6.0, 0.5),
    "radius": 4.0,
    "bounds": (0.0, 0.0, 12.0, 12.0),
}
OTHERS = {
    "lattice": LATTICE._replace(headings=10),
    "segments": WALL + 0.25,
    "goal": (6.0, 6.0, 0.75),
    "radius": 4.5,
    "bounds": (0.0, 0.0, 12.0, 12.5),
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    home = tmp_path / "home"
    find_lengths(**GIVEN)  # compiles; its code goes to the folder that all tests share
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(home))
    return home / "lattices"


def same(one: LatticeTable, other: LatticeTable) -> bool:
    pairs = zip(one, other, strict=True)
    return all(np.array_equal(a, b) and type(a) is type(b) for a, b in pairs)


def refuse(*args):
    raise AssertionError("it is searched again")


def test_a_kept_table_is_the_same_and_is_not_searched_again(folder, monkeypatch):
    table = load_lengths(**GIVEN)
    assert same(table, find_lengths(**GIVEN))
    assert len(list(folder.iterdir())) == 1
    monkeypatch.setattr(table_files, "search", refuse)
    again = load_lengths(**GIVEN)
    assert same(again, table)
    assert again.length.dtype == np.float32


def test_each_thing_that_determines_a_table_has_a_file_of_its_own(folder):
    load_lengths(**GIVEN)
    for count, (name, other) in enumerate(OTHERS.items(), start=2):
        given = GIVEN | {name: other}
        assert same(load_lengths(**given), find_lengths(**given))
        assert len(list(folder.iterdir())) == count


class Planted:
    """An object that leaves a trace when it is unpickled."""

    traces: tuple = ()

    def __reduce__(self):
        """Run code when it is unpickled."""
        return exec, ("from tests.guidance.test_table_files import Planted; Planted.traces = (1,)",)


def broken(content):
    """Yield contents that are no table."""
    yield b""
    yield content[:100]
    yield content[:-1] + bytes([content[-1] ^ 1])
    for data in (pickle.dumps(Planted()), b"x"):
        yield hashlib.sha256(data).digest() + data


def test_broken_files_are_told_and_made_anew(folder, caplog):
    table = load_lengths(**GIVEN)
    (path,) = folder.iterdir()
    whole = path.read_bytes()
    for content in broken(whole):
        path.write_bytes(content)
        with caplog.at_level(logging.WARNING):
            assert same(load_lengths(**GIVEN), table)
        assert "is broken" in caplog.text
        caplog.clear()
        assert path.read_bytes() == whole
    assert Planted.traces == ()


def test_without_a_place_for_files_tables_are_found_anew(monkeypatch, folder, caplog):
    monkeypatch.setattr(array_files, "find_home", lambda wanted: None)
    assert same(load_lengths(**GIVEN), find_lengths(**GIVEN))
    monkeypatch.undo()
    assert not folder.exists()


def test_what_cannot_be_kept_is_told(folder, caplog):
    folder.parent.mkdir(0o700, exist_ok=True)
    folder.write_text("a file in the way")
    find_home.cache_clear()
    with caplog.at_level(logging.WARNING):
        assert same(load_lengths(**GIVEN), find_lengths(**GIVEN))
    assert "cannot keep a file" in caplog.text


def test_the_newest_files_stay(folder, monkeypatch):
    monkeypatch.setattr(array_files, "_MOST_FILES", 3)
    for name, other in OTHERS.items():
        load_lengths(**GIVEN | {name: other})
    assert len(list(folder.iterdir())) == 3
