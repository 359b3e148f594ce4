"""A checkpoint runs no code, and a broken or crafted one is named in one line."""

import contextlib
import os
import pathlib
import random
import zipfile

import numpy as np
import pytest
import torch

from tests.support.trainings import words
from train import ppo
from train.sb3.tensor_files import read_plain

SMALL = {"scenario": "crossing-8", "worlds": 2, "layers": (4,), "hold_noise": 0}


def begun(folder) -> ppo.Run:
    """Return a run that has begun its first episodes."""
    run = ppo.Run(ppo.read_arguments(words(folder, **SMALL))[0])
    run.learner._setup_learn(0, None)
    return run


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> pathlib.Path:
    """Return the folder of a run with a checkpoint."""
    found = tmp_path_factory.mktemp("runs")
    begun(found).write_checkpoint()
    return found


@pytest.fixture(scope="module")
def fresh(folder) -> ppo.Run:
    """Return a run to restore, whose worlds have not begun."""
    return ppo.Run(ppo.read_arguments(words(folder, **SMALL))[0])


@pytest.fixture
def path(folder, fresh, tmp_path):
    """Return a copy of the checkpoint, from which the run would continue."""
    copied = tmp_path / "checkpoint.pt"
    copied.write_bytes((folder / "checkpoint.pt").read_bytes())
    kept, fresh.arguments = fresh.arguments, fresh.arguments.__class__(output=tmp_path)
    yield copied
    fresh.arguments = kept


def refusal(run, path) -> str:
    with pytest.raises(ValueError, match=r"^cannot go on from .*checkpoint\.pt: ") as told:
        run.go_on()
    return str(told.value)


def change(path, where, name, value):
    """Write another value into a dictionary of a checkpoint."""
    state = torch.load(path, weights_only=True)
    (state[where] if where else state)[name] = value
    torch.save(state, path)


class Planted:
    def __init__(self, call, *args):
        """Take the call that unpickling would make."""
        self.told = call, args

    def __reduce__(self):
        """Return the call."""
        return self.told


