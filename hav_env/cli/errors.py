"""This module runs commands, reports errors in one line, and returns the exit code."""

import io
import os
import sys
from collections.abc import Callable

from hav_env.models.text import one_line

FAILURES = (ValueError, TypeError, OSError, ImportError, MemoryError)
"""Errors of options, files and machines; any other error is a defect and keeps its traceback."""


def report_errors(
    run: Callable[[list[str]], None], words: list[str] | None, interrupted: str = ""
) -> int:
    """Run a command, and report an error in one line.

    Args:
        run: Function of the words of the command line.
        words: Words of the command line, by default those of the process.
        interrupted: Message after Ctrl-C; none by default.

    Returns:
        The exit code: 0, 2 after an error, 130 after Ctrl-C.
    """
    _replace_unknown_characters()
    try:
        run(sys.argv[1:] if words is None else words)
    except BrokenPipeError:  # the reader of the pipe has closed it
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except FAILURES as error:
        told = str(error) or type(error).__name__
        if isinstance(error, FileNotFoundError) and error.filename is not None:
            told = f"there is no file or folder {os.fspath(error.filename)!r}"
        print(f"error: {one_line(told)}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        if interrupted:
            print(f"interrupted: {interrupted}", file=sys.stderr)
        return 130
    return 0


def _replace_unknown_characters() -> None:
    """Let the output show ? for characters that its encoding lacks, such as the rule of a table.

    The error of Python would come after all episodes, and the table would be lost.
    """
    out = sys.stdout
    if isinstance(out, io.TextIOWrapper) and out.errors in ("strict", "surrogateescape"):
        out.reconfigure(errors="replace")
