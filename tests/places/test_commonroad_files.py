"""CommonRoad's static obstacles and the edges of its roads become polygons and lines."""

import itertools
import math

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity

from hav_env import load_site
from hav_env.places import LINE, POLYGON
from hav_env.places.areas import covered_area
from hav_env.places.formats.commonroad import read_commonroad
from hav_env.places.site import join_outlines
from tests.places.shapes import POINTS, lines_of, stars
from tests.support.budgets import budget


def point(x, y, tag="point"):
    return f"<{tag}><x>{x!r}</x><y>{y!r}</y></{tag}>"


def obstacle(*shapes, x=0.0, y=0.0, angle=0.0, tag="staticObstacle", role=""):
    place = f"<position>{point(x, y)}</position><orientation><exact>{angle!r}</exact></orientation>"
    state = f"<initialState>{place}<time><exact>0</exact></time></initialState>"
    return f'<{tag} id="7">{role}<shape>{"".join(shapes)}</shape>{state}</{tag}>'


def rectangle(length, width, more=""):
    size = f"<length>{length!r}</length><width>{width!r}</width>"
    return f"<rectangle>{size}{more}</rectangle>"


def lanelet(number, left, right, more=""):
    bounds = (
        f"<{tag}>{''.join(itertools.starmap(point, bound))}</{tag}>"
        for tag, bound in (("leftBound", left), ("rightBound", right))
    )
    return f'<lanelet id="{number}">{"".join(bounds)}{more}</lanelet>'


def road(*parts, head='<?xml version="1.0" encoding="UTF-8"?>', version="2020a"):
    root = f'<commonRoad commonRoadVersion="{version}" benchmarkID="ZAM_Yard-1_1_T-1">'
    return f"{head}{root}{''.join(parts)}</commonRoad>".encode()


def placed(shape, x, y, angle):
    turned = affinity.rotate(shape, angle, origin=(0, 0), use_radians=True)
    return affinity.translate(turned, x, y)


LENGTHS, ANGLES = st.floats(0.1, 30.0), st.floats(-4.0, 4.0)


@settings(max_examples=budget(60, 30))
@given(LENGTHS, LENGTHS, POINTS, ANGLES, stars(center=(3.0, 1.0)))
def test_obstacles_are_where_they_stand(length, width, place, angle, ring):
    polygon = f"<polygon>{''.join(itertools.starmap(point, ring))}</polygon>"
    circle = f"<circle><radius>{width!r}</radius>{point(1.0, 2.0, 'center')}</circle>"
    x, y = place
    for shape, expected, most in (
        (rectangle(length, width), shapely.box(-length / 2, -width / 2, length / 2, width / 2), 0),
        (polygon, shapely.Polygon(ring), 0),
        (circle, shapely.Point(1, 2).buffer(width, quad_segs=64), 0.03 * width),
    ):
        content = road(obstacle(shape, x=x, y=y, angle=angle))
        site = join_outlines(read_commonroad(content))
        area = covered_area(site)
        turned = placed(expected, x, y, angle)
        assert shapely.hausdorff_distance(area, turned) <= most + 1e-9
        assert area.buffer(1e-9).covers(turned)
        assert site.kind.tolist() == [POLYGON]


def test_groups_shifts_and_turns_inside_a_shape():
    turned = rectangle(
        4.0, 2.0, f"<orientation>{math.pi / 2}</orientation>{point(5.0, 0.0, 'center')}"
    )
    shifted = rectangle(4.0, 2.0, "<originXShift>-1.0</originXShift>")
    (_, (one,)), (_, (other,)) = read_commonroad(road(obstacle(turned, shifted)))
    assert shapely.Polygon(one).bounds == pytest.approx((4, -2, 6, 2))
    assert shapely.Polygon(other).bounds == pytest.approx((-1, -1, 3, 1))


