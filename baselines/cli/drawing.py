"""This module warns before a run if figures cannot be drawn, for want of matplotlib."""

import importlib
import sys

from hav_env.models.extras import EXTRAS, how_to_install


def can_draw() -> bool:
    """Return whether figures can be drawn; if not, print the command that installs the library."""
    library = "matplotlib"
    try:
        importlib.import_module(library)
    except ImportError:
        remedy = how_to_install(EXTRAS[library])
        print(f"no figures, tables alone: they need {library}: {remedy}", file=sys.stderr)
        return False
    return True
