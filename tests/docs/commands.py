"""This module runs commands of documents as they are typed, with options that shorten them."""

import re
import shlex

from hav_env.__main__ import main
from tests.support.paths import ROOT


def blocks(path: str, language: str) -> list[str]:
    """Return the fenced blocks of a language in a document of the project."""
    text = (ROOT / path).read_text()
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)


def commands(path: str, *names: str) -> list[str]:
    """Return the lines ``hav-env NAME ...`` of the shell blocks of a document."""
    lines = "".join(blocks(path, "bash")).splitlines()
    return [line for line in lines if line.startswith(tuple(f"hav-env {name}" for name in names))]


def run(command: str, *options: str) -> int:
    """Run a line as it is typed, and more options behind it; return the exit code."""
    program, *words = shlex.split(command)
    assert program == "hav-env"
    return main([*words, *options])
