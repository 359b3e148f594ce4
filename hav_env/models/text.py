"""This module makes text safe to show: names may hold line breaks and escape sequences."""


def visible(text: str) -> str:
    r"""Return a text in which characters that no terminal should act on are written out.

    Line breaks, escape sequences, marks that reverse the direction of writing and broken characters
    of file names become ``\n``, ``\x1b``, ``\u202e`` and ``\udcff``.
    """
    return "".join(
        c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text
    )


def one_line(text: str) -> str:
    """Return a message as one line."""
    return visible(" ".join(text.split()))
