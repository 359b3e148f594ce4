"""This module runs evaluations on a Ray cluster.

It imports Ray only when it runs. Without an address it starts Ray on this machine.
"""

import contextlib
import importlib
import logging
import os
import re
import socket
from collections.abc import Iterator
from typing import Any

_JOB = "RAY_JOB_CONFIG_JSON_ENV_VAR"  # is set in what ``ray job submit`` runs


@contextlib.contextmanager
def connect(address: str | None = None) -> Iterator[Any]:
    """Give Ray, connected; leave the cluster at the end unless it was connected before.

    Workers can import what lies in the working directory: on this machine as it is, on a cluster
    as a copy without what ``.gitignore`` names. There they need the project's dependencies, and the
    project itself where the working directory is not a clone of it.

    Args:
        address: of a cluster that is there, ``HOST:PORT`` or ``auto``; None starts one here, which
            lives as long as it is wanted.

    Raises:
        ImportError: when Ray is not installed.
        ValueError: when the address is none.
        ConnectionError: when nobody answers at it.
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
    """Return the module.

    Raises:
        ImportError: when it is not installed.
    """
    try:
        return importlib.import_module("ray")
    except ImportError as error:
        raise ImportError(f"this needs Ray ({error}): pip install 'hav_env[ray]'") from None


def check_address(address: str) -> None:
    """Check an address and that somebody answers there, which takes Ray itself many minutes.

    Raises:
        ValueError: when it is none.
        ConnectionError: when nobody answers.
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
