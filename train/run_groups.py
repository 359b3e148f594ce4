"""This module finds the runs of several training seeds that form one group of a comparison."""

import glob
import json
import pathlib
from typing import Any, NamedTuple

from baselines.policies.files import load_policy
from baselines.storage.atomic_files import read_object
from hav_env import OnAxle, Task
from hav_env.policies.filtered import filter_policy
from train.runs import DESCRIPTION
from train.seeds import seeds_of

_MAY_DIFFER = ("seed", "output", "threads")  # the arguments in which the runs of a group may differ


class TrainedRun(NamedTuple):
    """A run that has written a policy."""

    folder: pathlib.Path
    arguments: dict[str, Any]
    policy: Any
    """The best policy of the run, with the safety filter of its training."""
    curve: list[dict[str, Any]]
    """The evaluations during the training."""


def find_group(pattern: str) -> dict[str, list[TrainedRun]]:
    """Return the runs that a pattern matches, by scenario and in the order of their seeds.

    Args:
        pattern: A pattern of folders, such as ``runs/single/seed-*``; the folder of a set stands
            for all of its runs.

    Raises:
        ValueError: If there is no run, a run has no policy yet, or runs of a scenario differ in
            more than their seeds or share a seed.
    """
    folders = [
        run
        for found in map(pathlib.Path, sorted(glob.glob(pattern)))
        for run in [found / f"seed-{seed}" for seed in seeds_of(found)] or [found]
    ]
    runs = [_read(folder) for folder in folders]
    if not runs:
        raise ValueError(f"runs has {pattern!r}, which matches no folder")
    group: dict[str, list[TrainedRun]] = {}
    for run in sorted(runs, key=lambda run: run.arguments["seed"]):
        group.setdefault(run.arguments["scenario"], []).append(run)
    for of_one in group.values():
        _check_alike(pattern, of_one)
    return group


def _read(folder: pathlib.Path) -> TrainedRun:
    path = folder / "best.policy"
    if not (folder / DESCRIPTION).is_file() or not path.is_file():
        raise ValueError(f"runs has {folder}, but it is no run that has a best.policy yet")
    arguments = read_object(folder / DESCRIPTION).get("arguments")
    if not isinstance(arguments, dict) or not {"seed", "scenario"} <= set(arguments):
        raise ValueError(f"{folder / DESCRIPTION} is broken: it holds no seed or no scenario")
    guidance = arguments.get("guidance", "dubins")
    if guidance != "dubins":
        told = f"runs has {folder}, whose guidance is {guidance!r}, but must be 'dubins'"
        raise ValueError(f"{told}: comparisons have no other")
    curve = folder / "curve.json"
    told = json.loads(curve.read_text()) if curve.is_file() else []
    driver = filter_policy(load_policy(path), arguments.get("safety"), Task(), OnAxle())
    return TrainedRun(folder, arguments, driver, told)


def _check_alike(pattern: str, runs: list[TrainedRun]) -> None:
    first = runs[0].arguments
    for run in runs[1:]:
        names = [name for name in {**first, **run.arguments} if name not in _MAY_DIFFER]
        other = [name for name in names if first.get(name) != run.arguments.get(name)]
        if other:
            told = f"{runs[0].folder} and {run.folder} have another {', '.join(other)}"
            raise ValueError(f"runs has {pattern!r}, but {told}: name them apart")
    seeds = [run.arguments["seed"] for run in runs]
    twice = sorted({seed for seed in seeds if seeds.count(seed) > 1})
    if twice:
        raise ValueError(f"runs has {pattern!r}, which matches seed {twice[0]} more than once")
