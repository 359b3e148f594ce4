"""This module sets up all tests: examples they draw, code that is traced, threads of PyTorch."""

import os

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
