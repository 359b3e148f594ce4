"""This module makes text safe to show: names may hold line breaks and escape sequences."""

from collections.abc import Callable, Iterable

_LEAST_LIKENESS = 0.7  # of a suggestion: 1 for equal words, 0 for words without a common letter


def visible(text: str) -> str:
    r"""Return a text with escapes for characters that a terminal would interpret.

    Line breaks, escape sequences, marks that reverse the direction of writing and broken characters
    of file names become ``\n``, ``\x1b``, ``\u202e`` and ``\udcff``.
    """
    return "".join(
        c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text
    )


def one_line(text: str) -> str:
    """Return a message as one line."""
    return visible(" ".join(text.split()))


def suggest(name: str, names: Iterable[str], form: Callable[[str], str] = str) -> str:
    """Return `` (did you mean 'x'?)`` with the name that is nearest, or nothing where none is.

    Args:
        name: The wrong name.
        names: The right names.
        form: Function from the nearest name to the suggestion.
    """
    # a misspelt name is rare, and difflib takes its time
    import difflib  # noqa: PLC0415

    right = {known.casefold(): known for known in names}
    near = difflib.get_close_matches(name.casefold(), right, 1, _LEAST_LIKENESS)
    return f" (did you mean {form(right[near[0]])!r}?)" if near else ""
