"""This module rejects sizes that need more memory than the machine has."""

import os
import pathlib

_UNKNOWN = 2**35  # bytes, if the system does not report its memory
_CONTAINER_LIMITS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")


def check_memory(name: str, value: int, needed: float) -> None:
    """Raise ValueError if arrays need more memory than the machine has.

    Args:
        name: name of the argument that sets the size.
        value: value of that argument.
        needed: memory of the arrays [bytes].
    """
    most = available_memory()
    if needed > most:
        told = f"{name} is {value}, which takes {needed / 2**30:.1f} GiB"
        raise ValueError(f"{told}, but must take at most {most / 2**30:.1f} GiB, all there is here")


def available_memory() -> int:
    """Return the memory of this process [bytes]: that of the machine or of its container."""
    if "SC_PHYS_PAGES" in getattr(os, "sysconf_names", {}):
        most = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    else:
        most = _UNKNOWN
    for path in map(pathlib.Path, _CONTAINER_LIMITS):
        try:
            most = min(most, int(path.read_text()))
        except (OSError, ValueError):  # no container, or one without a limit ("max")
            continue
    return most
