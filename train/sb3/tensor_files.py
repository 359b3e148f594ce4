"""This module reads PyTorch files that hold tensors, numbers and text, without running any code."""

import pathlib
import pickle
import zipfile
from typing import Any

import numpy as np
import torch

from hav_env.world.arrays import PHASE, World

_SAFE = 2, 6  # the first release of PyTorch that runs no code of crafted files


def read_plain(path: pathlib.Path) -> dict[str, Any]:
    """Return the content of a file by ``torch.save``: only tensors, numbers and text.

    Raises:
        ValueError: If the file is broken, truncated, compressed, or holds other objects; or if this
            release of PyTorch may run code in it.
        OSError: If the file cannot be read.
    """
    version = tuple(int(part) for part in torch.__version__.split(".")[:2])
    if version < _SAFE:
        raise ValueError(
            f"PyTorch {torch.__version__} may run code in it (CVE-2025-32434); 2.6 does not"
        )
    try:
        with zipfile.ZipFile(path) as archive:
            members = archive.infolist()
            # PyTorch compresses nothing, and does not compare checksums when it reads
            if sum(member.file_size for member in members) > path.stat().st_size:
                raise ValueError("it says that it is larger than it is")
            if any(member.compress_type != zipfile.ZIP_STORED for member in members):
                raise ValueError("it is packed")
            damaged = archive.testzip()
    except zipfile.BadZipFile as error:
        raise ValueError(f"it is broken: {error}") from None
    if damaged:
        raise ValueError(f"it is broken: {damaged} has another checksum")
    try:
        state = torch.load(path, map_location="cpu", weights_only=True)
    except pickle.UnpicklingError:
        raise ValueError("it holds more than tensors, numbers and text") from None
    if not isinstance(state, dict):
        raise ValueError(f"it holds a {type(state).__name__}, but must hold a dictionary")
    return state


def array_like(like: Any, arrays: dict[str, Any], name: str) -> np.ndarray:
    """Return an array by its name.

    Raises:
        ValueError: If there is none, or its shape or type differs from ``like``.
    """
    like, found = np.asarray(like), arrays.get(name)
    if not isinstance(found, torch.Tensor):
        raise ValueError(f"it has no {name!r}")
    shape, kind = tuple(found.shape), str(found.dtype).removeprefix("torch.")
    if (shape, kind) != (like.shape, like.dtype.name):
        wanted = f"{like.dtype.name} of shape {like.shape}"
        raise ValueError(f"{name!r} is {kind} of shape {shape}, but must be {wanted}")
    return found.numpy().copy()


def check_worlds(worlds: World) -> None:
    """Check the indices that compiled code uses without a bounds check.

    Raises:
        ValueError: If an index is out of bounds; the message names the array.
    """
    num_havs, units, _ = worlds.fleet.length.shape
    laws = {
        "fleet num_trailers": (worlds.fleet.num_trailers, 0, units - 1),
        "nearby count": (worlds.nearby.count, 0, num_havs - 1),
        "nearby index": (worlds.nearby.index, 0, num_havs - 1),
        "nearby num_pairs": (worlds.nearby.num_pairs, 0, worlds.nearby.pair.shape[1]),
        "nearby pair": (worlds.nearby.pair, 0, max(num_havs - 1, 1)),
        "state goal": (worlds.state.goal[:, PHASE], 0, worlds.goals.shape[1] - 1),
    }
    for name, (array, least, most) in laws.items():
        if array.size and not (least <= array.min() and array.max() <= most):
            raise ValueError(f"{name} holds {array.min()} to {array.max()}, beyond {least}..{most}")
    for name in ("x", "y", "heading"):
        if not np.isfinite(getattr(worlds.state, name)).all():
            raise ValueError(f"state {name} holds a number that is not finite")
