"""This module turns errors of Numba into one line that names the file and the line to look at."""

import re
import sysconfig

_PLACE = re.compile(r'File "([^"]+)", line (\d+)')
_LINES_ASIDE = re.compile(
    r"^(During: |File |-+%<|<source missing|\[|Failed in nopython|def |@|\^|$)"
)
_LONGEST_REASON = 300  # characters of Numba's message


def explain(name: str, error: Exception) -> str:
    """Return what Numba cannot compile, why, and where that stands, in one line.

    Args:
        name: of the entry that is compiled.
        error: of Numba, whose text names places from the outermost caller to the innermost.
    """
    text = str(error)
    libraries = tuple(sysconfig.get_paths()[key] for key in ("stdlib", "purelib", "platlib"))
    places = [place for place in _PLACE.findall(text) if not place[0].startswith(libraries)]
    where = f" at {places[-1][0]}:{places[-1][1]}" if places else ""
    lines = [line.strip() for line in text.splitlines()]
    reasons = [line for line in lines if line and not _LINES_ASIDE.match(line)]
    return f"cannot compile {name}{where}: {' '.join(reasons)[:_LONGEST_REASON]}"
