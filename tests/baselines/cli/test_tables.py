"""Tables fit a terminal, and lose nothing by it."""

import csv
import io

import pytest

from baselines.cli.tables import plain_table, print_table
from hav_env import RandomFleet, RandomPoses
from hav_env.models.changes import changes_of, name_with_changes

ROWS = [["", *(f"policy {k}" for k in range(7))]] + [
    [name, *(f"{name[0]}{k} ± 1,000 steps" for k in range(7))] for name in ("hit", "missed, all")
]


@pytest.mark.parametrize("width", [40, 80, 200])
def test_a_table_keeps_its_cells_within_the_width(width):
    told = plain_table(ROWS, width)
    assert max(map(len, told.splitlines())) <= width
    for row in ROWS:
        for cell in row[1:]:
            assert told.count(cell) == 1
    parts = told.split("\n\n")
    assert all(ROWS[2][0] in part for part in parts)


def test_a_table_may_be_read_by_programs(capsys):
    print_table(ROWS, "all", "csv")
    assert list(csv.reader(io.StringIO(capsys.readouterr().out))) == ROWS
    print_table(ROWS, "all", "md")
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "all"
    assert [line.count("|") for line in lines[2:]] == [9] * 4


def test_only_what_was_changed_is_named():
    usual = RandomPoses(num_havs=2)
    changed = usual._replace(num_goals=1, fleet=RandomFleet(max_trailers=3))
    assert name_with_changes("pair", usual, RandomPoses(num_havs=2)) == "pair"
    assert name_with_changes("pair", changed, usual) == "pair (num_goals=1, fleet.max_trailers=3)"
    assert not list(changes_of(changed, changed))
