"""This module says where the project's files are, for tests of what ships."""

import pathlib

ROOT = pathlib.Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
