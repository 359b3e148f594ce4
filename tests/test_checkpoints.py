"""A checkpoint holds numbers and text: whoever wrote it, reading it runs no code."""

import pathlib
import zipfile

import numpy as np
import pytest
import torch
from probes.strangers import garble
from probes.trainings import words

from train import ppo


@pytest.fixture
def run(tmp_path):
    """Return a run that has written a checkpoint, and nothing else."""
    begun = ppo.Run(ppo.read_arguments(words(tmp_path / "run"))[0])
    (tmp_path / "run").mkdir()
    begun.curve.append({"score": float("nan"), "hours": 0.1})
    begun.write_checkpoint()
    return begun


def path_of(run):
    return run.arguments.output / ppo.CHECKPOINT


def refused(run, path):
    with pytest.raises(ValueError, match="cannot go on from") as told:
        run.go_on()
    assert len(str(told.value).splitlines()) == 1
    assert str(path) in str(told.value)
    return str(told.value)


def test_another_run_goes_on_with_the_same_numbers(run, tmp_path):
    other = ppo.Run(ppo.read_arguments(words(tmp_path / "run", seed=7))[0])
    other.go_on()
    assert repr(other.curve) == repr(run.curve)
    rows = [learner.learner._last_obs for learner in (run, other)]
    assert np.array_equal(*rows)
    first, second = (begun.env.unwrapped.arrays() for begun in (run, other))
    assert set(first) == set(second)
    assert all(np.array_equal(first[name], second[name], equal_nan=True) for name in first)


class Planted:
    def __reduce__(self):
        return pathlib.Path.touch, (pathlib.Path("planted"),)


@pytest.mark.parametrize("place", ["more", "numpy", "policy", "whole"])
def test_reading_a_checkpoint_runs_no_code(place, run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    state = torch.load(path_of(run), weights_only=True)
    torch.save(Planted() if place == "whole" else state | {place: Planted()}, path_of(run))
    assert "holds more than numbers" in refused(run, path_of(run))
    assert not pathlib.Path("planted").exists()


def test_numbers_that_are_not_of_this_run_are_named(run):
    state = torch.load(path_of(run), weights_only=True)
    arrays = state["arrays"]
    large = torch.zeros(1).expand(10**12)  # takes no memory in the file
    for name, array in arrays.items():
        for bad in (array[..., None], large, array.to(torch.complex64)):
            torch.save(state | {"arrays": arrays | {name: bad}}, path_of(run))
            assert name in refused(run, path_of(run))
    for name in state:
        for bad in (None, large, [], {}, "moon"):
            torch.save(state | {name: bad}, path_of(run))
            refused_or_taken(run)


def refused_or_taken(run):
    """What is of another type is refused, or does not matter; nothing else is raised."""
    try:
        run.go_on()
    except ValueError as error:
        assert len(str(error).splitlines()) == 1  # noqa: PT017


def test_garbled_and_packed_checkpoints_are_one_line(run):
    whole, rng = path_of(run).read_bytes(), np.random.default_rng(3)
    for _ in range(60):
        path_of(run).write_bytes(garble(whole, rng))
        refused_or_taken(run)
    path_of(run).write_bytes(whole)
    with zipfile.ZipFile(path_of(run)) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(path_of(run), "w", zipfile.ZIP_DEFLATED) as archive:
        for name, part in parts.items():
            archive.writestr(name, part)
    assert "it is packed" in refused(run, path_of(run))
