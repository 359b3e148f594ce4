"""This module runs commands, reports errors in one line, and returns the exit code."""

import sys
from collections.abc import Callable

from hav_env.models.text import one_line

FAILURES = (ValueError, TypeError, OSError, ImportError, MemoryError)
"""The errors of wrong options, files and machines; any other is a defect and keeps its trace."""


def report_errors(
    run: Callable[[list[str]], None], words: list[str] | None, interrupted: str = ""
) -> int:
    """Run a command, and report an error in one line.

    Args:
        run: takes the words of the command line.
        words: of the command line, by default the process's.
        interrupted: message after Ctrl-C; none by default.

    Returns:
        The exit code: 0, 2 when something is wrong, 130 when interrupted.
    """
    try:
        run(sys.argv[1:] if words is None else words)
    except FAILURES as error:
        print(f"error: {one_line(str(error) or type(error).__name__)}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        if interrupted:
            print(f"interrupted: {interrupted}", file=sys.stderr)
        return 130
    return 0
