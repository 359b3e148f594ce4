"""This module describes how a table on disk was made, with a digest (SHA-256)."""

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
    """Return what determines a table, as JSON: parameters, versions, digest of the code.

    Args:
        experiments: A ``baselines.evaluation.runs.Experiments``.
        makers: Functions that make the table.
    """
    described = {
        **{field: describe_model(value) for field, value in experiments._asdict().items()},
        "hav_env": hav_env.__version__,
        "code": digest_code(makers, classes_in(*experiments)).digest,
    }
    return json.loads(json.dumps(described))


def describe_model(value: Any) -> Any:
    """Return a model as values for JSON: its type, and its fields by name; arrays by digest."""
    if hasattr(value, "_asdict"):
        fields = {k: describe_model(v) for k, v in value._asdict().items()}
        return {"type": type(value).__name__, **fields}
    if isinstance(value, np.ndarray):
        return hashlib.sha256(value.tobytes()).hexdigest()
    return value.item() if isinstance(value, np.generic) else value


def claim(path: pathlib.Path, description: dict[str, Any]) -> str | None:
    """Write the description of a run, or check that the present one is equal.

    Returns:
        The digest of the table; None if it has not been made.

    Raises:
        ValueError: If the folder holds other data, or the description is broken.
    """
    if not path.exists():
        data = path.with_suffix(".parquet"), path.with_suffix(".parts")
        if any(kept.exists() for kept in data):
            raise ValueError(f"{path.parent} contains results without a description: {_REMEDY}")
        write_text(_text(description, None), path)
        return None
    begun = _read(path)
    for key, value in description.items():
        if begun.get(key) != value:
            what = "was made by other code" if key == "code" else f"has another {key}"
            raise ValueError(f"{path.parent} holds a run that {what}: {_REMEDY}")
    return begun.get(_DIGEST)


def seal(path: pathlib.Path, description: dict[str, Any], digest: str) -> None:
    """Add the digest of the completed table, unless it is there; repair the file."""
    text = _text(description, digest)
    if path.read_bytes() != text.encode():
        write_text(text, path)


def _text(description: dict[str, Any], digest: str | None) -> str:
    described = description if digest is None else description | {_DIGEST: digest}
    return json.dumps(described, indent=2) + "\n"


def _read(path: pathlib.Path) -> dict[str, Any]:
    try:
        return read_object(path)
    except (ValueError, OSError) as error:
        raise ValueError(f"{path} describes no run ({error}): {_REMEDY}") from None
