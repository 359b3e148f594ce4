"""This module writes and reads the folder of a training run: arguments and versions."""

import importlib.metadata
import json
import os
import pathlib
import platform
import subprocess
from typing import Any, TypeVar

import hav_env
from baselines.policies.files import load_trained
from baselines.policies.shipped import policy_file
from baselines.storage.atomic_files import read_object, write_text
from baselines.storage.locks import LOCK
from hav_env.models.names import REGISTRIES
from train.checks import CHOSEN

DESCRIPTION = "run.json"
Arguments = TypeVar("Arguments")
_PACKAGES = ("gymnasium", "numba", "numpy", "pettingzoo", "ray", "stable-baselines3", "torch")


def begin_run(folder: pathlib.Path, arguments: dict[str, Any]) -> None:
    """Make the folder of a new run, and write its arguments and versions.

    Raises:
        ValueError: If the folder is not empty.
        OSError: If the folder cannot be made or is not writable.
    """
    if folder.exists() and not (folder.is_dir() and {p.name for p in folder.iterdir()} <= {LOCK}):
        raise ValueError(f"{folder} exists and is not empty: choose another --output, or --resume")
    folder.mkdir(parents=True, exist_ok=True)
    told = {"arguments": arguments, **versions()}
    write_text(json.dumps(told, indent=2) + "\n", folder / DESCRIPTION)


def read_run(folder: pathlib.Path, needed: str) -> dict[str, Any]:
    """Return the arguments of a run to resume.

    Args:
        folder: The folder of the run.
        needed: Name of the file from which the run resumes.

    Raises:
        ValueError: If this is no run, or the run has no such file yet.
        PermissionError: If the folder is not writable.
    """
    description = folder / DESCRIPTION
    if not description.is_file():
        raise ValueError(f"{folder} is no training run: it has no {DESCRIPTION}")
    if not (folder / needed).is_file():
        raise ValueError(f"{folder} has no {needed} yet: begin it anew in another folder")
    if not os.access(folder, os.W_OK):
        raise PermissionError(f"the folder {folder} cannot be written to")
    arguments = read_object(description).get("arguments")
    if not isinstance(arguments, dict):
        raise ValueError(f"{description} is broken: it holds no arguments")
    return arguments


def plain(arguments: Any) -> dict[str, Any]:
    """Return a dataclass of arguments as values for JSON."""

    def told(name: str, value: Any) -> Any:
        if name in CHOSEN:
            return _describe_model(value)
        if hasattr(value, "_asdict"):
            return value._asdict()
        return str(value) if isinstance(value, pathlib.Path) else value

    return {name: told(name, value) for name, value in vars(arguments).items()}


def restore(arguments_class: type[Arguments], told: dict[str, Any]) -> Arguments:
    """Return the arguments from their values in JSON, as ``plain`` returned them.

    Raises:
        ValueError: If they are not the arguments of this class.
    """
    usual = vars(arguments_class())
    try:
        different = set(usual) ^ set(told)
        if different:
            raise ValueError(", ".join(map(repr, sorted(different))))
        return arguments_class(
            **{name: _read_as(usual[name], name, value) for name, value in told.items()}
        )
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"the run has other arguments than this version: {error}") from None


def _read_as(usual: Any, name: str, value: Any) -> Any:
    """Return a value of JSON with the type of the default value of the argument.

    Raises:
        TypeError: If it has another type.
    """
    if name in CHOSEN and isinstance(value, dict) and isinstance(value.get("class"), str):
        return _read_model(name, value)
    if hasattr(usual, "_asdict"):
        if not isinstance(value, dict) or set(value) != set(usual._fields):
            raise TypeError(f"{name} is {value!r}, but must have the fields {usual._fields}")
        fields = {field: _read_as(getattr(usual, field), field, value[field]) for field in value}
        return type(usual)(**fields)
    if isinstance(usual, tuple):
        if not isinstance(value, list):
            raise TypeError(f"{name} is {value!r}, but must be a list")
        return tuple(_read_as(usual[0], name, one) for one in value)
    if usual is None:
        kinds: tuple[type, ...] = (str, type(None))
    elif isinstance(usual, float):
        kinds = (float, int)
    else:
        kinds = (str,) if isinstance(usual, pathlib.Path) else (type(usual),)
    if not isinstance(value, kinds) or isinstance(value, bool) is not isinstance(usual, bool):
        raise TypeError(f"{name} is {value!r}, but must be of type {type(usual).__name__}")
    return value if usual is None else type(usual)(value)


def _describe_model(model: Any) -> dict[str, Any]:
    """Return the class of a model and its parameters as values for JSON."""
    model_class = type(model)
    fields = {
        name: _describe_model(value) if hasattr(value, "_asdict") else value
        for name, value in model._asdict().items()
    }
    return {"class": f"{model_class.__module__}:{model_class.__qualname__}", **fields}


def _read_model(kind: str, told: dict[str, Any]) -> Any:
    """Return the model of a description by ``_describe_model``.

    Raises:
        ValueError: If there is no such class.
        TypeError: If the class has other parameters.
    """
    parameters = {
        name: _read_model(name, value) if name in REGISTRIES and isinstance(value, dict) else value
        for name, value in told.items()
        if name != "class"
    }
    found = REGISTRIES[kind].find(told["class"])
    if set(found._fields) != set(parameters):
        raise TypeError(f"{kind} is {told!r}, but must have the fields {found._fields}")
    return REGISTRIES[kind].make(found, **parameters)


def about_of(name: str) -> dict[str, Any]:
    """Return the origin of a trained policy, without its curve; empty for no policy."""
    path = policy_file(name)
    about = load_trained(path).about if path else {}
    return {key: value for key, value in about.items() if key != "curve"}


def versions() -> dict[str, Any]:
    """Return the versions and the machine that influence a training beside its arguments."""
    found = {}
    for package in _PACKAGES:
        try:
            found[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            continue
    return {
        "hav_env": hav_env.__version__,
        "revision": _revision(),
        "python": platform.python_version(),
        "machine": platform.machine(),
        "packages": found,
    }


def _revision() -> str:
    """Return the git revision of the working tree, with a + after changes; "" without git."""
    here = pathlib.Path(__file__).parent

    def git(*words: str) -> str:
        done = subprocess.run(["git", *words], cwd=here, capture_output=True, text=True, check=True)
        return done.stdout.strip()

    try:
        changed = git("status", "--porcelain", "--untracked-files=no")
        return git("rev-parse", "HEAD") + ("+" if changed else "")
    except (OSError, subprocess.CalledProcessError):
        return ""