@pytest.mark.parametrize(
    "planted",
    [
        Planted(os.mkdir, "planted"),
        Planted(eval, "__import__('os').mkdir('planted')"),
        np.float64(1.0),
        np.zeros(3),
    ],
    ids=["call", "eval", "number of NumPy", "array of NumPy"],
)
@pytest.mark.parametrize("where", ["curve", "arrays", None])
def test_no_code_runs(planted, where, path, fresh, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    if where is None:
        torch.save(planted, path)
    else:
        state = torch.load(path, weights_only=True)
        torch.save(state | {where: planted}, path)
    assert "holds more than tensors, numbers and text" in refusal(fresh, path)
    assert not pathlib.Path("planted").exists()


def test_every_flipped_byte_and_every_cut_is_noticed(path, fresh):
    """PyTorch alone compares no checksums: a flipped bit of a weight would go on unnoticed."""
    whole, places = path.read_bytes(), random.Random(0)
    kept = flatten(read_plain(path))
    noticed = 0
    for number in range(60):
        place = places.randrange(len(whole))
        if number % 3:
            flipped = bytes([whole[place] ^ (1 << places.randrange(8))])
            path.write_bytes(whole[:place] + flipped + whole[place + 1 :])
        else:
            path.write_bytes(whole[:place])
        try:
            # names and dates of members may differ, a number may not
            assert flatten(read_plain(path)) == kept
        except (ValueError, RuntimeError):
            noticed += 1
    assert noticed > 30


def flatten(state):
    if isinstance(state, dict):
        return {key: flatten(value) for key, value in state.items()}
    return state.numpy().tobytes() if isinstance(state, torch.Tensor) else state


FAR = 10**9


@pytest.mark.parametrize(
    ("name", "make", "message"),
    [
        ("fleet.num_trailers", lambda a: a.fill_(FAR), "num_trailers holds"),
        ("nearby.count", lambda a: a.fill_(FAR), "nearby count holds"),
        ("nearby.index", lambda a: a.fill_(-1), "nearby index holds"),
        ("nearby.num_pairs", lambda a: a.fill_(FAR), "nearby num_pairs holds"),
        ("nearby.pair", lambda a: a.fill_(9), "nearby pair holds"),
        ("state.goal", lambda a: a.fill_(FAR), "goal holds"),
        ("state.goal", lambda a: a.fill_(np.nan), "goal holds"),
        ("state.x", lambda a: a.fill_(np.nan), "not finite"),
        ("state.x", lambda a: a[:1], "of shape"),
        ("state.x", lambda a: a.float(), "is float32"),
        ("state.x", lambda a: torch.zeros(1).expand(FAR, FAR), "of shape"),
        ("state.x", lambda a: a.to_sparse(), "cannot go on"),
        ("state.x", lambda a: "far", "it has no"),
    ],
)
def test_worlds_that_compiled_code_could_not_take_are_refused(name, make, message, path, fresh):
    name = f"worlds.{name}"
    change(path, "arrays", name, make(torch.load(path, weights_only=True)["arrays"][name]))
    assert message in refusal(fresh, path)


@pytest.mark.parametrize(
    ("where", "name", "value"),
    [
        ("numbers", "place", 625),
        ("numbers", "place", -1),
        ("numbers", "decisions", None),
        (None, "torch", torch.zeros(3, dtype=torch.uint8)),
        (None, "moments", {0: {"exp_avg": torch.zeros(7)}}),
        (None, "moments", {FAR: {}, 99: {"exp_avg": torch.zeros(7)}}),
        (None, "policy", {}),
        (None, "seconds", "long"),
        (None, "curve", "["),
        (None, "curve", "[" * 10**5),
        (None, "curve", '[{"mood": 1.0}]'),
        (None, "curve", '[{"score": "high"}]'),
        (None, "curve", "[3]"),
        (None, "curve", None),
        (None, "arrays", []),
    ],
    ids=str,
)
def test_contents_that_do_not_fit_are_named(where, name, value, path, fresh):
    change(path, where, name, value)
    assert len(refusal(fresh, path).splitlines()) == 1


def test_what_is_packed_is_not_unpacked(path, fresh):
    """A file of a megabyte could ask for a gigabyte."""
    with zipfile.ZipFile(path) as archive:
        kept = {member.filename: archive.read(member) for member in archive.infolist()}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in kept.items():
            archive.writestr(name, content)
    assert "packed" in refusal(fresh, path) or "larger" in refusal(fresh, path)


def test_worlds_go_on_bit_for_bit(path, folder, fresh):
    first = begun(folder)
    fresh.go_on()
    rng = np.random.default_rng(0)
    for _ in range(12):
        actions = rng.uniform(-1.0, 1.0, (first.env.num_envs, 2))
        for one, other in zip(
            first.env.step(actions)[:3], fresh.env.step(actions)[:3], strict=True
        ):
            assert one.tobytes() == other.tobytes()


def test_no_array_of_another_kind_is_taken(path, fresh):
    state = torch.load(path, weights_only=True)
    large = torch.zeros(1).expand(10**12)  # takes no memory in the file
    for name, array in state["arrays"].items():
        for bad in (array[..., None], large, array.to(torch.complex64), None, 3):
            torch.save(state | {"arrays": state["arrays"] | {name: bad}}, path)
            assert repr(name) in refusal(fresh, path)
    for name in state:
        for bad in (None, large, "moon", -(10**30)):
            torch.save(state | {name: bad}, path)
            with contextlib.suppress(ValueError):  # a number of seconds may be any
                fresh.go_on()


def test_a_run_begins_with_no_module(tmp_path, monkeypatch):
    """A run.json from a stranger may name any module that can be imported."""
    (tmp_path / "planted.py").write_text("raise AssertionError('it was imported')")
    monkeypatch.syspath_prepend(tmp_path)
    arguments, _ = ppo.read_arguments(words(tmp_path, **SMALL, begin_with="planted:Policy"))
    with pytest.raises(ValueError, match="begin_with is 'planted:Policy', but must be"):
        ppo.Run(arguments)
