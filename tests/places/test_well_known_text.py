"""Well-known text becomes the site that Shapely reads in it."""

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from hav_env import load_site
from hav_env.places import LINE, POLYGON
from hav_env.places.areas import covered_area
from hav_env.places.formats.well_known_text import read_wkt
from hav_env.places.simplification import simplify_outlines
from hav_env.places.site import join_outlines
from tests.places.shapes import CHAINS, lines_of, stars
from tests.support.budgets import budget


@settings(max_examples=budget(60, 25))
@given(st.lists(stars(), min_size=1, max_size=3), CHAINS, st.sampled_from([0.0, 0.2, 2.0]))
def test_geometries_come_back_within_the_tolerance(polygons, chain, tolerance):
    shapes = [*map(shapely.Polygon, polygons), shapely.LineString(chain)]
    text = "\n".join(shapely.to_wkt(shape, rounding_precision=-1) for shape in shapes)
    site = join_outlines(simplify_outlines(read_wkt(text), tolerance))
    written = shapely.union_all([shapes[-1], *(shape.exterior for shape in shapes[:-1])])
    assert shapely.hausdorff_distance(lines_of(site), written, densify=0.05) <= tolerance + 1e-9
    if tolerance == 0.0:
        union = shapely.union_all(shapes[:-1])
        assert covered_area(site).symmetric_difference(union).area < 1e-6


def test_every_kind_of_geometry_is_read(tmp_path):
    text = """\ufeff# a yard
POLYGON ((0 0, 9 0, 9 9, 0 9, 0 0), (3 3, 6 3, 6 6, 3 3))

LINESTRING Z (0 0 5, 1 1 5)
SRID=25832;MULTIPOLYGON (((0 0, 1 0, 1 1, 0 0)), ((5 5, 6 5, 6 6, 5 5)))
MULTILINESTRING ((0 0, 1 1), (2 2, 3 3))
GEOMETRYCOLLECTION (LINESTRING (0 0, 1 1), POLYGON ((0 0, 1 0, 1 1, 0 0)))
LINEARRING (0 0, 1 0, 1 1, 0 0)
POLYGON EMPTY
"""
    (tmp_path / "yard.wkt").write_text(text, encoding="utf-8")
    site = load_site(tmp_path / "yard.wkt")
    assert site.kind.tolist() == [POLYGON, LINE, POLYGON, POLYGON, LINE, LINE, LINE, POLYGON, LINE]


GOOD = "LINESTRING (0 0, 1 1)"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"{GOOD}\nPOLYGON ((0 0, 1 1", "line 2 is 'POLYGON .*, but must be a geometry in WKT"),
        (f"{GOOD}\n\nhello", "line 3 is 'hello', but must be a geometry in WKT"),
        (f"{GOOD} {GOOD}", "line 1 goes on by 'LINESTRING .*, but must be one geometry"),
        ("POLYGON ((0 0, 1 1, 2 2))", "line 1 is .*, but must be a geometry in WKT"),
        ("POLYGON ((0 0, 1 1, 0 0, 0 0))", "line 1 is .*, but must have at least 3 different"),
        ("LINESTRING (0 0, 0 0)", "line 1 is .*, but must have at least 2 different points"),
        ("LINESTRING (0 0, 0 2e8)", r"line 1\[1\] holds 200000000.0, but must hold numbers"),
        ("LINESTRING (0 0, 0 nan)", r"line 1\[1\] holds nan, but must hold numbers"),
        ("LINESTRING (0 0, 0 1e400)", r"line 1\[1\] holds inf, but must hold numbers"),
        ("POINT (0 0)", "line 1 is a POINT, but must be one of: POLYGON, LINESTRING"),
        ("CIRCULARSTRING (0 0, 1 1, 2 0)", "line 1 is .*, but must be a geometry in WKT"),
        (
            "GEOMETRYCOLLECTION (" * 10_000,
            "line 1 has more than 50 nested brackets, but must have fewer",
        ),
        ("", "the file has no outline, but must have at least one"),
        ("\udcff", "the file is not in UTF-8"),
    ],
)
def test_a_line_that_is_wrong_is_named(text, message, tmp_path):
    (tmp_path / "yard.wkt").write_bytes(text.encode(errors="surrogateescape"))
    with pytest.raises(ValueError, match=rf"^\S*yard\.wkt: {message}") as told:
        load_site(tmp_path / "yard.wkt")
    assert "\n" not in str(told.value)
    assert len(str(told.value)) < 400
