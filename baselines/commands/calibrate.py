"""This module is ``hav-env calibrate``: readings of the paper beside its figures."""

import pathlib

from baselines.cli.options import read_options
from baselines.cli.run_options import RESUMED, Run, check_folder
from baselines.cli.tables import print_table
from baselines.experiments.calibrate import calibrate
from baselines.experiments.search import FITTING_SEED, search
from baselines.experiments.search_report import compare_words, names_of, show_found
from hav_env.cli.errors import report_errors
from hav_env.models.text import visible

_USAGE = "hav-env calibrate [--search]"
_ABOUT = (
    "Measure readings of the paper, and each of its open choices, beside its figures. With"
    " --search, search for readings near the figures, about half an hour: --seed fits them, and the"
    " next three seeds confirm."
)


def main(words: list[str]) -> int:
    """Measure readings of the paper and its open choices."""
    return report_errors(_calibrate, words, RESUMED)


def _calibrate(arguments: list[str]) -> None:
    if "--search" in arguments:
        _search([word for word in arguments if word != "--search"])
        return
    options = read_options(
        _USAGE,
        _ABOUT,
        arguments,
        [("experiments", int, 1_000, "Experiments of each scenario and row.")],
        Run(pathlib.Path("results/calibrate")),
    )
    check_folder(options)
    rows = calibrate(
        options.experiments, options.seed, options.output, options.threads, options.overwrite
    )
    print_table(rows, f"{options.experiments} experiments of each scenario and row", options.format)
    print(f"table: {visible(str(options.output))}/calibration.parquet")


def _search(arguments: list[str]) -> None:
    common = Run(pathlib.Path("results/search"), FITTING_SEED)
    options = read_options(_USAGE, _ABOUT, arguments, [], common)
    check_folder(options)
    found = search(options.seed, options.output, options.threads, options.overwrite)
    print_table(
        show_found(found),
        f"{len({one.reading.name for one in found}):,} readings tried",
        options.format,
    )
    for number, name in enumerate(names_of(found), 1):
        print(f"{number}: {name}")
    print_table(
        compare_words(found, options.threads), "the paper's words, in pairs", options.format
    )
    print(f"table: {visible(str(options.output))}/search.parquet")
