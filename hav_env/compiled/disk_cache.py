"""This module caches compiled entries on disk, and checks each file before it loads it.

Numba's own cache unpickles any content of its files, and fails where they are broken. It also gives
code of one signature the file of another where two processes compile at once.
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
from numba.core.caching import NullCache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from hav_env.compiled.digests import Code, digest_code
from hav_env.compiled.held import HeldType

_log = logging.getLogger(__name__)
_UNFINISHED = ".unfinished"
_VERSIONS = 4  # of the code for one signature: those of branches that a user changes between
_ABANDONED = 3_600.0  # [s] after which nobody writes to an unfinished file any more


class DiskCache(NullCache):
    """The compiled forms of one function in a folder, two files for each signature.

    The index ``.nbi`` is the SHA-256 of the data ``.nbc`` and names it, so that processes that
    compile at once never mix their files. The data are unpickled only if they have that digest.
    """

    def __init__(self, function: Callable, folder: pathlib.Path) -> None:
        """Take the function and the folder."""
        self._function, self._folder = function, folder
        self._codes: dict[tuple, Code] = {}

    @property
    def cache_path(self) -> str:
        """The folder, for Numba's statistics."""
        return str(self._folder)

    def load_overload(self, sig: tuple, target_context: Any) -> Any:
        """Return the compiled form for a signature; None if there is none, or a broken one.

        It removes a broken one, so that Numba compiles it anew.
        """
        target_context.refresh()
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
            return CompileResult._rebuild(target_context, *pickle.loads(content))
        except Exception as error:  # what is broken may break the loading anywhere
            told = "hav_env compiles %s again, for it is broken in the cache: %s (%s)"
            _log.warning(told, self._function.__name__, index, error)
            with contextlib.suppress(OSError):
                for path in (index, *self._folder.glob(f"{index.stem}.*.nbc")):
                    _remove(path)
        return None

    def save_overload(self, sig: tuple, data: Any) -> None:
        """Keep a compiled form; say so on the log if that fails, for example on a full disk."""
        if data.lifted or data.library.has_dynamic_globals:
            return  # holds addresses of this process
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
            told = "hav_env cannot keep %s, and will compile it again: %s"
            _log.warning(told, self._function.__name__, error)

    def code(self, sig: tuple) -> Code:
        """Return the digest of all code that is compiled for a signature."""
        if sig not in self._codes:
            self._codes[sig] = digest_code([self._function], _classes_in(sig))
        return self._codes[sig]

    def holds(self, sig: tuple, target_context: Any) -> bool:
        """Tell whether a compiled form is kept for a signature; it may be broken."""
        return os.path.lexists(self._index(sig, target_context.codegen()))

    def _index(self, sig: tuple, codegen: Any) -> pathlib.Path:
        """Return the path of the index for a signature on this processor.

        Its name ends with the digest of the code, behind what is the same for all versions of it.
        """
        function = self._function
        told = [
            *(numba.__version__, sys.implementation.cache_tag, codegen.magic_tuple()),
            *(function.__module__, function.__qualname__),
            *map(describe_type, sig),
        ]
        digest = hashlib.sha256(repr(told).encode()).hexdigest()
        name = f"{function.__name__}-{digest[:16]}-{self.code(sig).digest[:16]}.nbi"
        return self._folder / name

    def _forget_old(self, index: pathlib.Path) -> None:
        """Remove all but the newest versions of the code for the same signature."""
        kin = list(self._folder.glob(f"{index.stem.rpartition('-')[0]}-*.nbi"))
        with contextlib.suppress(OSError):  # another process may be quicker
            for old in sorted(kin, key=lambda path: path.lstat().st_mtime)[:-_VERSIONS]:
                for path in (old, *self._folder.glob(f"{old.stem}.*.nbc")):
                    _remove(path)


def _classes_in(kinds: Iterable[Any]) -> set[type]:
    """Return the classes of the named tuples among types of Numba, inner ones among them."""
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
    """Return a type of Numba in words that are the same in every process.

    Numba's name of a named tuple tells neither its module nor its fields.
    """
    if isinstance(kind, HeldType):
        return f"Held{describe_type(kind.arguments)}"
    if not isinstance(kind, numba.types.BaseTuple):
        return str(kind)
    fields = getattr(kind, "fields", range(len(kind)))
    told = ", ".join(f"{name}: {describe_type(kind[k])}" for k, name in enumerate(fields))
    made = getattr(kind, "instance_class", tuple)
    return f"{made.__module__}.{made.__qualname__}({told})"


def _data(index: pathlib.Path, digest: str) -> pathlib.Path:
    return index.with_name(f"{index.stem}.{digest[:16]}.nbc")


def _write(content: bytes, path: pathlib.Path) -> None:
    """Write a file, whole or not at all."""
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
    """Remove what processes that were killed left behind."""
    for path in folder.glob(f"*{_UNFINISHED}"):
        with contextlib.suppress(OSError):  # another process may be quicker
            if path.lstat().st_mtime < time.time() - _ABANDONED:
                path.unlink()
