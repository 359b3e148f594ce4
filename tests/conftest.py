"""This module sets up all tests: how many examples they draw, and what they leave behind."""

import sys
import types

import pytest
from hypothesis import settings

from hav_env.compiled.digests import sources
from tests.support.budgets import COMPILED

settings.register_profile(
    "suite", deadline=None, derandomize=True, database=None, max_examples=300 if COMPILED else 40
)
settings.load_profile("suite")


@pytest.fixture(autouse=True)
def no_kernels_are_left_behind():
    """Forget the kernels of a file that only one test imports.

    Compiled code is kept under the digest of all files with kernels: with one more, every test that
    follows would compile everything anew.
    """
    before = set(sources)
    yield
    added = {source for source in sources - before if not source.is_dir()}
    sources.difference_update(added)
    files = {str(source) for source in added}
    for name in [name for name, module in sys.modules.items() if file_of(module) in files]:
        del sys.modules[name]  # who imports it again has it noted again


def file_of(module):
    return vars(module).get("__file__") if isinstance(module, types.ModuleType) else None
