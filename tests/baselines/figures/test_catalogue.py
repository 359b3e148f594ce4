"""The figures of docs/vehicles.md and the pages' tables: the command that makes them."""

import re

import pytest

from baselines.figures.catalogue import main
from baselines.figures.vehicle_tables import dimension_page, turn_table
from hav_env.vehicles import COMBINATIONS, catalogue
from tests.support.budgets import COMPILED
from tests.support.paths import ROOT

PAGE = (ROOT / "docs/vehicles.md").read_text()
DIMENSIONS = (ROOT / "docs/vehicle-dimensions.md").read_text()


@pytest.mark.skipif(not COMPILED, reason="nothing of it is compiled")
def test_the_command_draws_and_writes_what_the_pages_show(tmp_path, capsys):
    assert main(["--output", str(tmp_path / "made")]) == 0
    told = capsys.readouterr().out
    pictures = sorted((tmp_path / "made/images").iterdir())
    assert [picture.name for picture in pictures] == ["vehicle_turns.png", "vehicles.png"]
    for picture in pictures:
        assert picture.read_bytes().startswith(b"\x89PNG")
        assert f"(images/{picture.name})" in PAGE
        assert str(picture) in told
    assert (tmp_path / "made/vehicle-dimensions.md").read_text() == DIMENSIONS
    assert turn_table() in told
    assert turn_table() in PAGE, f"the table of docs/vehicles.md must be\n{turn_table()}"


def test_the_page_of_dimensions_has_every_number_and_a_star_where_it_is_assumed():
    assert dimension_page() == DIMENSIONS
    for name in COMBINATIONS.names():
        vehicle = catalogue(name)
        section = DIMENSIONS.split(f"`{name}`\n")[1].split("\n## ")[0]
        numbers, _, sources = section.partition("\n- ")
        assert numbers.count("\\*") == len(vehicle.assumed)
        for origin in vehicle.origins:
            assert (origin.source or origin.note) in sources
        rows = re.findall(r"^\| (?:truck|\d+) \|.*$", numbers, re.MULTILINE)
        lengths = [float(row.split("|")[2].strip().removesuffix("\\*")) for row in rows]
        assert lengths == pytest.approx(vehicle.lengths, rel=1e-3)


def test_an_output_that_is_a_file_is_refused_in_one_line(capsys):
    assert main(["--output", __file__]) == 2
    told = capsys.readouterr().err
    assert told.startswith("error: ")
    assert "is a file, but must be a folder" in told
    assert told.count("\n") == 1