def test_what_stands_is_read_and_what_moves_is_not():
    told = "<role>{}</role>".format
    parts = [
        obstacle(rectangle(4.0, 2.0), tag="dynamicObstacle"),
        obstacle(rectangle(4.0, 2.0), tag="obstacle", role=told("dynamic"), x=9.0),
        obstacle(rectangle(4.0, 2.0), tag="obstacle", role=told("static"), x=50.0),
        f'<environmentObstacle id="3"><shape>{rectangle(2.0, 2.0)}</shape></environmentObstacle>',
    ]
    bounds = [shapely.Polygon(ring).bounds for _, (ring,) in read_commonroad(road(*parts))]
    assert bounds == [(-1, -1, 1, 1), (48, -1, 52, 1)]


UP, DOWN = '<adjacentLeft ref="2" drivingDir="same"/>', '<adjacentRight ref="1" drivingDir="same"/>'


def along(y, x=(0.0, 50.0, 100.0)):
    return [(k, y) for k in x]


def test_the_edges_of_roads_are_lines():
    lanes = [lanelet(1, along(4.0), along(0.0), UP), lanelet(2, along(8.0), along(4.0), DOWN)]
    site = join_outlines(read_commonroad(road(*lanes)))
    expected = shapely.MultiLineString([along(0.0), along(8.0)])
    assert lines_of(site).symmetric_difference(expected).length < 1e-9
    assert set(site.kind) == {LINE}


def test_nothing_stands_in_a_junction():
    level = lanelet(1, along(2.0, (-50.0, 50.0)), along(-2.0, (-50.0, 50.0)))
    upright = lanelet(2, [(-2.0, -50.0), (-2.0, 50.0)], [(2.0, -50.0), (2.0, 50.0)])
    lines = lines_of(join_outlines(read_commonroad(road(level, upright))))
    cross = shapely.union_all([shapely.box(-50, -2, 50, 2), shapely.box(-2, -50, 2, 50)])
    ends = shapely.MultiLineString([[(s * 50, -2), (s * 50, 2)] for s in (-1, 1)])
    ends = ends.union(affinity.rotate(ends, 90, origin=(0, 0)))
    expected = cross.boundary.difference(ends)
    assert lines.hausdorff_distance(expected) <= 0.1 + 1e-9
    assert not lines.intersects(shapely.Point(0, 0).buffer(1.89))


def test_a_small_gap_among_lanes_is_closed_and_an_island_is_not():
    for side, left in ((1.5, 0), (6.0, 1)):
        lanes = ring_of_lanes(side / 2)
        lines = lines_of(join_outlines(read_commonroad(road(*lanes))))
        island = shapely.box(-side / 2, -side / 2, side / 2, side / 2).boundary
        assert (lines.intersection(island.buffer(0.01)).length > side) == bool(left)


def ring_of_lanes(half):
    """Return four straight lanes round a square that they do not cover."""
    corner = [(-half, half), (9.0, half)], [(-half, 9.0), (9.0, 9.0)]
    lanes = []
    for number, (c, s) in enumerate(((1, 0), (0, 1), (-1, 0), (0, -1))):
        left, right = ([(c * x - s * y, s * x + c * y) for x, y in bound] for bound in corner)
        lanes.append(lanelet(number, left, right))
    return lanes


def test_a_file_is_read_and_simplified(tmp_path):
    left = [(float(x), 4.0 + 0.05 * (x % 2)) for x in range(100)]
    content = road(
        lanelet(1, left, along(0.0)), obstacle(rectangle(4.0, 2.0), y=20.0), version="2018b"
    )
    (tmp_path / "yard.xml").write_bytes(content)
    assert load_site(tmp_path / "yard.xml").num_segments > 100
    site = load_site(tmp_path / "yard.xml", tolerance=0.1)
    assert site.num_segments == 6
    assert sorted(site.kind.tolist()) == [POLYGON, LINE, LINE]


