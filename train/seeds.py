"""This module trains a set of runs that differ in their seeds: ``--seeds 0 1 2``.

The folder of a set holds ``run.json``, with ``seeds`` in place of ``seed``, and the folders of the
runs, ``seed-0``, ``seed-1``, ... ``--resume`` resumes the whole set.
"""

import dataclasses
import pathlib
from collections.abc import Callable, Sequence
from typing import Any

from baselines.storage.atomic_files import read_object
from baselines.storage.locks import LOCK, sole_user
from hav_env.maths.random_numbers import Seed
from hav_env.models.checks import check_value
from train.runs import DESCRIPTION, begin_run, plain, read_run

_OPTION = "--seeds"


def take_seeds(words: list[str]) -> tuple[tuple[int, ...], list[str]]:
    """Take ``--seeds A B ...`` out of a command line.

    Returns:
        The seeds, none without the option; the other words.

    Raises:
        ValueError: If there are not at least two different seeds, or with ``--seed`` or
            ``--resume``.
    """
    if _OPTION not in words:
        return (), words
    place = words.index(_OPTION)
    end = next((k for k in range(place + 1, len(words)) if words[k].startswith("--")), len(words))
    told, others = words[place + 1 : end], words[:place] + words[end:]
    options = {word.partition("=")[0] for word in others}
    if "--resume" in options:
        raise ValueError(f"--resume goes on as the run began, and knows no {_OPTION}")
    if "--seed" in options:
        raise ValueError(f"--seed is of one run and {_OPTION} of several: name one of them")
    try:
        seeds = tuple(map(int, told))
    except ValueError:
        raise ValueError(f"seeds is {' '.join(told)}, but must be whole numbers") from None
    for seed in seeds:
        check_value("seeds", Seed, seed)
    if len(set(seeds)) < 2 or len(set(seeds)) < len(seeds):
        shown = " ".join(told) or "empty"
        raise ValueError(f"seeds is {shown}, but must be two different ones or more, see --seed")
    return seeds, others


def seeds_of(folder: pathlib.Path) -> tuple[int, ...]:
    """Return the seeds of the set in a folder; none without a set.

    Raises:
        ValueError: If the description of the set is broken.
    """
    path = folder / DESCRIPTION
    told = read_object(path).get("arguments") if path.is_file() else None
    seeds = told.get("seeds", []) if isinstance(told, dict) else []
    if not isinstance(seeds, list) or not all(type(seed) is int for seed in seeds):
        raise ValueError(f"{path} is broken: seeds is {seeds!r}")
    return tuple(seeds)


def read_begun(folder: pathlib.Path, needed: str) -> dict[str, Any]:
    """Return the arguments of a run or a set to resume; those of a set have its first seed.

    Args:
        folder: The folder of the run or the set.
        needed: Name of the file from which a run resumes.

    Raises:
        ValueError, PermissionError: As in ``read_run``.
    """
    seeds = seeds_of(folder)
    if not seeds:
        return read_run(folder, needed)
    told = read_run(folder, DESCRIPTION)
    del told["seeds"]
    return {**told, "seed": seeds[0]}


def train_set(
    arguments: Any,
    seeds: Sequence[int],
    resumed: bool,
    needed: str,
    train_run: Callable[[Any, bool], None],
) -> None:
    """Train a run for each seed, one after the other; skip finished runs, resume unfinished ones.

    Args:
        arguments: A dataclass of the arguments of all runs, with the folder of the set.
        seeds: The seeds of the runs.
        resumed: Whether the set has begun.
        needed: Name of the file from which a run resumes. A run without it begins anew.
        train_run: Function of the arguments of a run, and of whether the run resumes.

    Raises:
        ValueError, OSError: As in ``begin_run``.
    """
    folder = arguments.output
    with sole_user(folder):
        if not resumed:
            told = plain(arguments)
            del told["seed"]
            begin_run(folder, {"seeds": list(seeds), **told})
        for seed in seeds:
            run = dataclasses.replace(arguments, seed=seed, output=folder / f"seed-{seed}")
            goes_on = (run.output / needed).is_file()
            if not goes_on:
                _clear(run.output)
            train_run(run, goes_on)


def _clear(folder: pathlib.Path) -> None:
    """Remove the files of a run that was interrupted before its first checkpoint."""
    with sole_user(folder):
        if (folder / DESCRIPTION).is_file():
            for path in folder.iterdir():
                if path.name != LOCK:
                    path.unlink()
