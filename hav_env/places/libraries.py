"""This module imports the libraries of the extra ``maps``, and says how to install them."""

import importlib
from typing import Any


def import_maps(library: str) -> Any:
    """Return a library that reads maps.

    Args:
        library: name of the module, such as shapely.

    Raises:
        ImportError: when it is not installed, saying how to install it.
    """
    try:
        return importlib.import_module(library)
    except ImportError as error:
        told = f"this file needs {library.partition('.')[0]}: pip install 'hav_env[maps]'"
        raise ImportError(told) from error
