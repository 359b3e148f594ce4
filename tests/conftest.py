"""This module sets up all tests: how many examples they draw, and which code is traced."""

from hypothesis import settings

from tests.support.budgets import COMPILED
from tests.support.tracing import leave_compiler_untraced

settings.register_profile(
    "suite", deadline=None, derandomize=True, database=None, max_examples=300 if COMPILED else 40
)
settings.load_profile("suite")

leave_compiler_untraced()
