"""This module turns errors of Numba into one line with the file and the line to fix."""

import os
import pathlib
import re
import sysconfig

_PLACE = re.compile(r'File "([^"]+)", line (\d+)|\bat (\S+\.py) \((\d+)\)')
_COLOR = re.compile(r"\x1b\[[0-9;]*m")  # Numba writes colours where colorama is installed
_LINES_ASIDE = re.compile(
    r"^(During: |File |-+%<|<source missing|\[|Failed in nopython|def |@|\^|$)"
)
# lines of Numba's message that state the problem, not the path to it
_TELLING = re.compile(
    r"(?i)nameerror|untyped global|unknown attribute|cannot unify|is not defined|NRT required"
)
# reasons that Numba states in words of its own
_PLAIN = {
    "NRT required but not enabled": "this allocates memory, as a list, a dictionary or an array"
    " does, but compiled code has numbers and tuples only"
}
_ROOT = pathlib.Path(__file__).parents[2]
_PROJECT_FILES = tuple(f"{_ROOT / top}{os.sep}" for top in ("hav_env", "baselines"))
_LONGEST_REASON = 300  # longest part of Numba's message [characters]


def explain(name: str, error: Exception) -> str:
    """Return the name of the code that Numba cannot compile, the reason and the line, as one line.

    Args:
        name: Name of the entry being compiled.
        error: Numba's error, whose text lists places from the innermost to the outermost caller.
    """
    text = _COLOR.sub("", str(error))
    libraries = tuple(sysconfig.get_paths()[key] for key in ("stdlib", "purelib", "platlib"))
    found = [(file or at, line or number) for file, line, at, number in _PLACE.findall(text)]
    places = [place for place in found if not os.path.abspath(place[0]).startswith(libraries)]
    theirs = [place for place in places if not os.path.abspath(place[0]).startswith(_PROJECT_FILES)]
    file, line = (theirs[:1] or places[-1:] or [("", "")])[0]
    where = f" ({file}, line {line})" if file else ""
    lines = [line.strip() for line in text.splitlines()]
    telling = [line for line in lines if _TELLING.search(line)]
    reasons = telling[-1:] or [line for line in lines if line and not _LINES_ASIDE.match(line)]
    reason = " ".join(_PLAIN.get(reason, reason) for reason in reasons)
    return f"cannot compile {name}: {reason[:_LONGEST_REASON]}{where}"