BOX = rectangle(4.0, 2.0)
GOOD = obstacle(BOX)
BAD = [
    (road(), "the file has no outline"),
    (b"<osm/>", "its root is 'osm', but must be commonRoad"),
    (b"", "the file is no plain XML: no element found"),
    (b"<commonRoad>", "the file is no plain XML: no element found"),
    (b"{}", "the file is no plain XML"),
    (road(GOOD, head='<?xml version="1.0" encoding="none"?>'), "the file is no plain XML"),
    (road(obstacle()), "staticObstacle 7 has an empty shape, but must have one of: rectangle"),
    (road(obstacle("<wheel/>")), "staticObstacle 7 has the shape 'wheel', but must have one of"),
    (road(obstacle(rectangle(0.0, 2.0))), "staticObstacle 7 rectangle has length 0.0 and width"),
    (road(obstacle("<circle/>")), "staticObstacle 7 circle has no radius, but must have one"),
    (road(obstacle("<circle><radius>0</radius></circle>")), "circle has radius 0.0, but must"),
    (road(obstacle("<polygon/>")), r"staticObstacle 7 polygon is \[\], but must have at least 3"),
    (road(obstacle("<polygon><point><x>1</x></point></polygon>")), r"polygon point\[0\] has no y"),
    (road(GOOD.replace("4.0", "4,0")), "rectangle length is '4,0', but must be a number"),
    (road(GOOD.replace("4.0", "nan")), "rectangle length is 'nan', but must be a number"),
    (road(GOOD.replace("4.0", "")), "rectangle length is '', but must be a number"),
    (road(GOOD.replace("4.0", "1e300")), "staticObstacle 7 rectangle.* holds -5e.299"),
    (road(GOOD.replace("shape>", "form>")), "staticObstacle 7 has no shape, but must have one"),
    (road(GOOD.replace("point>", "lanelet>")), "7 has no initialState/position/point, but must"),
    (road(GOOD.replace("exact>", "interval>")), "has no initialState/orientation/exact, but must"),
    (road(obstacle(BOX, x=1e9)), "staticObstacle 7 rectangle.* holds "),
    (road(obstacle(BOX, tag="obstacle")), "obstacle 7 has no role, but must have one"),
    (road(lanelet(5, [], along(0.0))), r"lanelet 5 leftBound is \[\], but must have at least 2"),
    (road('<lanelet id="5"/>'), "lanelet 5 leftBound is missing, but must be there"),
]


@pytest.mark.parametrize(("content", "message"), BAD)
def test_an_entry_that_is_wrong_is_one_line_with_file_and_entry(content, message, tmp_path):
    (tmp_path / "yard.xml").write_bytes(content)
    with pytest.raises(ValueError, match=rf"^\S*yard\.xml: .*{message}") as told:
        load_site(tmp_path / "yard.xml")
    assert "\n" not in str(told.value)
    assert len(str(told.value)) < 400


LAUGHS = "".join(f'<!ENTITY l{k} "{f"&l{k - 1};" * 10}">' for k in range(1, 10))


@pytest.mark.parametrize(
    "head",
    [
        f'<!DOCTYPE commonRoad [<!ENTITY l0 "ha">{LAUGHS}]>',
        '<!DOCTYPE commonRoad [<!ENTITY l9 SYSTEM "file:///etc/passwd">]>',
        '<!DOCTYPE commonRoad SYSTEM "http://localhost/yard.dtd">',
        f'<!DOCTYPE commonRoad [<!ENTITY l9 "{"ha" * 10_000}">]>',
    ],
)
def test_entities_of_strangers_are_refused(head, tmp_path):
    (tmp_path / "yard.xml").write_bytes(road(GOOD.replace("4.0", "&l9;"), head=head))
    with pytest.raises(ValueError, match=r"yard\.xml: the file is no plain XML: DTDForbidden"):
        load_site(tmp_path / "yard.xml")
