"""The folder of a training run: what made it, and files that are whole or not there."""

import importlib.metadata
import json
import os
import pathlib
import platform
import subprocess
from typing import Any, TypeVar

import hav_env
from baselines.files import write_text
from baselines.policy_files import load_trained
from baselines.registry import policy_file

DESCRIPTION = "run.json"
Arguments = TypeVar("Arguments")
_PACKAGES = ("gymnasium", "numba", "numpy", "pettingzoo", "ray", "stable-baselines3", "torch")


def begin_run(folder: pathlib.Path, arguments: dict[str, Any]) -> None:
    """Make the folder of a new run, and write down what makes it.

    Raises:
        ValueError: when the folder holds something.
        OSError: when it cannot be made or written to.
    """
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise ValueError(f"{folder} exists and is not empty: choose another --output, or --resume")
    folder.mkdir(parents=True, exist_ok=True)
    told = {"arguments": arguments, **versions()}
    write_text(json.dumps(told, indent=2) + "\n", folder / DESCRIPTION)


def read_run(folder: pathlib.Path, needed: str) -> dict[str, Any]:
    """Return the arguments of a run that is to go on.

    Args:
        folder: of the run.
        needed: name of the file to go on from.

    Raises:
        ValueError: when this is no run, or it has not come as far as its first checkpoint.
    """
    description = folder / DESCRIPTION
    if not description.is_file():
        raise ValueError(f"{folder} is no training run: it has no {DESCRIPTION}")
    if not (folder / needed).is_file():
        raise ValueError(f"{folder} has no {needed} yet: begin it anew in another folder")
    if not os.access(folder, os.W_OK):
        raise PermissionError(f"the folder {folder} cannot be written to")
    try:
        return json.loads(description.read_text())["arguments"]
    except (ValueError, KeyError, TypeError) as error:
        raise ValueError(f"{description} is broken: {error}") from None


def plain(arguments: Any) -> dict[str, Any]:
    """Return a dataclass of arguments as JSON knows them."""

    def told(value: Any) -> Any:
        if hasattr(value, "_asdict"):
            return value._asdict()
        return str(value) if isinstance(value, pathlib.Path) else value

    return {name: told(value) for name, value in vars(arguments).items()}


def restore(arguments_class: type[Arguments], told: dict[str, Any]) -> Arguments:
    """Return the arguments that ``plain`` has written down.

    Raises:
        ValueError: when they are not arguments of this class.
    """
    usual = vars(arguments_class())

    def read(name: str, value: Any) -> Any:
        kind = type(usual[name])
        return kind(**value) if isinstance(value, dict) else kind(value)

    try:
        missing = set(usual) - set(told)
        if missing:
            raise KeyError(*sorted(missing))
        return arguments_class(**{name: read(name, value) for name, value in told.items()})
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(f"the run has other arguments than this version: {error}") from None


def about_of(name: str) -> dict[str, Any]:
    """Return how a trained policy came to be, without its curve; nothing for no policy."""
    path = policy_file(name)
    about = load_trained(path).about if path else {}
    return {key: value for key, value in about.items() if key != "curve"}


def versions() -> dict[str, Any]:
    """Return what the outcome of a training depends on beside its arguments."""
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
    """Return the revision of the working tree, with a + when files were changed; "" for none."""
    here = pathlib.Path(__file__).parent

    def git(*words: str) -> str:
        done = subprocess.run(["git", *words], cwd=here, capture_output=True, text=True, check=True)
        return done.stdout.strip()

    try:
        changed = git("status", "--porcelain", "--untracked-files=no")
        return git("rev-parse", "HEAD") + ("+" if changed else "")
    except (OSError, subprocess.CalledProcessError):
        return ""
