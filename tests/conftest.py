"""This module sets up all tests: their order, examples they draw, code that is traced, threads."""

import os
import pathlib

from hypothesis import settings

from tests.support.budgets import COMPILED
from tests.support.tracing import leave_compiler_untraced

settings.register_profile(
    "suite", deadline=None, derandomize=True, database=None, max_examples=300 if COMPILED else 40
)
settings.load_profile("suite")

leave_compiler_untraced()
# PyTorch's threads wait in loops, for each other and for those of the other processes of "-n"
os.environ.setdefault("OMP_NUM_THREADS", "1")

# "-n 2" gives each process half of the tests, and the one that is ready first takes tests from the
# end of the other. Of loops that belong together, one process should compile most.
ENVIRONMENTS = ("envs", "mdp", "observation", "rendering", "train", "cli", "benchmarks", "docs")
NO_LOOPS = ("models", "places", "maths", "house")
REAL_VEHICLES = ("safety", "guidance", "vehicles", "scenarios")
_ORDER = (*ENVIRONMENTS, *NO_LOOPS, "", *REAL_VEHICLES)  # all other folders where "" is


def pytest_collection_modifyitems(items):
    """Order the tests by folders; in a folder they keep their order."""
    here = pathlib.Path(__file__).parent

    def place(item):
        folder = item.path.relative_to(here).parts[0]
        return _ORDER.index(folder if folder in _ORDER else "")

    items.sort(key=place)
