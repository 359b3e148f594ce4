"""This module lists the names of models, each with its meaning, without loading any of them."""

import importlib.metadata
import textwrap

from hav_env.cli.built_in_names import MEANINGS
from hav_env.cli.errors import report_errors
from hav_env.cli.meanings import meaning_of
from hav_env.models.names import USES
from hav_env.models.text import suggest

_WIDTH, _NAMES = 80, 20  # characters of a line, and least of the column of names
_HEADS = {
    "policies": ("policy", "hav_env.policies", f"{USES['policy']} ...; also FILE.policy"),
    "scenarios": ("scenario", "hav_env.scenarios", f"{USES['scenario']}; also FILE.json"),
    "sites": ("site", "", f"{USES['scenario']} --vehicle realistic"),
    "vehicles": ("vehicle", "hav_env.vehicles", USES["vehicle"]),
    "guidance": ("guidance", "hav_env.guidances", USES["guidance"]),
    "rewards": ("reward", "hav_env.rewards", f"{USES['reward']}, of play and train"),
}
_CATALOGUE = "catalogue"
_LIST_END = """Each option also takes module:Class, a model of your own.
Parameters may stand behind a name: hav-env evaluate reserve reserve:patience=5
hav-env list catalogue shows real vehicles for any scenario (--fleet NAME)."""


def main(words: list[str]) -> int:
    """List the names of policies, scenarios, vehicles and other models."""
    return report_errors(_list_names, words)


def _list_names(words: list[str]) -> None:
    kinds = [*_HEADS, _CATALOGUE]
    if {"-h", "--help"} & set(words):
        known = f"KIND is one of {', '.join(kinds)}. Without one, all but the catalogue are listed."
        lines = textwrap.wrap(known, _WIDTH)
        print("\n".join(["usage: hav-env list [KIND ...]", "", main.__doc__ or "", "", *lines]))
        return
    for word in words:
        if word not in kinds:
            told = f"kind is {word!r}, but must be one of {', '.join(kinds)}"
            raise ValueError(told + suggest(word, kinds))
    parts = [_catalogue() if kind == _CATALOGUE else show_kind(kind) for kind in words or _HEADS]
    print("\n\n".join(parts if words else [*parts, _LIST_END]))


def names_of_kind(kind: str) -> dict[str, str]:
    """Return the meanings of all names of a kind, such as "policies"; other packages come last."""
    key, group, _ = _HEADS[kind]
    entries = importlib.metadata.entry_points(group=group) if group else ()
    added = {entry.name: meaning_of(entry) for entry in entries if entry.name[0] != "."}
    return {**MEANINGS.get(key, {}), **added}


def show_kind(kind: str) -> str:
    """Return the names of a kind as text, a line each."""
    return _section(kind, _HEADS[kind][2], names_of_kind(kind))


def _catalogue() -> str:
    # the catalogue of vehicles loads the compiler
    from hav_env.vehicles import COMBINATIONS  # noqa: PLC0415

    titles = {name: COMBINATIONS.find(name).title for name in COMBINATIONS.names()}
    return _section(_CATALOGUE, f"{USES['combination']}; also FILE.json", titles)


def _section(head: str, use: str, meanings: dict[str, str]) -> str:
    wide = max(_NAMES, *(len(f"  {name}  ") for name in meanings))
    lines = [f"{head.upper():{wide}}{use}"]
    for name, meaning in meanings.items():
        lead = f"  {name} ".ljust(wide)
        lines += textwrap.wrap(lead + meaning, _WIDTH, subsequent_indent=" " * wide) or [lead]
    return "\n".join(lines)
