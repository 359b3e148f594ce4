"""Untrusted policy and trajectory files are rejected in a second, in one line, without memory."""

import json
import os
import subprocess
import sys
import zipfile

import numpy as np
import pytest

from baselines.policies.dubins_pursuit import DubinsPursuit
from baselines.policies.files import load_trained, save_policy
from baselines.policies.network_checks import LARGEST_WEIGHT, WIDEST_LAYER, check_network
from baselines.replay.trajectory import record_trajectory
from baselines.replay.trajectory_files import load_trajectory, save_trajectory
from hav_env import RandomPoses, Task
from tests.support.budgets import budget
from tests.support.networks import forward, random_network
from tests.support.paths import ROOT
from tests.support.strangers import archive, bomb, claim, garble, head

pytestmark = pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="needs Linux")


def arrays_in(path):
    with np.load(path) as kept:
        return {name: kept[name] for name in kept.files}


def opened(folder):
    """Open all files of a folder in a separate process; return its output and its duration."""
    done = subprocess.run(
        [sys.executable, "-m", "tests.support.strangers", str(folder)],
        capture_output=True,
        check=False,
        text=True,
        timeout=300,
        env=os.environ | {"PYTHONPATH": str(ROOT), "NUMBA_DISABLE_JIT": "1"},
    )
    assert done.returncode == 0, done.stderr[-2_000:]
    return [json.loads(line) for line in done.stdout.splitlines()]


@pytest.fixture(scope="module")
def policy(tmp_path_factory):
    path = tmp_path_factory.mktemp("policies") / "good.policy"
    save_policy(random_network(), path, {"algorithm": "chance"})
    return path


@pytest.fixture(scope="module")
def trajectory(tmp_path_factory):
    path = tmp_path_factory.mktemp("trajectories") / "good.npz"
    save_trajectory(
        record_trajectory(DubinsPursuit(), RandomPoses(2), 0, 5, Task(max_steps=4)), path
    )
    return path


NUMBERS = [-1, 10**4, 10**7, 10**30, 2.5, 1e300, True, None, "10", [], {}]
HUGE = [
    (10**12,),
    (2**62, 4),
    (2**63,),
    (2**64 + 1,),
    (-1,),
    (-(10**9), -1),
    (0, 10**30),
    (1,) * 40,
]
TYPES = ["|O", "<c16", "<U9999999", "|S10", "|b1", "<M8[s]", "|V8", [("a", "<f4")], "<f4, <f4"]


def layouts(arrays):
    """Yield layouts with every number and flag in it replaced."""
    layout = json.loads(str(arrays["layout"]))
    for value in NUMBERS:
        for name in ("max_trailers", "frame_skip", "limit", "columns"):
            if (name, value) not in (
                ("limit", 10**4),
                ("limit", 10**7),
                ("limit", 10**30),
                ("limit", 2.5),
                ("limit", 1e300),
                ("frame_skip", 10**4),
            ):
                yield layout | {name: value}
        for name in layout["observation"]:
            # most others are flags; a range of 2.5 m is one
            if (name == "neighbors" or value is not True) and (name, value) != ("ray_range", 2.5):
                yield layout | {"observation": layout["observation"] | {name: value}}
        if value != {}:  # all fields have defaults
            yield layout | {"observation": value}
    yield layout | {"observation": {"neighbors": 1_000, "chains": True}, "max_trailers": 1_000}


def shapes_and_types(arrays):
    """Yield arrays with every member replaced by an invalid one."""
    for name in arrays:
        for shape in HUGE:
            yield {name: head(shape) + bytes(64)}
            yield {name: head(shape, "<i8", True)}
        for descr in TYPES:
            yield {name: head((4,), descr) + bytes(64)}
        yield {name: np.full((3, 3, 3, 3), 7)}
        yield {name: b"\x93NUMPY\x02\x00" + b"\xff" * 4}
        yield {name: b"\x93NUMPY\x01\x00\xff\xff" + b"(" * 65_535}
        yield {name: b""}


def numbers(arrays):
    """Yield policies whose sizes wrap around, whose arrays do not fit or are not finite."""
    columns = int(arrays["sizes"][0])
    for sizes in (
        [columns, 2**32, 2**32, 2], [columns, 2**62, 4, 2], [columns, 2**61, 2], [columns, -8, 2],
        [columns, 0, 2], [columns], [], [2, 2], [columns, 8, 3], [columns, 10**6, 2],
        [columns] + [8] * 40 + [2], [columns, WIDEST_LAYER, WIDEST_LAYER, 2], [[columns, 8, 2]],
        [float(columns), 8.0, 2.0],
    ):  # fmt: skip
        yield {"sizes": np.array(sizes)}
    for name in ("weights", "mean", "scale"):
        good = arrays[name]
        for bad in (np.nan, np.inf, -np.inf, 1e13, -3e38):
            yield {name: np.where(np.arange(good.size) == 1, bad, good)}
        yield {name: good[:-1]}
        yield {name: np.append(good, 0.0)}
        yield {name: good[None]}
        yield {name: good.astype(int)}


