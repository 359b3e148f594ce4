"""This module describes how a table on disk was made, and digests that (SHA-256)."""

import hashlib
import json
import pathlib
from collections.abc import Callable
from typing import Any

import numpy as np

import hav_env
from baselines.storage.atomic_files import read_object, write_text
from hav_env.compiled import classes_in, digest_code

_DIGEST = "table_sha256"
_REMEDY = "choose another --output, or --overwrite"


def describe_run(experiments: Any, makers: tuple[Callable, ...]) -> dict[str, Any]:
    """Return what determines a table, as JSON: parameters, versions and digest of the code.

    Args:
        experiments: a ``baselines.evaluation.runs.Experiments``.
        makers: functions that make the table.
    """
    told = {
        **{field: _plain(value) for field, value in experiments._asdict().items()},
        "hav_env": hav_env.__version__,
        "code": digest_code(makers, classes_in(*experiments)).digest,
    }
    return json.loads(json.dumps(told))


def _plain(value: Any) -> Any:
    if hasattr(value, "_asdict"):
        fields = {k: _plain(v) for k, v in value._asdict().items()}
        return {"type": type(value).__name__, **fields}
    if isinstance(value, np.ndarray):
        return hashlib.sha256(value.tobytes()).hexdigest()
    return value.item() if isinstance(value, np.generic) else value


def claim(path: pathlib.Path, description: dict[str, Any]) -> str | None:
    """Write down what is run here, or check that it is what was begun.

    Returns:
        The digest of the table; None when it has not been made.

    Raises:
        ValueError: when other data lie here, or the description is broken.
    """
    if not path.exists():
        data = path.with_suffix(".parquet"), path.with_suffix(".parts")
        if any(kept.exists() for kept in data):
            raise ValueError(f"{path.parent} holds results that nothing describes: {_REMEDY}")
        write_text(_text(description, None), path)
        return None
    begun = _read(path)
    for key, value in description.items():
        if begun.get(key) != value:
            what = "was made by other code" if key == "code" else f"has another {key}"
            raise ValueError(f"{path.parent} holds a run that {what}: {_REMEDY}")
    return begun.get(_DIGEST)


def seal(path: pathlib.Path, description: dict[str, Any], digest: str) -> None:
    """Add the digest of the table that has been made, unless it is there; mend the file."""
    text = _text(description, digest)
    if path.read_bytes() != text.encode():
        write_text(text, path)


def _text(description: dict[str, Any], digest: str | None) -> str:
    told = description if digest is None else description | {_DIGEST: digest}
    return json.dumps(told, indent=2) + "\n"


def _read(path: pathlib.Path) -> dict[str, Any]:
    try:
        return read_object(path)
    except (ValueError, OSError) as error:
        raise ValueError(f"{path} describes no run ({error}): {_REMEDY}") from None
