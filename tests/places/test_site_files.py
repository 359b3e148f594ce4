"""A site from a JSON file equals the written one; each wrong entry is named."""

import json

import numpy as np
import pytest

from hav_env import load_site
from hav_env.places import build_site, loading
from hav_env.places.areas import covered_area

SQUARE = [[0, 0], [120, 0], [120, 80], [0, 80]]
POLYGON, LINE, CIRCLE = [[40, 20], [60, 20], [60, 30]], [[80, 0], [80, 25]], [100, 60, 3]
WHOLE = {
    "boundary": SQUARE,
    "obstacles": [{"polygon": POLYGON}, {"circle": CIRCLE}, {"line": LINE}],
}


def load(folder, data, **options):
    (folder / "yard.json").write_text(data if isinstance(data, str) else json.dumps(data))
    return load_site(folder / "yard.json", **options)


def wrong(place, value):
    """Return the whole site with another value in a place, such as obstacles/0/polygon."""
    data = json.loads(json.dumps(WHOLE))
    *way, last = [int(part) if part.isdigit() else part for part in place.split("/")]
    inner = data
    for part in way:
        inner = inner[part]
    inner[last] = value
    return data


def test_a_site_from_a_file_is_the_same(tmp_path):
    site, built = load(tmp_path, WHOLE), build_site(SQUARE, [POLYGON], [LINE], [CIRCLE])
    as_in_file = [0, 1, 3, 2]  # which keeps the order of its obstacles
    for number, other in enumerate(as_in_file):
        own = site.segment[site.outline == number]
        np.testing.assert_array_equal(own, built.segment[built.outline == other])
    assert site.kind.tolist() == built.kind[as_in_file].tolist()


def test_polygons_may_have_holes(tmp_path):
    court = {"polygon": SQUARE, "holes": [[[10, 10], [20, 10], [20, 20], [10, 20]]]}
    site = load(tmp_path, {"obstacles": [court]})
    assert site.kind.tolist() == [1]
    assert covered_area(site).area == pytest.approx(120 * 80 - 100)


def test_a_tolerance_leaves_out_points(tmp_path):
    line = [[0, 0], [5, 0.3], [10, 0]]
    assert load(tmp_path, {"obstacles": [{"line": line}]}).num_segments == 2
    assert load(tmp_path, {"obstacles": [{"line": line}]}, tolerance=0.29).num_segments == 2
    assert load(tmp_path, {"obstacles": [{"line": line}]}, tolerance=0.31).num_segments == 1


BAD = [
    ("[]", r"site is \[\], but must be an object"),
    ("null", "site is None, but must be an object"),
    ("", "not a JSON file"),
    ("{", "not a JSON file"),
    ("{}", "the file has no outline, but must have at least one"),
    ('{"boundary": [], "boundary": []}', "the entry 'boundary' stands twice"),
    ("[" * 10**5, "not a JSON file"),
    (WHOLE | {"havs": []}, "site has the unknown entry 'havs'; known: boundary, obstacles"),
    (wrong("boundary", 5), "site.boundary is 5, but must be an array"),
    (wrong("boundary", []), r"site.boundary is \[\], but must have at least 3 different"),
    (wrong("boundary/2", 5), r"site.boundary\[2\] is 5, but must be an array"),
    (wrong("boundary/2", [1]), r"site.boundary\[2\] has 1 entries, but must have at least 2"),
    (wrong("boundary/2", [1, 2, 3]), r"site.boundary\[2\] has 3 entries, but must have at most 2"),
    (wrong("boundary/2/1", "80"), r"site.boundary\[2\]\[1\] is '80', but must be a number"),
    (wrong("boundary/2/1", None), r"site.boundary\[2\]\[1\] is None, but must be a number"),
    (wrong("boundary/2/1", 1e9), r"site.boundary\[2\] holds 1000000000.0, but must hold numbers"),
    ('{"boundary": [[0, 0], [1, 0], [NaN, 1]]}', r"site.boundary\[2\] holds nan"),
    ('{"boundary": [[0, 0], [1, 0], [1e999, 1]]}', r"site.boundary\[2\] holds inf"),
    ('{"boundary": [[0, 0], [1, 0], [%s, 1]]}' % ("1" * 400), r"site.boundary\[2\] holds 111"),
    (wrong("obstacles", {}), "site.obstacles is {}, but must be an array"),
    (wrong("obstacles/0", 5), r"site.obstacles\[0\] is 5, but must be an object"),
    (wrong("obstacles/0", {}), r"site.obstacles\[0\] is {}, but must have one of: polygon, line"),
    (
        wrong("obstacles/0", {"polygon": POLYGON, "line": LINE}),
        r"site.obstacles\[0\] is .*, but must have one of",
    ),
    (wrong("obstacles/0", {"wall": LINE}), r"obstacles\[0\] has the unknown entry 'wall'"),
    (
        wrong("obstacles/1", {"circle": CIRCLE, "holes": []}),
        r"site.obstacles\[1\] has holes, but only a polygon may",
    ),
    (wrong("obstacles/0/polygon/2", [1, "2"]), r"obstacles\[0\].polygon\[2\]\[1\] is '2'"),
    (wrong("obstacles/0/polygon", [[1, 2]] * 4), r"obstacles\[0\].polygon is .* 3 different"),
    (
        wrong("obstacles/0", {"polygon": POLYGON, "holes": [[]]}),
        r"obstacles\[0\].holes\[0\] is \[\], but must have at least 3",
    ),
    (wrong("obstacles/1/circle", [1, 2]), r"obstacles\[1\].circle has 2 entries, but must have"),
    (wrong("obstacles/1/circle/2", -3), r"obstacles\[1\].circle has radius -3, but must"),
    (wrong("obstacles/2/line", [[1, 2]]), r"obstacles\[2\].line is .* 2 different points"),
    (wrong("obstacles/2/line", None), r"obstacles\[2\].line is None, but must be an array"),
]


