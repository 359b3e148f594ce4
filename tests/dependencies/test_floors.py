"""Constraints hold the lowest releases that pyproject.toml allows."""

import subprocess
import sys

import pytest

from tests.dependencies.floors import floors, requirements_of
from tests.support.paths import ROOT

EXTRAS = ("maps", "plots", "rendering", "training", "tests", "checks")
WISHES = ["a>=2,<3", "a>=2.10; python_version >= '3.13'", "b[c]>=1.5", "b>=1.4"]


@pytest.mark.parametrize(
    ("python", "lowest"), [("3.9", "2"), ("3.12", "2"), ("3.13", "2.10"), ("3.14", "2.10")]
)
def test_the_highest_floor_that_holds_on_a_python_counts(python, lowest):
    assert floors(WISHES, python) == {"a": lowest, "b": "1.5"}


def test_who_has_no_floor_is_named():
    with pytest.raises(ValueError, match=r"a has no floor on Python 3\.12"):
        floors(["b>=1", "a<3"], "3.12")


@pytest.mark.parametrize("python", ["3.11", "3.12", "3.13", "3.14"])
def test_every_dependency_has_a_floor(python):
    assert {"numba", "numpy", "pyarrow", "torch"} <= set(floors(requirements_of(EXTRAS), python))


def test_the_command_prints_constraints_for_pip():
    command = [sys.executable, "-m", "tests.dependencies.floors", "3.11", "plots"]
    told = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    expected = floors(requirements_of(["plots"]), "3.11")
    assert told.splitlines() == [f"{name}=={version}" for name, version in expected.items()]
