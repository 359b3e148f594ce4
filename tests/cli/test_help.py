"""Help is plain text for 80 columns; mistakes in options are explained in one line."""

import dataclasses
import re
from typing import Literal

import pytest

from hav_env.cli.options import parse_options


@dataclasses.dataclass
class Trip:
    """The options of a trip."""

    length: float = 1.5
    """Length of the way [m], which is described in so many words that its help does not fit a line
    of a terminal, and continues ``below``."""
    stops: int | None = None
    """Stops; by default none."""
    road: Literal["wide", "narrow"] = "wide"
    fast: bool = False
    """Drive fast."""
    lit: bool = True
    """Drive with lights."""


def parse(*words, **names):
    return parse_options(Trip, "hav-env trip PLACE", "Drive.", list(words), Trip(), names or None)


def test_options_are_read():
    assert parse("--length", "2", "--road", "narrow") == Trip(2.0, road="narrow")


def test_help_is_plain_and_fits_a_terminal(capsys):
    with pytest.raises(SystemExit) as stop:
        parse("--help", PLACE="here, there.")
    assert stop.value.code == 0
    told = capsys.readouterr().out
    assert max(map(len, told.splitlines())) <= 80
    assert told.startswith("usage: hav-env trip PLACE [OPTIONS]\n\nDrive.\n\nnames\n  PLACE\n")
    assert "so many words that its help does not fit" in " ".join(told.split())
    assert "continues below. (default: 1.5)" in " ".join(told.split())
    assert "\n  --stops INT\n      Stops; by default none.\n" in told
    assert "\n  --fast\n" in told
    assert "\n  --no-lit\n" in told
    assert "None" not in told
    assert not set(told) & set("│╭╯`")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--lenght", "3"], "unknown option --lenght (did you mean '--length'?)"),
        (["--zzzzzz"], "unknown option --zzzzzz"),
        (["--lights"], "unknown option --lights (did you mean '--lit'?)"),
        (["--narrow"], "unknown option --narrow (did you mean '--road'?)"),
        (["--lng", "3"], "unknown option --lng"),
        (["--length=far"], "--length is 'far', but must be a number"),
        (["--length="], "--length is '', but must be a number"),
        (
            ["--length", "3", "home"],
            "unexpected 'home': options begin with --, and names stand before them",
        ),
        (["--length", "far"], "--length is 'far', but must be a number"),
        (["--length"], "--length needs a value behind it: a number"),
        (["--stops", "1.5"], "--stops is '1.5', but must be a whole number"),
        (["--road", "long"], "--road is 'long', but must be wide or narrow"),
    ],
)
def test_a_mistake_is_explained_in_one_line(words, message):
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        parse(*words)
