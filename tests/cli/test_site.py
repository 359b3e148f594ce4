"""The command ``site`` prints the contents of a file, and draws the allowed places of HAVs."""

import numpy as np
import pytest
import shapely
from PIL import Image

from hav_env.__main__ import main
from hav_env.cli.site_picture import draw_site
from hav_env.places import load_site
from hav_env.places.areas import covered_area, free_area
from hav_env.rendering.colors import CALM, GROUND, PALE, PAPER
from tests.support.paths import EXAMPLES


@pytest.mark.parametrize("name", ["yard.geojson", "hall.yaml", "junction.xml"])
def test_a_file_is_described_and_drawn(name, tmp_path, capsys):
    picture = tmp_path / "site.png"
    assert main(["site", str(EXAMPLES / name), "--draw", str(picture)]) == 0
    site = load_site(EXAMPLES / name)
    told = dict(line.split(None, 1) for line in capsys.readouterr().out.splitlines())
    assert told["segments"] == str(site.num_segments)
    assert told["polygons"] == f"{(site.kind == 1).sum()}, {covered_area(site).area:,.2f} m2"
    left, low, right, high = site.bounds
    assert told["bounds"] == f"x {left:.3f} to {right:.3f} m, y {low:.3f} to {high:.3f} m"
    with Image.open(picture) as drawn:
        np.testing.assert_array_equal(np.asarray(drawn), draw_site(site, name))


@pytest.mark.parametrize("name", ["yard.geojson", "hall.yaml"])
def test_the_picture_shows_where_havs_may_be(name):
    site = load_site(EXAMPLES / name)
    picture, free = draw_site(site, name), free_area(site)
    rng = np.random.default_rng(0)
    low, high = np.array(site.bounds).reshape(2, 2)
    # as the camera sees it: the middle of the site in the middle of the picture
    size = np.array(picture.shape[1::-1])
    scale = min((size - 80) / np.maximum(high - low, 24.0))
    for place in rng.uniform(low, high, (300, 2)):
        if shapely.LineString(site.segment.reshape(-1, 2)).distance(shapely.Point(place)) < 0.3:
            continue
        column, row = ((place - (low + high) / 2) * (scale, -scale) + size / 2).astype(int)
        covered = covered_area(site).contains(shapely.Point(place))
        beyond = PALE if free is not None and not free.contains(shapely.Point(place)) else None
        ground = CALM if covered else beyond or (GROUND if free is None else PAPER)
        near = np.abs(picture[row, column].astype(int) - ground).max()
        assert near < 40 or (row < 30 and column < 400)  # the grid; the name of the file


def test_options_change_what_is_read(capsys):
    def segments(*options):
        assert main(["site", str(EXAMPLES / "hall.yaml"), *options]) == 0
        (line,) = [t for t in capsys.readouterr().out.splitlines() if t.startswith("segments")]
        return int(line.split()[1])

    assert segments("--tolerance", "0") > segments() > segments("--tolerance", "1")
    assert segments("--unknown", "occupied") != segments()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["nothing.json"], "there is no file or folder 'nothing.json'"),
        (["yard.txt"], "yard.txt ends in '.txt', but must end in one of"),
        (["yard.json", "--draw", "yard.gif"], "draw is 'yard.gif', but must end in .png"),
        (["yard.json", "--tolerance", "-1"], "tolerance is -1.0, but must be at least 0 m"),
        (["yard.json", "--unknown", "maybe"], "unknown"),
        ([], "missing"),
    ],
)
def test_mistakes_are_one_line(arguments, message, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "yard.json").write_text('{"boundary": [[0, 0], [9, 0], [9, 9]]}')
    assert main(["site", *arguments]) == 2
    told = capsys.readouterr().err
    assert told.startswith("error: ")
    assert message.lower() in told.lower()
    assert told.count("\n") == 1
