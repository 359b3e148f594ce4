"""This module chooses the folder of compiled code, to which no other user can write."""

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
    """Return the folder of the compile cache, created if absent; None if no folder is usable.

    The simulator loads its files as machine code. A user with write access to the folder could
    therefore run code as this user. The log names an unsafe or unwritable folder once.

    Args:
        wanted: Folder that the user wants, "" for ``~/.cache/hav_env``. The second choice is this
            user's own folder among the temporary files.
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
    """Yield functions that return the candidate folders, best one first."""
    if wanted:
        yield lambda: pathlib.Path(wanted).expanduser().absolute()
    else:
        yield lambda: pathlib.Path.home().absolute() / ".cache/hav_env"
    # Windows has no user ids, and each user has a folder for temporary files
    user = os.getuid() if hasattr(os, "getuid") else "cache"
    yield lambda: pathlib.Path(tempfile.gettempdir()).absolute() / f"hav_env-{user}"


def _make(folder: pathlib.Path) -> None:
    """Make a folder and its parents, for this user alone, whatever the umask."""
    missing = [part for part in (folder, *folder.parents) if not part.exists()]
    for part in reversed(missing):
        part.mkdir(0o700, exist_ok=True)


def _check(folder: pathlib.Path, private: bool) -> None:
    """Check that only this user and root can write to a folder or replace it.

    Args:
        folder: Folder, an absolute path.
        private: Whether other users must not read the folder either, and it must not be a link.

    Raises:
        PermissionError: If the folder is unsafe; the message names the folder and the problem.
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
            continue  # the mode of a link has no effect
        # in a sticky folder, other users can neither rename nor remove this user's files
        sticky = found.st_mode & stat.S_ISVTX and part != real
        if found.st_mode & _OTHERS_WRITE and not sticky:
            raise PermissionError(f"{part} can be written to by other users")
    if private and os.lstat(folder).st_mode & _OTHERS:
        raise PermissionError(f"{folder} is open to other users")
