"""This module caches compiled entries on disk, and checks each file before it loads it.

Numba's own cache unpickles any content of its files, and fails if they are broken. If two processes
compile at once, it may also load the file of another signature.
"""

import contextlib
import hashlib
import logging
import os
import pathlib
import pickle
import re
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Iterable
from typing import Any

import numba
import numba.cpython.hashing  # its symbols; see load_overload
from numba.core.caching import NullCache
from numba.core.compiler import CompileResult
from numba.core.runtime import rtsys
from numba.core.serialize import dumps

from hav_env.compiled.cache_folder import find_home
from hav_env.compiled.digests import Code, digest_code
from hav_env.compiled.held import HeldType
from hav_env.compiled.kernels import ENTERED

_log = logging.getLogger(__name__)
_UNFINISHED = ".unfinished"
# versions of the code for one signature that are kept, as for branches between which a user
# switches
_VERSIONS = 4
_ABANDONED = 3_600.0  # [s] after which an unfinished file counts as abandoned


class DiskCache(NullCache):
    """Compiled forms of one function in a folder, with two files for each signature.

    The index ``.nbi`` contains the SHA-256 of the data ``.nbc``, which also names the data file.
    Processes that compile at once therefore never mix their files. The cache unpickles data only if
    they have that digest.
    """

    def __init__(self, function: Callable, folder: pathlib.Path) -> None:
        """Store the function and the folder."""
        self._function, self._folder = function, folder
        self._codes: dict[tuple, Code] = {}

    @property
    def cache_path(self) -> str:
        """Return the folder, for Numba's statistics."""
        return str(self._folder)

    def load_overload(self, sig: tuple, target_context: Any) -> Any:
        """Return the compiled form for a signature; None if there is none, or it is broken.

        A broken form is removed, so Numba compiles it again.
        """
        index = self._index(sig, target_context.codegen())
        if not os.path.lexists(index):
            return None
        try:
            digest = index.read_text("ascii")
            if not re.fullmatch("[0-9a-f]{64}", digest):
                raise ValueError("the index is no digest")
            content = _data(index, digest).read_bytes()
            if hashlib.sha256(content).hexdigest() != digest:
                raise ValueError("the data have another digest")
            # Numba's own cache prepares a compilation here, which takes half a second. To run, code
            # needs these symbols only, and those of hashes, which the import above registers.
            rtsys.initialize(target_context)
            return CompileResult._rebuild(target_context, *pickle.loads(content))
        except Exception as error:  # broken data may raise any error while loading
            message = "hav_env compiles %s again, because it is broken in the cache: %s (%s)"
            _log.warning(message, self._function.__name__, index, error)
            with contextlib.suppress(OSError):
                for path in (index, *self._folder.glob(f"{index.stem}.*.nbc")):
                    _remove(path)
        return None

    def save_overload(self, sig: tuple, data: Any) -> None:
        """Store a compiled form; log a warning if that fails, for example on a full disk."""
        if data.lifted or data.library.has_dynamic_globals:
            return  # the data hold addresses of this process
        index = self._index(sig, data.codegen)
        try:
            content = dumps(data._reduce())
            digest = hashlib.sha256(content).hexdigest()
            self._folder.mkdir(0o700, exist_ok=True)
            _remove_abandoned(self._folder)
            _write(content, _data(index, digest))
            _write(digest.encode("ascii"), index)
            self._forget_old(index)
        except OSError as error:
            message = "hav_env cannot keep %s, and will compile it again: %s"
            _log.warning(message, self._function.__name__, error)

    def code(self, sig: tuple) -> Code:
        """Return the digest of all code that is compiled for a signature."""
        if sig not in self._codes:
            self._codes[sig] = digest_code([self._function], _classes_in(sig))
        return self._codes[sig]

    def holds(self, sig: tuple, target_context: Any) -> bool:
        """Return whether a compiled form is stored for a signature; it may be broken."""
        return os.path.lexists(self._index(sig, target_context.codegen()))

    def _index(self, sig: tuple, codegen: Any) -> pathlib.Path:
        """Return the path of the index for a signature on this processor.

        The name ends with the digest of the code, after a part that all versions share.
        """
        function = self._function
        parts = [
            *(numba.__version__, sys.implementation.cache_tag, codegen.magic_tuple()),
            *(function.__module__, function.__qualname__),
            *map(describe_type, sig),
        ]
        digest = hashlib.sha256(repr(parts).encode()).hexdigest()
        name = f"{function.__name__}-{digest[:16]}-{self.code(sig).digest[:16]}.nbi"
        return self._folder / name

    def _forget_old(self, index: pathlib.Path) -> None:
        """Remove all but the newest versions of the code for the same signature."""
        kin = list(self._folder.glob(f"{index.stem.rpartition('-')[0]}-*.nbi"))
        with contextlib.suppress(OSError):  # another process may have removed it
            for old in sorted(kin, key=lambda path: path.lstat().st_mtime)[:-_VERSIONS]:
                for path in (old, *self._folder.glob(f"{old.stem}.*.nbc")):
                    _remove(path)


def cached(call: Callable, function: Callable) -> Any:
    """Return a function in its compiled, or lazily compiled, form, cached on disk if possible.

    Args:
        call: Function that Python will call.
        function: Function of the user that it runs, by whose code the cache knows it.
    """
    dispatcher = numba.njit(**ENTERED)(call)
    home = find_home(os.environ.get("NUMBA_CACHE_DIR", ""))
    if home is not None and hasattr(dispatcher, "compile"):
        dispatcher._cache = DiskCache(function, home)
    return dispatcher


def _classes_in(kinds: Iterable[Any]) -> set[type]:
    """Return the classes of the named tuples among Numba types, including nested ones."""
    found: set[type] = set()
    for kind in kinds:
        if isinstance(kind, HeldType):
            found |= _classes_in(kind.arguments)
        elif isinstance(kind, numba.types.BaseTuple):
            found |= _classes_in(kind)
            if hasattr(kind, "instance_class"):
                found.add(kind.instance_class)
    return found


def describe_type(kind: Any) -> str:
    """Return a Numba type as text that is the same in every process.

    Numba's name of a named tuple omits its module and its fields.
    """
    if isinstance(kind, HeldType):
        return f"Held{describe_type(kind.arguments)}"
    if not isinstance(kind, numba.types.BaseTuple):
        return str(kind)
    fields = getattr(kind, "fields", range(len(kind)))
    described = ", ".join(f"{name}: {describe_type(kind[k])}" for k, name in enumerate(fields))
    made = getattr(kind, "instance_class", tuple)
    return f"{made.__module__}.{made.__qualname__}({described})"


def _data(index: pathlib.Path, digest: str) -> pathlib.Path:
    return index.with_name(f"{index.stem}.{digest[:16]}.nbc")


def _write(content: bytes, path: pathlib.Path) -> None:
    """Write a file atomically."""
    handle, name = tempfile.mkstemp(_UNFINISHED, dir=path.parent)
    try:
        with open(handle, "wb") as file:
            file.write(content)
        if path.is_dir():
            _remove(path)
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise


def _remove(path: pathlib.Path) -> None:
    """Remove a file, or a folder in its place."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def _remove_abandoned(folder: pathlib.Path) -> None:
    """Remove files that killed processes left behind."""
    for path in folder.glob(f"*{_UNFINISHED}"):
        with contextlib.suppress(OSError):  # another process may have removed it
            if path.lstat().st_mtime < time.time() - _ABANDONED:
                path.unlink()
