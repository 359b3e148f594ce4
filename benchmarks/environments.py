"""This module measures how fast the environments step, beside others and beside empty ones.

``python -m benchmarks.environments`` prints the tables of benchmarks/README.md.
"""

import functools
import importlib.util
import json
import pathlib
from typing import Annotated

import tyro
from rich.console import Console

from benchmarks.interfaces import fresh_process
from benchmarks.interfaces.aims import Aim, Key, Rates, find_aims
from benchmarks.interfaces.clocks import Run
from benchmarks.interfaces.faces import (
    FEW_WORLDS,
    MPE_STEPS,
    SHORT,
    SWARM,
    Vector,
    prepare_singles,
    prepare_vector_row,
    vector_rows,
)
from benchmarks.interfaces.peers import Peer, missing_packages, prepare_peers
from benchmarks.tables import new_table, rate_text
from benchmarks.turns import medians_in_turns

_SB3_WORLDS = 512


def show(console: Console, rates: Rates, loaded: list[str], found: list[Aim]) -> None:
    """Print the figures as tables and lines."""
    rows = [key for key in rates if isinstance(key, Vector)]
    columns = list(dict.fromkeys(row.column for row in rows if row.num_worlds >= FEW_WORLDS))
    table = new_table("vector environments, agent-steps/s", "what", "worlds", *columns)
    for name, count in dict.fromkeys((row.name, row.num_worlds) for row in rows):
        own = {row.column: rates[row] for row in rows if row[:2] == (name, count)}
        table.add_row(name, f"{count:,}", *(rate_text(own.get(column)) for column in columns))
    table.caption = "HAVSwarm-v0 and HAVVecEnv: 2 HAVs a world; HAVSingle-v0: 1"
    console.print(table)
    table = new_table("one world, agent-steps/s", "what", "agent-steps/s")
    for key, rate in rates.items():
        if isinstance(key, str):
            table.add_row(key, rate_text(rate))
    console.print(table)
    if any(isinstance(key, Peer) for key in rates):
        table = new_table("peers on their own tasks, agent-steps/s", "what", "agent-steps/s")
        for key, rate in rates.items():
            if isinstance(key, Peer):
                table.add_row(str(key), rate_text(rate))
        console.print(table)
    missing = missing_packages()
    if not importlib.util.find_spec("stable_baselines3"):
        missing.append("stable-baselines3")
    for package in missing:
        console.print(f"{package} is not installed: its rows are missing")
    heavy = ", ".join(fresh_process.HEAVY)
    console.print(f"import hav_env loads, of {heavy}: {', '.join(loaded) or 'nothing'}")
    show_aims(console, found)


def show_aims(console: Console, found: list[Aim]) -> None:
    """Print the aims beside the measurements."""
    table = new_table("aims", "what", "wanted", "measured", "short episodes", "reached")
    words = {True: "yes", False: "no", None: "not measured"}
    for aim in found:
        cells = (figure_text(aim.measured, aim.unit), figure_text(aim.often_reset, aim.unit))
        table.add_row(aim.what, aim.wanted, *cells, words[aim.reached])
    table.caption = (
        f"vector: {SWARM}, 2 threads, its best from {FEW_WORLDS:,} worlds on; peers: their best\n"
        f"short episodes: of {SHORT} steps; for PettingZoo of {MPE_STEPS} steps, as MPE2's are"
    )
    console.print(table)


def figure_text(value: float | None, unit: str) -> str:
    """Return a rate, ratio or time as text."""
    if value is None:
        return ""
    return f"{value:,.0f}{unit}" if unit == "/s" else f"{value:.2f}{unit}"


def main(
    quick: bool = False,
    repetitions: int = 3,
    seconds: float = 0.5,
    json_file: Annotated[pathlib.Path | None, tyro.conf.arg(name="json")] = None,
) -> None:
    """Measure the environments and those for comparison.

    Args:
        quick: Whether to run one short repetition with at most 1,024 worlds, as a smoke test.
        repetitions: Repetitions of every measurement; the tables show medians.
        seconds: Duration of one measurement [s].
        json_file: File for the figures.
    """
    counts, singles, peers = (1, 64, 1_024, 4_096, 16_384), (1_024, 16_384), (1_024, 4_096, 16_384)
    if quick:
        repetitions, seconds = 1, 0.05
        counts, singles, peers = counts[:3], singles[:1], peers[:1]
    runs: dict[Key, Run] = {
        row: prepare_vector_row(row) for row in vector_rows(counts, singles, _SB3_WORLDS)
    }
    runs |= prepare_singles() | prepare_peers(peers)
    timed = {key: functools.partial(run, seconds) for key, run in runs.items()}
    rates = medians_in_turns(timed, repetitions)
    imported, loaded = fresh_process.import_seconds(1 if quick else 5)
    found = find_aims(rates, imported)
    show(Console(width=120), rates, loaded, found)
    if json_file:
        json_file.write_text(json.dumps(as_json(rates, imported, loaded, found), indent=2) + "\n")


def as_json(rates: Rates, imported: float, loaded: list[str], found: list[Aim]) -> dict:
    """Return the figures as JSON values."""
    rows = [(key, rate) for key, rate in rates.items()]
    return {
        "vector": [{**k._asdict(), "rate": rate} for k, rate in rows if isinstance(k, Vector)],
        "one_world": {key: rate for key, rate in rows if isinstance(key, str)},
        "peers": [{**k._asdict(), "rate": rate} for k, rate in rows if isinstance(k, Peer)],
        "import_seconds": imported,
        "import_loads": loaded,
        "aims": [{**aim._asdict(), "reached": aim.reached} for aim in found],
    }


if __name__ == "__main__":
    tyro.cli(main)
