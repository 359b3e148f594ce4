"""This module locks files against other processes; the system frees the locks of killed ones.

Locks are advisory. On a network file system they hold between machines if its mount allows it.
"""

import contextlib
import logging
import os
import pathlib
import sys
import threading
from collections.abc import Iterator

if sys.platform == "win32":
    import msvcrt

    def lock(descriptor: int) -> bool:
        """Lock an open file; return False if it is already locked.

        Raises:
            OSError: If the file system has no locks.
        """
        try:
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        except PermissionError:
            return False
        return True

else:
    import fcntl

    def lock(descriptor: int) -> bool:
        """Lock an open file; return False if it is already locked.

        Raises:
            OSError: If the file system has no locks.
        """
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True


_OF_FILES = {
    **dict.fromkeys(
        (".html", ".mp4", ".gif", ".npz"), "hav-env watch draws pages and films of an episode"
    ),
    **dict.fromkeys((".csv", ".md", ".txt"), "hav-env evaluate --format csv or md prints tables"),
    **dict.fromkeys((".parquet", ".json"), "it will hold a file of this kind for each table"),
    **dict.fromkeys((".png", ".pdf", ".svg"), "it will hold all figures"),
    **dict.fromkeys((".policy", ".zip"), "it will hold the policies of the training"),
}
"""Suffixes of names that no folder should have, with advice."""
LOCK = ".lock"  # is in the folder while a run works there
_held = threading.local()  # folders in which this thread works


@contextlib.contextmanager
def sole_user(folder: pathlib.Path) -> Iterator[None]:
    """Keep other processes and threads from working in a folder; make it if it does not exist.

    The thread that works in the folder may enter again.

    Raises:
        ValueError: If the folder is a file, or a new one has the name of a file.
        BlockingIOError: If another run works there.
        OSError: If the folder cannot be made or written to.
    """
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"output {folder} is a file, but must be a folder")
    advice = _OF_FILES.get(folder.suffix.lower())
    if advice and not folder.exists():
        raise ValueError(f"output is {folder}, but must be a folder: {advice}")
    folder.mkdir(parents=True, exist_ok=True)
    place = folder.resolve()
    if place in _folders():
        yield
        return
    descriptor = _take(folder / LOCK, folder)
    _folders().add(place)
    try:
        yield
    finally:
        _folders().discard(place)
        _leave(folder / LOCK, descriptor)


def _folders() -> set[pathlib.Path]:
    if not hasattr(_held, "folders"):
        _held.folders = set()
    return _held.folders


def _take(path: pathlib.Path, folder: pathlib.Path) -> int:
    """Return the descriptor of the lock file, which is locked."""
    while True:
        try:
            descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        except OSError as error:
            message = f"the folder {folder} cannot be written to: {error.strerror}"
            raise type(error)(message) from None
        try:
            free = lock(descriptor)
        except OSError as error:
            logging.getLogger(__name__).warning(
                "%s has no locks (%s): start no second run there", folder, error.strerror
            )
            return descriptor
        if free and is_at(descriptor, path):
            return descriptor
        os.close(descriptor)
        if not free:
            advice = "wait for its end, or choose another --output"
            raise BlockingIOError(f"another run works in {folder}: {advice}")


def is_at(descriptor: int, path: pathlib.Path) -> bool:
    """Return whether an open file is still the one at a path."""
    try:
        return os.path.samestat(os.fstat(descriptor), path.stat())
    except OSError:
        return False


def _leave(path: pathlib.Path, descriptor: int) -> None:
    """Remove the lock file before it is unlocked, so no process locks a file that vanishes."""
    if sys.platform != "win32" and is_at(descriptor, path):
        with contextlib.suppress(OSError):
            path.unlink()
    os.close(descriptor)
    # Windows cannot remove open files, nor those that other processes opened
    if sys.platform == "win32":
        with contextlib.suppress(OSError):
            path.unlink()
