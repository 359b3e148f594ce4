"""Written scenarios have a site: HAVs start and end where they touch nothing."""

import json
import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity

from hav_env import catalogue, explicit, load_explicit, load_site
from hav_env.places import BOUNDARY, LINE, POLYGON, build_site
from hav_env.places.areas import free_area
from tests.places.shapes import lines_of, stars
from tests.support.budgets import budget
from tests.support.paths import EXAMPLES

YARD = [[-60, -60], [120, -60], [120, 60], [-60, 60]]
HAV = {"lengths": [4.0, 6.0], "start": [0.0, 0.0, 0.0], "goals": [[90.0, 0.0, 1.0]]}
OBSTACLES = [{"polygon": [[30, 10], [50, 10], [40, 30]]}, {"line": [[0, 5], [20, 5]]}]
FILE = {"boundary": YARD, "obstacles": [*OBSTACLES, {"circle": [60, 0, 3]}], "havs": [HAV]}


def load(folder, **changes):
    (folder / "yard.json").write_text(json.dumps(FILE | changes))
    return load_explicit(folder / "yard.json")


def test_a_scenario_in_a_file_has_the_site_that_is_written_there(tmp_path):
    scenario = load(tmp_path)
    (tmp_path / "site.json").write_text(json.dumps({k: FILE[k] for k in ("boundary", "obstacles")}))
    site = load_site(tmp_path / "site.json")
    for one, other in zip(scenario.site, site, strict=True):
        np.testing.assert_array_equal(one, other)
    assert site.kind.tolist() == [BOUNDARY, POLYGON, LINE, POLYGON]
    given = explicit([HAV["lengths"]], [HAV["start"]], [HAV["goals"]], site=site)
    assert given.site.num_segments == site.num_segments
    assert load_explicit(EXAMPLES / "two_havs.json").site.num_segments == 0


def written(x=0.0, y=0.0, heading=0.0, **changes):
    return HAV | {"start": [x, y, heading]} | changes


ENDS = r"must not touch {} there, from \({}\), \({}\)"
INSIDE = "must be inside the boundary of the site, outside polygons"


@pytest.mark.parametrize(
    ("hav", "message"),
    [
        (written(200.0), rf"start of HAV 0 is at \(200, 0\), but {INSIDE}"),
        (
            written(40.0, 13.0, lengths=[0.5, 0.5]),
            rf"start of HAV 0 is at \(40, 13\), but {INSIDE}",
        ),
        (written(60.0, 0.5, lengths=[0.5, 0.5]), INSIDE),
        (written(117.0), ENDS.format("the boundary", "120, -60", "120, 60")),
        (written(27.0, 12.0), ENDS.format("a polygon", "40, 30", "30, 10")),
        (written(0.0, 2.0, 1.2), ENDS.format("a line", "0, 5", "20, 5")),
        (written(5.0, 10.0, math.pi / 2), ENDS.format("a line", "0, 5", "20, 5")),  # the trailer
        (written(14.0, 8.0, 0.0, bends=[1.0]), ENDS.format("a line", "0, 5", "20, 5")),
        (HAV | {"goals": [[200, 0, 0]]}, rf"goal 1 of HAV 0 is at \(200, 0\), but {INSIDE}"),
        (
            HAV | {"goals": [[90, 0, 0], [55, 0, 0]]},
            r"goal 2 of HAV 0 is at \(55, 0\), but its truck must not touch a polygon there",
        ),
    ],
)
def test_starts_and_goals_in_the_way_are_named(hav, message, tmp_path):
    with pytest.raises(ValueError, match=rf"yard\.json: .*{message}") as told:
        load(tmp_path, havs=[hav])
    assert "\n" not in str(told.value)


def test_places_that_are_clear_are_allowed(tmp_path):
    for hav in (written(14.0, 8.0), written(5.0, 12.0, -math.pi / 2, lengths=[4.0, 4.0])):
        load(tmp_path, havs=[hav])
    # at a goal the trailers may be anywhere
    load(tmp_path, havs=[HAV | {"goals": [[5.0, 7.0, math.pi / 2]]}])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"boundary": 5}, "scenario.boundary is 5, but must be an array"),
        ({"boundary": [[0, 0]]}, "scenario.boundary is .*, but must have at least 3 different"),
        ({"obstacles": {}}, "scenario.obstacles is {}, but must be an array"),
        ({"obstacles": [{}]}, r"scenario.obstacles\[0\] is {}, but must have one of: polygon"),
        (
            {"obstacles": [*OBSTACLES, {"line": [[0, 0], [1, "1"]]}]},
            r"scenario.obstacles\[2\].line\[1\]\[1\] is '1', but must be a number",
        ),
    ],
)
def test_an_entry_of_the_site_that_is_wrong_is_named(changes, message, tmp_path):
    with pytest.raises(ValueError, match=rf"^\S*yard\.json: {message}"):
        load(tmp_path, **changes)


@pytest.mark.parametrize("site", [None, 5, "yard.json", {"boundary": YARD}])
def test_what_is_no_site_is_refused(site):
    with pytest.raises(TypeError, match=r"scenario site is .*, but must be a Site"):
        explicit([HAV["lengths"]], [HAV["start"]], [HAV["goals"]], site=site)


def bodies(vehicle, x, y, heading, bend):
    """Return the rectangles of a truck and one trailer, by Shapely."""
    found, turn = [], heading
    front = np.array([x, y]) + vehicle.lengths[0] * np.array([math.cos(heading), math.sin(heading)])
    for unit in range(2):
        half, ahead, behind = (float(part[unit]) for part in vehicle.bodies)
        turn = heading + bend * unit
        box = shapely.box(-vehicle.lengths[unit] - behind, -half, ahead, half)
        box = affinity.rotate(box, turn, origin=(0, 0), use_radians=True)
        found.append(affinity.translate(box, *front))
        hitch = vehicle.lengths[0] + vehicle.offsets[1]
        front = front - hitch * np.array([math.cos(heading), math.sin(heading)])
    return found


@settings(max_examples=budget(80, 40))
@given(
    st.lists(stars(), max_size=3),
    *[st.floats(-55.0, 55.0)] * 2,
    *[st.floats(-1.0, 1.0)] * 2,
)
def test_real_bodies_start_where_shapely_finds_room(polygons, x, y, heading, bend):
    site, vehicle = build_site(YARD, polygons), catalogue("wb-67")
    units = shapely.union_all(bodies(vehicle, x, y, heading, bend))
    clear = units.distance(lines_of(site)) > 0.0
    clear &= free_area(site).contains(shapely.Point(x, y))
    given = {"start": [[x, y, heading]], "bends": [[bend]], "goals": [[[100.0, 45.0, 0.0]]]}
    told = ""
    try:
        explicit([vehicle], **given, site=site)
    except ValueError as error:
        told = str(error)
    assert told.startswith("the start of HAV 0") == (not clear)
    assert not told or told.startswith(("the start of HAV 0", "goal 1 of HAV 0"))
