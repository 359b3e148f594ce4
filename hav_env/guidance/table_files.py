"""This module keeps lattices on disk, beside compiled code, and checks each file before use.

The name of a file is the SHA-256 of all inputs of its table: walls, goal, radius, bounds, lattice,
and the code of the search. The file begins with the SHA-256 of its other bytes.
"""

import contextlib
import functools
import hashlib
import io
import logging
import os
import pathlib
import tempfile
import zipfile
from collections.abc import Sequence

import numpy as np

from hav_env.compiled import digest_code
from hav_env.compiled.cache_folder import find_home
from hav_env.guidance.lattice import (
    Lattice,
    LatticeTable,
    check_arguments,
    search,
    table_of,
)
from hav_env.guidance.search import find_direct, spread_backwards
from hav_env.guidance.walls import Grid

_log = logging.getLogger(__name__)
_FOLDER = "lattices"
_ARRAYS = ("length", "side", "steps", "offset", "goal")
_MOST_FILES = 1024  # beyond this number, the oldest files are removed
_DIGEST_SIZE = hashlib.sha256().digest_size


def load_lengths(
    lattice: Lattice,
    segments: np.ndarray,
    goal: tuple[float, float, float],
    radius: float,
    bounds: tuple[float, float, float, float] | None = None,
) -> LatticeTable:
    """Return the table of ``find_lengths``; load it from disk, or compute it and keep it there.

    Args:
        lattice: Sizes of cells, clearance.
        segments: (S, 4) Walls, x1, y1, x2, y2 [m].
        goal: x, y [m] and heading [rad].
        radius: Turning radius [m].
        bounds: As in ``find_lengths``.

    Raises:
        TypeError: If an argument has another type.
        ValueError: If an argument is out of range.
    """
    known = check_arguments(lattice, segments, goal, radius, bounds)
    home = find_home(os.environ.get("NUMBA_CACHE_DIR", ""))
    if home is None:
        return table_of(lattice, *search(lattice, *known))
    path = home / _FOLDER / f"{_key(lattice, *known)}.lattice"
    table = _read(path)
    if table is None:
        table = table_of(lattice, *search(lattice, *known))
        _keep(table, path)
    return table


def are_kept(
    lattice: Lattice,
    segments: np.ndarray,
    wanted: Sequence[tuple[tuple[float, float, float], float]],
    bounds: tuple[float, float, float, float],
) -> int:
    """Return the number of tables on disk among those of the given goals and radii [m].

    The other arguments are those of ``load_lengths``.
    """
    home = find_home(os.environ.get("NUMBA_CACHE_DIR", ""))
    if home is None:
        return 0
    found = 0
    for goal, radius in wanted:
        known = check_arguments(lattice, segments, goal, radius, bounds)
        found += (home / _FOLDER / f"{_key(lattice, *known)}.lattice").exists()
    return found


def _key(
    lattice: Lattice,
    segments: np.ndarray,
    goal: np.ndarray,
    radius: float,
    bounds: tuple[float, float, float, float],
) -> str:
    """Return the SHA-256 of all inputs of a table, in hexadecimal."""
    numbers = [float(number) for number in (*lattice, *goal, radius, *bounds)]
    told = [_digest_search(), np.lib.NumpyVersion(np.__version__).version, *map(float.hex, numbers)]
    digest = hashlib.sha256("\n".join(told).encode())
    digest.update(np.ascontiguousarray(segments, "<f8").tobytes())
    return digest.hexdigest()


@functools.cache
def _digest_search() -> str:
    """Return the digest of the code of the search."""
    return digest_code([search, table_of, find_direct, spread_backwards]).digest


def _read(path: pathlib.Path) -> LatticeTable | None:
    """Return the table in a file, None without a file; remove a broken file and return None."""
    try:
        content = path.read_bytes()
    except OSError:
        return None
    try:
        if hashlib.sha256(content[_DIGEST_SIZE:]).digest() != content[:_DIGEST_SIZE]:
            raise ValueError("the content has another digest")
        with np.load(io.BytesIO(content[_DIGEST_SIZE:]), allow_pickle=False) as arrays:
            radius, *grid = arrays["scalars"].tolist()
            length, side, steps, offset, goal = (arrays[name] for name in _ARRAYS)
            return LatticeTable(length, side, steps, offset, goal, radius, Grid(*grid))
    except (ValueError, KeyError, TypeError, OSError, zipfile.BadZipFile) as error:
        _log.warning("hav_env finds a lattice again, for %s is broken: %s", path, error)
        with contextlib.suppress(OSError):
            path.unlink()
        return None


def _keep(table: LatticeTable, path: pathlib.Path) -> None:
    """Write a table, whole or not at all; log a warning if that fails."""
    data = io.BytesIO()
    arrays = {name: getattr(table, name) for name in _ARRAYS}
    np.savez(data, scalars=np.array([table.radius, *table.grid]), **arrays)
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
        _log.warning("hav_env cannot keep a lattice, and will find it again: %s", error)


def _forget_old(folder: pathlib.Path) -> None:
    """Remove all but the newest files; this also removes unfinished files of killed processes."""
    with contextlib.suppress(OSError):  # another process may have removed a file first
        files = sorted(folder.iterdir(), key=lambda path: path.lstat().st_mtime)
        for old in files[:-_MOST_FILES]:
            old.unlink()
