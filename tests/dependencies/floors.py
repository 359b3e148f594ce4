"""This module lists the lowest releases that pyproject.toml allows, as constraints for pip."""

import sys
import tomllib
from collections.abc import Iterable, Iterator

from packaging.requirements import Requirement
from packaging.version import Version

from tests.support.paths import ROOT


def floors(requirements: Iterable[str], python: str) -> dict[str, str]:
    """Return the lowest release of each package that serves a Python, such as 3.11.

    Raises:
        ValueError: If a package has no floor; the message names it.
    """
    found: dict[str, Version] = {}
    for text in requirements:
        wish = Requirement(text)
        if wish.marker and not wish.marker.evaluate({"python_version": python}):
            continue
        lowest = [Version(one.version) for one in wish.specifier if one.operator == ">="]
        if not lowest and wish.name not in found:
            raise ValueError(f"{wish.name} has no floor on Python {python}")
        found[wish.name] = max([*lowest, *filter(None, [found.get(wish.name)])])
    return {name: str(version) for name, version in found.items()}


def requirements_of(extras: Iterable[str]) -> Iterator[str]:
    """Yield the requirements of the project, with extras."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    yield from project["dependencies"]
    for extra in extras:
        yield from project["optional-dependencies"][extra]


if __name__ == "__main__":  # python -m tests.dependencies.floors 3.11 plots rendering ...
    for name, version in floors(requirements_of(sys.argv[2:]), sys.argv[1]).items():
        print(f"{name}=={version}")