def test_no_crafted_policy_is_taken(policy, tmp_path):
    arrays = arrays_in(policy)
    changes = [{"layout": np.array(json.dumps(layout))} for layout in layouts(arrays)]
    changes += [*shapes_and_types(arrays), *numbers(arrays)]
    for number, change in enumerate(changes):
        archive(tmp_path / f"{number:04}.policy", (arrays | change).items())
    every = opened(tmp_path)
    assert len(every) == len(changes) > 200
    for (name, said, seconds), change in zip(every, changes, strict=True):
        assert name in said, change
        assert len(said.splitlines()) == 1, said
        assert len(said) < 1_000, said
        assert seconds < 1.0, change


def test_no_crafted_trajectory_is_taken(trajectory, tmp_path):
    arrays = arrays_in(trajectory)
    names = ("kind", "step", "x", "heading", "num_trailers", "goals", "first", "dt")
    changes = list(shapes_and_types({name: arrays[name] for name in names}))
    for name in ("step", "phase", "num_trailers", "first", "hit_step", "evaded"):
        changes += [{name: np.full_like(arrays[name], value)} for value in (10**18, -(10**18))]
    for name in ("speed", "steering"):
        changes += [{name: np.full_like(arrays[name], value)} for value in (1e300, -np.inf)]
    for name in ("x", "heading", "goals", "length", "dt", "footprint"):
        changes += [{name: np.full_like(arrays[name], value)} for value in (1e300, np.nan)]
    for number, change in enumerate(changes):
        archive(tmp_path / f"{number:04}.npz", (arrays | change).items())
    every = opened(tmp_path)
    assert len(every) == len(changes) > 200
    for (name, said, seconds), change in zip(every, changes, strict=True):
        assert name in said, change
        assert len(said.splitlines()) == 1, said
        assert seconds < 1.0, change


@pytest.mark.parametrize("suffix", [".policy", ".npz"])
def test_no_crafted_archive_is_taken(suffix, policy, trajectory, tmp_path):
    good = policy if suffix == ".policy" else trajectory
    arrays = arrays_in(good)
    name = "weights" if suffix == ".policy" else "x"
    target = tmp_path / "files"
    target.mkdir()
    bomb(target / f"bomb{suffix}", arrays, name)
    archive(target / f"many{suffix}", [*arrays.items(), *((f"m{k}", b"") for k in range(5_000))], 0)
    with pytest.warns(UserWarning, match="Duplicate"):
        archive(target / f"double{suffix}", [*arrays.items(), (name, arrays[name])])
    for kind in (zipfile.ZIP_LZMA, zipfile.ZIP_BZIP2):
        archive(target / f"packed{kind}{suffix}", arrays.items(), kind)
    for size in (0, 10, 1 << 20, 2**32 - 2):
        archive(target / f"claim{size}{suffix}", arrays.items())
        claim(target / f"claim{size}{suffix}", name, size)
    archive(target / f"less{suffix}", list(arrays.items())[1:])
    every = opened(target)
    assert len(every) == 10
    for file, said, seconds in every:
        assert file in said
        assert seconds < 1.0, file


@pytest.mark.parametrize("suffix", [".policy", ".npz"])
def test_no_garbled_file_takes_time_memory_or_more_than_a_line(
    suffix, policy, trajectory, tmp_path
):
    rng = np.random.default_rng(7)
    good = policy if suffix == ".policy" else trajectory
    for number in range(budget(300, 100)):
        (tmp_path / f"{number}{suffix}").write_bytes(garble(good.read_bytes(), rng))
    every = opened(tmp_path)
    assert len(every) == budget(300, 100)
    assert sum(bool(said) for _, said, _ in every) > len(every) // 2
    assert all(seconds < 1.0 for *_, seconds in every)


def test_arrays_in_another_order_are_the_same(policy, trajectory, tmp_path):
    for good, load in ((policy, load_trained), (trajectory, load_trajectory)):
        arrays = arrays_in(good)
        swapped = {
            name: array
            if not array.ndim
            else np.asfortranarray(array.astype(array.dtype.newbyteorder(">")))
            for name, array in arrays.items()
        }
        archive(tmp_path / good.name, swapped.items())
        assert repr(load(tmp_path / good.name)) == repr(load(good))


def test_no_policy_that_is_taken_acts_by_nan():
    """The largest weights of alternating sign, the largest limit: no sum becomes inf - inf."""
    policy = random_network(hidden=(64, 64))
    signs = np.where(np.arange(policy.weights.size) % 2, -LARGEST_WEIGHT, LARGEST_WEIGHT)
    extreme = policy._replace(
        weights=signs,
        mean=np.full_like(policy.mean, -LARGEST_WEIGHT),
        scale=np.full_like(policy.scale, LARGEST_WEIGHT),
        limit=float(np.finfo(float).max),
    )
    check_network(extreme)
    rows = np.random.default_rng(0).uniform(-1.0, 10.0, (20, policy.sizes[0]))
    assert np.isfinite(forward(extreme, rows)).all()
    with np.errstate(all="ignore"):
        beyond = forward(extreme._replace(weights=np.sign(signs) * 1e300), rows)
    assert not np.isfinite(beyond).all()


def test_the_largest_sizes_do_not_wrap_around():
    policy = random_network()
    wrapping = np.array([policy.sizes[0], 2**32, 2**32, 2])
    with pytest.raises(ValueError, match="sizes"):
        check_network(policy._replace(sizes=wrapping))
