"""Road networks on disk are found again, never mixed up, and broken ones are built again."""

import logging
import threading

import numpy as np
import pytest

from hav_env.guidance import Roads
from hav_env.guidance.array_files import keep_arrays, read_arrays
from hav_env.guidance.roads import files
from hav_env.guidance.roads.networks import build_networks
from tests.guidance.test_roads import vehicle_of

VEHICLE = vehicle_of("terminal-tractor")
GIVEN = {
    "roads": Roads(),
    "walls": np.array([[0.0, 6.0, 90.0, 6.0]]),
    "poses": np.array([[10.0, 0.0, 0.0, 0.0], [70.0, 0.0, 0.0, 0.0]]),
    "joins": np.array([[False, True], [False, False], [False, False]]),
    "vehicles": [VEHICLE],
    "bounds": (0.0, -10.0, 90.0, 10.0),
}
OTHERS = {
    "roads": Roads(clearance=0.3),
    "walls": GIVEN["walls"] + 0.25,
    "poses": GIVEN["poses"] + [[0.0, 0.0, 0.0, 0.0], [0.5, 0.0, 0.0, 0.0]],
    "joins": np.array([[False, True], [True, False], [False, False]]),
    "vehicles": [VEHICLE._replace(shape=VEHICLE.shape * 1.01)],
    "bounds": (0.0, -10.0, 90.0, 10.5),
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    home = tmp_path / "home"
    build_networks(**GIVEN)  # compiles; its code goes to the folder that all tests share
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(home))
    return home / "roads"


def leaves(value):
    """Return the arrays and numbers of networks, with the types of all."""
    if isinstance(value, tuple):
        return [leaf for part in value for leaf in leaves(part)]
    return [(type(value), getattr(value, "dtype", None), np.asarray(value).tolist())]


def refuse(*args):
    raise AssertionError("it is built again")


def test_kept_networks_are_the_same_and_are_not_built_again(folder, monkeypatch):
    networks = files.load_networks(**GIVEN)
    assert np.isfinite(networks.left[0, 0, 1])
    assert leaves(networks) == leaves(build_networks(**GIVEN))
    assert len(list(folder.iterdir())) == 1
    monkeypatch.setattr(files, "build_networks", refuse)
    assert leaves(files.load_networks(**GIVEN)) == leaves(networks)


def test_each_thing_that_determines_networks_has_a_file_of_its_own(folder):
    files.load_networks(**GIVEN)
    for count, (name, other) in enumerate(OTHERS.items(), start=2):
        given = GIVEN | {name: other}
        assert leaves(files.load_networks(**given)) == leaves(build_networks(**given))
        assert len(list(folder.iterdir())) == count


def test_other_code_has_a_file_of_its_own(folder, monkeypatch):
    files.load_networks(**GIVEN)
    monkeypatch.setattr(files, "_digest_code", lambda: "of another version")
    files.load_networks(**GIVEN)
    assert len(list(folder.iterdir())) == 2


def test_damaged_files_are_named_and_networks_built_anew(folder, caplog):
    networks = files.load_networks(**GIVEN)
    (path,) = folder.iterdir()
    whole = path.read_bytes()
    half = len(whole) // 2
    other = whole[:half] + bytes([whole[half] ^ 1]) + whole[half + 1 :]
    for content in (b"", whole[:half], other, whole + b"x"):
        path.write_bytes(content)
        with caplog.at_level(logging.WARNING):
            assert leaves(files.load_networks(**GIVEN)) == leaves(networks)
        assert f"{path} is broken" in caplog.text
        caplog.clear()
        assert path.read_bytes() == whole


def test_readers_see_whole_files_while_others_write(tmp_path):
    """Four writers and two readers use one path; each file holds its own number alone."""
    path, seen, done = tmp_path / "folder" / "key.arrays", [], threading.Event()

    def write(number):
        for _ in range(20):
            keep_arrays(path, {"a": np.full(50_000, number), "b": np.array(number)})

    def read():
        while not done.is_set():
            arrays = read_arrays(path, ("a", "b"))
            if arrays is not None:
                seen.append(bool((arrays["a"] == arrays["b"]).all()))

    readers = [threading.Thread(target=read) for _ in range(2)]
    writers = [threading.Thread(target=write, args=(number,)) for number in range(4)]
    for thread in readers + writers:
        thread.start()
    for thread in writers:
        thread.join()
    done.set()
    for thread in readers:
        thread.join()
    assert seen
    assert all(seen)
    assert [file.name for file in path.parent.iterdir()] == [path.name]
