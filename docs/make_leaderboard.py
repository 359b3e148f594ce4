"""This module ranks the entries of the leaderboard, and writes them into docs/leaderboard.md.

``python docs/make_leaderboard.py FOLDER ...`` adds the tables of ``hav-env evaluate --output
FOLDER``, which docs/leaderboard.md describes. Without a folder it writes the page again.
"""

import json
import math
import pathlib
import re
import sys
from typing import Any

from baselines.evaluation.run_description import describe_model
from hav_env import Task, find_scenario
from hav_env.cli.errors import report_errors
from hav_env.evaluation.comparison import read_columns
from hav_env.evaluation.figures import Figure, figures_of, measure
from hav_env.vehicles import VEHICLES
from hav_env.world.event_table import HARM

PAGE = pathlib.Path(__file__).parent / "leaderboard.md"
ENTRIES = pathlib.Path(__file__).parent / "catalogue" / "leaderboard.json"
SEED = 2026
LEAST_EPISODES = {
    **dict.fromkeys(("paper-single", "paper-pair"), 500),
    **dict.fromkeys(("swarm-20", "dense-20", "docks-6", "junction-4"), 100),
}
"""The scenarios of all tracks, with the least number of episodes of an entry."""
_REALISTIC = ("docks-6", "junction-4")
MOST_HARM = 0.001
"""Share of HAVs below which a policy counts as safe, of each harmful event."""
_HARM = [event.label for event in HARM]


def read_entries(folder: pathlib.Path) -> dict[str, dict[str, dict]]:
    """Return the entries in a folder of ``hav-env evaluate --output``, by scenario and policy.

    Raises:
        ValueError: If the folder holds no table, or one that breaks the rules of the page.
    """
    found: dict[str, dict[str, dict]] = {}
    for path in sorted(folder.glob("*.parquet")):
        told = json.loads(path.with_suffix(".json").read_text())
        name = _scenario_of(path, told)
        vehicle = VEHICLES.make("realistic" if name in _REALISTIC else "on_axle")
        rules = {"seed": SEED, "task": _described(Task()), "vehicle": _described(vehicle)}
        for field, value in rules.items():
            if told[field] != value:
                raise ValueError(f"{path} has {field} {told[field]}, but must have {value}")
        if told["num_episodes"] < LEAST_EPISODES[name]:
            rule = f"but must have at least {LEAST_EPISODES[name]}"
            raise ValueError(f"{path} has {told['num_episodes']} episodes, {rule}")
        found.setdefault(name, {})[_label(path.stem, told)] = _figures(path, told)
    if not found:
        raise ValueError(f"{folder} has no table of hav-env evaluate --output")
    return found


def _described(model: Any) -> Any:
    """Return the description of a model as JSON has it."""
    return json.loads(json.dumps(describe_model(model)))


def _scenario_of(path: pathlib.Path, told: dict[str, Any]) -> str:
    for name in LEAST_EPISODES:
        if _described(find_scenario(name)) == told["scenario"]:
            return name
    raise ValueError(f"{path} has another scenario than {', '.join(LEAST_EPISODES)}")


def _label(name: str, told: dict[str, Any]) -> str:
    """Return the name of an entry, with its guidance, its filter and its backup."""
    parts = []
    if told["guidance"]["type"] != "Dubins":
        parts.append(f"guidance {told['guidance']['type'].lower()}")
    policy = told["policy"]
    if policy["type"] == "Filtered":
        if policy["safety"]["type"] == "SafetyFilter":
            parts.append(f"filter {policy['safety']['against']}")
        if policy["backup"]["type"] != "NoBackup":
            parts.append(f"backup {policy['backup']['type'].lower()}")
    return f"{name} ({', '.join(parts)})" if parts else name


def _figures(path: pathlib.Path, told: dict[str, Any]) -> dict[str, Any]:
    """Return the figures of an entry; each is a value with the ends of its interval."""
    table = read_columns(path)
    known: dict[str, Figure] = {figure.name: figure for figure in figures_of(table)}
    goals = [name for name in known if re.fullmatch(r"goal \d+ hit", name)]
    wanted = [*(name for name in _HARM if name in known), goals[-1], goals[-1][:-3] + "step"]
    # None without a value: no HAV has hit its last goal
    measured = {name: measure(table, known[name]) for name in wanted}
    figures = {
        re.sub(r"^goal \d+", "last goal", name): list(one[:3]) if one.size else None
        for name, one in measured.items()
    }
    return {"episodes": told["num_episodes"], "code": told["code"], "figures": figures}


def is_safe(entry: dict[str, Any]) -> bool:
    """Return whether all shares of harmful events of an entry are below ``MOST_HARM``."""
    return all(entry["figures"][name][0] < MOST_HARM for name in _HARM if name in entry["figures"])


def rank(entries: dict[str, dict]) -> list[str]:
    """Return the names of the entries of a scenario, the best first.

    Safe entries come first. Then the share of last goals hit decides, then the steps to them.
    """

    def key(name: str) -> tuple:
        figures = entries[name]["figures"]
        steps = (figures["last goal step"] or [math.inf])[0]
        return not is_safe(entries[name]), -figures["last goal hit"][0], steps, name

    return sorted(entries, key=key)


def show_ranking(entries: dict[str, dict[str, dict]]) -> str:
    """Return the tables of all scenarios, in Markdown."""
    parts = []
    for name in (name for name in LEAST_EPISODES if name in entries):
        harm = [one for one in _HARM if any(one in e["figures"] for e in entries[name].values())]
        head = ["rank", "policy", "safe", "last goal hit", *harm, "steps to last goal"]
        rule = ["--:", "---", "---", *["--:"] * (len(head) - 3)]
        rows = [head, rule, *(_row(entries[name], k, harm) for k in range(len(entries[name])))]
        parts += [f"### {name}", "", *(f"| {' | '.join(row)} |" for row in rows), ""]
    return "\n".join(parts)


def _row(entries: dict[str, dict], place: int, harm: list[str]) -> list[str]:
    """Return the cells of a place in the ranking."""
    policy = rank(entries)[place]
    figures = entries[policy]["figures"]
    shares = [_percent(figures[name]) for name in ("last goal hit", *harm)]
    steps = figures["last goal step"]
    safe = "yes" if is_safe(entries[policy]) else "no"
    return [str(place + 1), f"`{policy}`", safe, *shares, f"{steps[0]:,.0f}" if steps else "-"]


def _percent(share: list[float]) -> str:
    value, low, high = (100 * x for x in share)
    return f"{value:.2f} % [{low:.2f}, {high:.2f}]"


def with_ranking(text: str, entries: dict[str, dict[str, dict]]) -> str:
    """Return the text of the page with the tables of these entries."""
    begin, end = "<!-- ranking -->\n", "<!-- end of ranking -->"
    before, _, rest = text.partition(begin)
    return f"{before}{begin}\n{show_ranking(entries)}\n{end}{rest.partition(end)[2]}"


def main(words: list[str]) -> None:
    """Add the entries of folders, and write the page."""
    entries = json.loads(ENTRIES.read_text()) if ENTRIES.exists() else {}
    for word in words:
        for name, new in read_entries(pathlib.Path(word)).items():
            entries.setdefault(name, {}).update(new)
    ENTRIES.write_text(json.dumps(entries, indent=1, sort_keys=True) + "\n")
    PAGE.write_text(with_ranking(PAGE.read_text(), entries))
    print(show_ranking(entries))


if __name__ == "__main__":
    sys.exit(report_errors(main, None))
