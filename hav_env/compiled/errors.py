"""This module turns errors of Numba into one line with the file and the line to fix."""

import os
import pathlib
import re
import sysconfig

_PLACE = re.compile(r'File "([^"]+)", line (\d+)')
_LINES_ASIDE = re.compile(
    r"^(During: |File |-+%<|<source missing|\[|Failed in nopython|def |@|\^|$)"
)
# lines of Numba's message that state the problem, not the path to it
_TELLING = re.compile(r"(?i)nameerror|untyped global|unknown attribute|cannot unify|is not defined")
_ROOT = pathlib.Path(__file__).parents[2]
_PROJECT_FILES = tuple(f"{_ROOT / top}{os.sep}" for top in ("hav_env", "baselines"))
_LONGEST_REASON = 300  # longest part of Numba's message [characters]


def explain(name: str, error: Exception) -> str:
    """Return the name of the code that Numba cannot compile, the reason and the line, as one line.

    Args:
        name: Name of the entry being compiled.
        error: Numba's error, whose text lists places from the outermost caller to the innermost.
    """
    text = str(error)
    libraries = tuple(sysconfig.get_paths()[key] for key in ("stdlib", "purelib", "platlib"))
    places = [place for place in _PLACE.findall(text) if not place[0].startswith(libraries)]
    theirs = [place for place in places if not place[0].startswith(_PROJECT_FILES)]
    file, line = (theirs or places or [("", "")])[-1]
    where = f" ({file}, line {line})" if file else ""
    lines = [line.strip() for line in text.splitlines()]
    telling = [line for line in lines if _TELLING.search(line)]
    reasons = telling[-1:] or [line for line in lines if line and not _LINES_ASIDE.match(line)]
    return f"cannot compile {name}: {' '.join(reasons)[:_LONGEST_REASON]}{where}"
