"""This module runs evaluations on a Ray cluster.

It imports Ray only at run time. Without an address it starts Ray on this machine.
"""

import contextlib
import importlib
import logging
import os
import re
import socket
from collections.abc import Iterator
from typing import Any

_JOB = "RAY_JOB_CONFIG_JSON_ENV_VAR"  # ``ray job submit`` sets it for its jobs


@contextlib.contextmanager
def connect(address: str | None = None) -> Iterator[Any]:
    """Yield Ray, connected; leave the cluster at the end unless it was connected before.

    On this machine, workers import modules from the working directory itself. On a cluster, they
    import from a copy without the files that ``.gitignore`` names. A cluster needs the project's
    dependencies, and the project itself if the working directory is not a clone of it.

    Args:
        address: Address of a running cluster, ``HOST:PORT`` or ``auto``; None starts one here for
            the duration of the context.

    Raises:
        ImportError: If Ray is not installed.
        ValueError: If the address is invalid.
        ConnectionError: If the address does not respond.
    """
    ray = load_ray()
    if address is not None:
        check_address(address)
    if ray.is_initialized():
        yield ray
        return
    copied = address is not None and _JOB not in os.environ
    ray.init(
        address or "local",
        runtime_env={"working_dir": os.getcwd()} if copied else None,
        logging_level=logging.WARNING,
        log_to_driver=False,
        **({} if address else {"include_dashboard": False}),
    )
    try:
        yield ray
    finally:
        ray.shutdown()


def load_ray() -> Any:
    """Return the module ``ray``.

    Raises:
        ImportError: If Ray is not installed.
    """
    try:
        return importlib.import_module("ray")
    except ImportError as error:
        raise ImportError(
            f"this needs Ray ({error}): run pip install -e '.[ray]' in the clone"
        ) from None


def check_address(address: str) -> None:
    """Check an address and that a cluster responds there; Ray itself would take many minutes.

    Raises:
        ValueError: If the address is invalid.
        ConnectionError: If the address does not respond.
    """
    if address == "auto":
        return
    parts = re.fullmatch(r"(.+):(\d{1,5})", address)
    if parts is None:
        raise ValueError(f"address is {address!r}, but must be HOST:PORT or auto")
    try:
        socket.create_connection((parts[1].strip("[]"), int(parts[2])), timeout=10).close()
    except (OSError, OverflowError) as error:
        raise ConnectionError(f"no Ray cluster answers at {address}: {error}") from None