@pytest.mark.parametrize(("data", "message"), BAD)
def test_an_entry_that_is_wrong_is_one_line_with_file_and_entry(data, message, tmp_path):
    with pytest.raises(ValueError, match=rf"^\S*yard\.json(:| is).*{message}") as told:
        load(tmp_path, data)
    assert "\n" not in str(told.value)
    assert len(str(told.value)) < 400


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"tolerance": -1.0}, ValueError, "tolerance is -1.0, but must be at least 0 m"),
        ({"tolerance": float("nan")}, ValueError, "tolerance is nan, but must be"),
        ({"tolerance": "half"}, TypeError, "tolerance is half"),
        ({"unknown": "maybe"}, ValueError, "unknown is 'maybe', but must be free or occupied"),
    ],
)
def test_options_that_are_wrong_are_named(options, error, message, tmp_path):
    with pytest.raises(error, match=message):
        load(tmp_path, WHOLE, **options)


@pytest.mark.parametrize("name", ["yard", "yard.pgm", "yard.osm", "yard.JSONX"])
def test_other_endings_are_refused(name, tmp_path):
    with pytest.raises(ValueError, match=r"must end in one of: \.json, \.geojson, \.wkt"):
        load_site(tmp_path / name)


@pytest.mark.parametrize("ending", [".json", ".geojson", ".wkt", ".yaml", ".xml"])
def test_a_file_that_is_missing_or_endless_is_an_error(ending, tmp_path, monkeypatch):
    with pytest.raises(FileNotFoundError, match="nothing"):
        load_site(tmp_path / f"nothing{ending}")
    monkeypatch.setattr(loading, "_MOST_BYTES", 1_000)
    (tmp_path / f"long{ending}").write_bytes(b" " * 100_000)
    with pytest.raises(ValueError, match=rf"long{ending}.* has more than \d+ bytes"):
        load_site(tmp_path / f"long{ending}")


def test_who_lacks_the_extra_is_told_how_to_install_it(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "shapely", None)
    assert load(tmp_path, WHOLE).num_segments == 24  # the project's own form needs none
    with pytest.raises(
        ImportError, match=r"needs shapely: run pip install -e '\.\[maps\]' in the clone"
    ):
        load(tmp_path, WHOLE, tolerance=0.1)
    (tmp_path / "yard.wkt").write_text("LINESTRING (0 0, 1 1)")
    with pytest.raises(
        ImportError, match=r"needs shapely: run pip install -e '\.\[maps\]' in the clone"
    ):
        load_site(tmp_path / "yard.wkt")
