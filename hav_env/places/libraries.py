"""This module imports the libraries of the extra ``maps``, or explains their installation."""

import importlib
from typing import Any


def import_maps(library: str) -> Any:
    """Return a library that reads maps.

    Args:
        library: name of the module, such as shapely.

    Raises:
        ImportError: if it is not installed; the message explains the installation.
    """
    try:
        return importlib.import_module(library)
    except ImportError as error:
        needed = library.partition(".")[0]
        told = f"this file needs {needed}: run pip install -e '.[maps]' in the clone"
        raise ImportError(told) from error
