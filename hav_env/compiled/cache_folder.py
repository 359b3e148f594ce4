"""This module chooses the folder of compiled code, to which nobody else can write."""

import functools
import logging
import os
import pathlib
import stat
import tempfile
from collections.abc import Iterator

_log = logging.getLogger(__name__)
_OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH
_OTHERS = stat.S_IRWXG | stat.S_IRWXO


@functools.cache
def find_home(wanted: str) -> pathlib.Path | None:
    """Return the folder of the compile cache, made if there was none; None if there is no place.

    The simulator loads its files as machine code. So anybody who can write to the folder runs code
    as this user. The log names a folder that is unsafe or not writable, once.

    Args:
        wanted: the folder that the user wants, "" for ``~/.cache/hav_env``. After it comes one of
            this user's own in the folder for temporary files.
    """
    refused = []
    for place in _places(wanted):
        try:
            home = place()
            private = home.name.startswith("hav_env-")  # beside the files of all other users
            _make(home)
            _check(home, private)
            with tempfile.TemporaryFile(dir=home):
                break
        except (OSError, RuntimeError, ValueError) as error:
            refused.append(str(error))
    else:
        home = None
    if refused:
        instead = f"keeps it in {home}" if home else "compiles in every process anew"
        _log.warning("hav_env %s: %s", instead, "; ".join(refused))
    return home


def _places(wanted: str) -> Iterator:
    """List what returns the folders that come into question, the first one first."""
    if wanted:
        yield lambda: pathlib.Path(wanted).expanduser().absolute()
    else:
        yield lambda: pathlib.Path.home().absolute() / ".cache/hav_env"
    # Windows has no user ids, and a folder for temporary files for each user
    user = os.getuid() if hasattr(os, "getuid") else "cache"
    yield lambda: pathlib.Path(tempfile.gettempdir()).absolute() / f"hav_env-{user}"


def _make(folder: pathlib.Path) -> None:
    """Make a folder and those above it, for this user alone whatever the umask."""
    missing = [part for part in (folder, *folder.parents) if not part.exists()]
    for part in reversed(missing):
        part.mkdir(0o700, exist_ok=True)


def _check(folder: pathlib.Path, private: bool) -> None:
    """Check that nobody but this user and root can write to a folder, or put another in its place.

    Args:
        folder: absolute.
        private: whether nobody else may read it either, nor may it be a link.

    Raises:
        PermissionError: naming the folder and what is wrong with it.
    """
    if not hasattr(os, "getuid"):
        return
    own, real = os.getuid(), folder.resolve()
    for part in {*folder.parents, *real.parents, folder, real}:
        found = os.lstat(part)
        if found.st_uid not in {own, 0} or (part == real and found.st_uid != own):
            raise PermissionError(f"{part} belongs to user {found.st_uid}, not to {own}")
        if stat.S_ISLNK(found.st_mode):
            if private and part == folder:
                raise PermissionError(f"{part} is a link, but must be a folder")
            continue  # the mode of a link says nothing
        # in a sticky folder others can neither rename nor remove what is this user's
        sticky = found.st_mode & stat.S_ISVTX and part != real
        if found.st_mode & _OTHERS_WRITE and not sticky:
            raise PermissionError(f"{part} can be written to by other users")
    if private and os.lstat(folder).st_mode & _OTHERS:
        raise PermissionError(f"{folder} is open to other users")
