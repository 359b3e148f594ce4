"""This module keeps arrays that take long to compute on disk, and checks each file before use.

The files lie beside compiled code. A file begins with the SHA-256 of its other bytes, which are an
archive of NumPy without pickled objects. A process writes a file under another name and then
renames it, so other processes see it whole or not at all.
"""

import contextlib
import hashlib
import io
import logging
import os
import pathlib
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from hav_env.compiled.cache_folder import find_home

_log = logging.getLogger(__name__)
_MOST_FILES = 1024  # beyond this number, the oldest files are removed
_DIGEST_SIZE = hashlib.sha256().digest_size


def digest_numbers(code: str, numbers: Sequence[float], arrays: Sequence[np.ndarray]) -> str:
    """Return the SHA-256 of all that determines a result, in hexadecimal.

    Args:
        code: Digest of the code.
        numbers: Parameters.
        arrays: Other inputs; they are compared as float64, with their shapes.
    """
    version = np.lib.NumpyVersion(np.__version__).version
    texts = [code, version, *(float(number).hex() for number in numbers)]
    digest = hashlib.sha256("\n".join(texts).encode())
    for array in arrays:
        digest.update(repr(array.shape).encode())
        digest.update(np.ascontiguousarray(array, "<f8").tobytes())
    return digest.hexdigest()


def file_of(folder: str, key: str) -> pathlib.Path | None:
    """Return the path of a file in a folder of the cache; None if no folder is usable."""
    home = find_home(os.environ.get("NUMBA_CACHE_DIR", ""))
    return None if home is None else home / folder / f"{key}.arrays"


def read_arrays(path: pathlib.Path | None, names: Sequence[str]) -> dict[str, np.ndarray] | None:
    """Return the arrays in a file, None without a file; remove a broken file and return None."""
    if path is None:
        return None
    try:
        content = path.read_bytes()
    except OSError:
        return None
    try:
        if hashlib.sha256(content[_DIGEST_SIZE:]).digest() != content[:_DIGEST_SIZE]:
            raise ValueError("the content has another digest")
        with np.load(io.BytesIO(content[_DIGEST_SIZE:]), allow_pickle=False) as arrays:
            return {name: arrays[name] for name in names}
    except (ValueError, KeyError, TypeError, OSError, EOFError, zipfile.BadZipFile) as error:
        _log.warning("hav_env computes a file again, for %s is broken: %s", path, error)
        with contextlib.suppress(OSError):
            path.unlink()
        return None


def keep_arrays(path: pathlib.Path | None, arrays: Mapping[str, Any]) -> None:
    """Write arrays, all or nothing; log a warning if that fails."""
    if path is None:
        return
    data = io.BytesIO()
    np.savez(data, **arrays)
    content = data.getvalue()
    try:
        path.parent.mkdir(0o700, exist_ok=True)
        handle, name = tempfile.mkstemp(".unfinished", dir=path.parent)
        try:
            with open(handle, "wb") as file:
                file.write(hashlib.sha256(content).digest() + content)
            os.replace(name, path)
        except BaseException:
            os.unlink(name)
            raise
        _forget_old(path.parent)
    except OSError as error:
        _log.warning("hav_env cannot keep a file, and will compute it again: %s", error)


def _forget_old(folder: pathlib.Path) -> None:
    """Remove all but the newest files; this also removes unfinished files of killed processes."""
    with contextlib.suppress(OSError):  # another process may have removed a file first
        files = sorted(folder.iterdir(), key=lambda path: path.lstat().st_mtime)
        for old in files[:-_MOST_FILES]:
            old.unlink()
