"""The compile cache: only this user writes to it, and broken files in it are compiled again."""

import logging
import os
import pathlib
import pickle
import threading

import numba
import numpy as np
import pytest

from hav_env.compiled import disk_cache as kept_code
from hav_env.compiled.disk_cache import DiskCache, describe_type
from hav_env.compiled.kernels import ENTERED
from tests.support.budgets import COMPILED

compiled_only = pytest.mark.skipif(not COMPILED, reason="nothing is compiled, nothing is kept")


def fill(first, last, numbers):
    for k in range(first, last):
        numbers[k] = 3.0 * k


FLOATS = numba.typeof((0, 0, np.zeros(4))).types
SINGLES = numba.typeof((0, 0, np.zeros(4, np.float32))).types


def loaded(folder, kinds=FLOATS):
    """Compile or load ``fill``, see that it works, and return whether it was loaded."""
    loop = numba.njit(**ENTERED)(fill)
    loop._cache = DiskCache(fill, folder)
    loop.compile(kinds)
    numbers = np.zeros(4, np.float32 if kinds is SINGLES else float)
    loop(0, 4, numbers)
    assert numbers.tolist() == [0.0, 3.0, 6.0, 9.0]
    return bool(sum(loop.stats.cache_hits.values()))


@pytest.fixture
def kept(tmp_path):
    """Return a folder that holds the machine code of one signature."""
    assert not loaded(tmp_path / "kept")
    return tmp_path / "kept"


# broken files


def in_its_place(path):
    path.unlink()
    (path / "below").mkdir(parents=True)


BREAKS = {
    "empty": lambda path: path.write_bytes(b""),
    "cut": lambda path: path.write_bytes(path.read_bytes()[:-1]),
    "longer": lambda path: path.write_bytes(path.read_bytes() + b"\n"),
    "garbled": lambda path: path.write_bytes(bytes(reversed(path.read_bytes()))),
    "pickle of nothing": lambda path: path.write_bytes(pickle.dumps(None)),
    "folder": in_its_place,
    "link to nowhere": lambda path: (path.unlink(), path.symlink_to("nowhere")),
}


@compiled_only
@pytest.mark.parametrize("kind", ["nbi", "nbc"])
@pytest.mark.parametrize("how", BREAKS)
def test_what_is_broken_is_compiled_again_with_one_line(kind, how, kept, caplog):
    (path,) = kept.glob(f"*.{kind}")
    BREAKS[how](path)
    assert not loaded(kept)
    assert len(caplog.records) == 1
    assert "fill again" in caplog.text
    caplog.clear()
    assert loaded(kept)
    assert not caplog.records
    assert len(list(kept.iterdir())) == 2


@compiled_only
def test_data_that_are_gone_are_compiled_again(kept):
    next(kept.glob("*.nbc")).unlink()
    assert not loaded(kept)
    assert loaded(kept)


@compiled_only
def test_machine_code_with_a_flipped_byte_never_runs(kept):
    (path,) = kept.glob("*.nbc")
    whole = path.read_bytes()
    for place in range(0, len(whole), len(whole) // 20):
        changed = bytes([whole[place] ^ 1])
        path.write_bytes(whole[:place] + changed + whole[place + 1 :])
        assert not loaded(kept)
        (path,) = kept.glob("*.nbc")
        whole = path.read_bytes()


class Gone:
    """A class that a file names and that no longer exists."""


@compiled_only
def test_a_class_that_is_no_more_is_compiled_again(kept, monkeypatch, caplog):
    (index,), (data,) = kept.glob("*.nbi"), kept.glob("*.nbc")
    content = pickle.dumps(Gone())
    digest = kept_code.hashlib.sha256(content).hexdigest()
    data.unlink()
    kept_code._data(index, digest).write_bytes(content)
    index.write_text(digest)
    monkeypatch.delattr(f"{__name__}.Gone")
    assert not loaded(kept)
    assert "Gone" in caplog.text
    assert loaded(kept)


class Planted:
    def __reduce__(self):
        """Return the call that unpickling makes."""
        return pathlib.Path.touch, (pathlib.Path("planted"),)


@compiled_only
@pytest.mark.parametrize("kind", ["nbi", "nbc"])
def test_no_file_is_unpickled_that_was_not_written_here(kind, kept, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    (path,) = kept.glob(f"*.{kind}")
    path.write_bytes(pickle.dumps(Planted()))
    assert not loaded(kept)
    assert not pathlib.Path("planted").exists()


# several processes, full disks


@compiled_only
def test_signatures_do_not_take_each_others_files(tmp_path):
    callers = [
        threading.Thread(target=loaded, args=(tmp_path / "kept", kinds))
        for kinds in (FLOATS, SINGLES) * 2
    ]
    for caller in callers:
        caller.start()
    for caller in callers:
        caller.join()
    assert loaded(tmp_path / "kept", FLOATS)
    assert loaded(tmp_path / "kept", SINGLES)


@compiled_only
@pytest.mark.parametrize("name", ["replace", "open"])
def test_a_full_disk_is_said_in_one_line(name, tmp_path, monkeypatch, caplog):
    def fail(*args):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(kept_code, "open", fail, raising=False) if name == "open" else (
            patch.setattr(kept_code.os, "replace", fail)
        )
        assert not loaded(tmp_path / "kept")
    assert [record.levelno for record in caplog.records] == [logging.WARNING]
    assert "No space left" in caplog.text
    assert not list((tmp_path / "kept").iterdir())


@compiled_only
def test_what_killed_processes_left_behind_is_removed(tmp_path):
    (tmp_path / "kept").mkdir()
    old, new = tmp_path / "kept/old.unfinished", tmp_path / "kept/new.unfinished"
    for path in (old, new):
        path.write_text("half")
    os.utime(old, (0, 0))
    assert not loaded(tmp_path / "kept")
    assert not old.exists()
    assert new.exists()


def test_types_are_told_apart_by_module_and_fields():
    def made(name, fields, module):
        from collections import namedtuple

        model = namedtuple(name, fields, module=module)
        return describe_type(numba.typeof(model(1.0, (2.0,))))

    told = {made("A", "x y", "m"), made("A", "x z", "m"), made("A", "x y", "n")}
    assert len(told) == 3
    assert made("A", "x y", "m") in told
    assert "0x" not in "".join(told)


# the folder
