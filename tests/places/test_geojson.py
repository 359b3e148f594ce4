"""GeoJSON in metres becomes the site that Shapely reads in it; degrees are rejected."""

import json

import pytest
import shapely
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from hav_env import load_site
from hav_env.places import BOUNDARY, LINE, POLYGON
from hav_env.places.areas import covered_area, free_area
from hav_env.places.formats.geojson import read_geojson
from hav_env.places.simplification import simplify_outlines
from hav_env.places.site import join_outlines
from tests.places.shapes import CHAINS, lines_of, stars
from tests.support.budgets import budget


def feature(kind, coordinates, **properties):
    geometry = {"type": kind, "coordinates": coordinates}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def collection(*features, **more):
    return {"type": "FeatureCollection", "features": list(features), **more}


RING = [[0, 0], [50, 0], [50, 40], [0, 40], [0, 0]]
HOLE = [[10, 10], [20, 10], [20, 20], [10, 10]]
WHOLE = collection(
    feature("Polygon", [RING], boundary=True),
    feature("Polygon", [HOLE]),
    feature("LineString", [[30, 5, 9.5], [30, 35, 9.5]], name="fence"),
    feature("Point", [40, 20], radius=2.5),
    feature("MultiPolygon", [[HOLE], [RING, HOLE]]),
    feature("MultiLineString", [[[1, 1], [2, 2]], [[3, 3], [4, 4], [5, 5]]]),
    feature("MultiPoint", [[1, 2], [3, 4]], radius=1),
)


@settings(max_examples=budget(60, 25), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(stars(most=200.0), st.lists(stars(), max_size=3), CHAINS, st.sampled_from([0.0, 0.3, 3.0]))
def test_geometries_come_back_within_the_tolerance(boundary, polygons, chain, tolerance):
    shapes = [shapely.Polygon(boundary), *map(shapely.Polygon, polygons), shapely.LineString(chain)]
    features = [
        {"type": "Feature", "geometry": json.loads(shapely.to_geojson(shape)), "properties": None}
        for shape in shapes
    ]
    features[0]["properties"] = {"boundary": True}
    site = join_outlines(simplify_outlines(read_geojson(collection(*features)), tolerance))
    assert (site.kind == BOUNDARY).sum() == 1
    written = shapely.union_all([shapes[-1], *(shape.exterior for shape in shapes[:-1])])
    assert shapely.hausdorff_distance(lines_of(site), written, densify=0.05) <= tolerance + 1e-9
    if tolerance == 0.0:
        free = shapes[0].difference(shapely.union_all(shapes[1:-1]))
        assert free_area(site).symmetric_difference(free).area < 1e-6


def test_every_kind_of_geometry_is_read(tmp_path):
    (tmp_path / "yard.geojson").write_text(json.dumps(WHOLE))
    site = load_site(tmp_path / "yard.geojson")
    kinds = [BOUNDARY, POLYGON, LINE, POLYGON, POLYGON, POLYGON, LINE, LINE, POLYGON, POLYGON]
    assert site.kind.tolist() == kinds
    court = shapely.Polygon(RING, [HOLE])
    circles = [shapely.Point(40, 20).buffer(2.4), shapely.Point(3, 4).buffer(0.9)]
    assert covered_area(site).contains(shapely.union_all([court, *circles]))
    (tmp_path / "yard.json").write_text(json.dumps(WHOLE))
    assert load_site(tmp_path / "yard.json").segment.tolist() == site.segment.tolist()


@pytest.mark.parametrize(
    "data",
    [
        WHOLE["features"][0]["geometry"],
        WHOLE["features"][1],
        {"type": "GeometryCollection", "geometries": [WHOLE["features"][0]["geometry"]]},
        collection(WHOLE["features"][1], {"type": "Feature", "geometry": None, "properties": {}}),
        collection(feature("Polygon", [RING], boundary="administrative")),
        collection(feature("Polygon", [RING], boundary=False)),
    ],
)
def test_a_file_may_be_a_feature_or_a_geometry(data):
    assert [kind for kind, _ in read_geojson(data)] == [POLYGON]


def wrong(place, value):
    data = json.loads(json.dumps(WHOLE))
    *way, last = [int(part) if part.isdigit() else part for part in place.split("/")]
    inner = data
    for part in way:
        inner = inner[part]
    inner[last] = value
    return data


NESTED = {"type": "Point"}
for _ in range(30):
    NESTED = {"type": "GeometryCollection", "geometries": [NESTED]}
GEOMETRY = "features/1/geometry"
BAD = [
    (wrong("features", 5), "features is 5, but must be an array"),
    (wrong("features/1", 5), r"features\[1\] is 5, but must be an object"),
    (wrong("features/1/type", "Features"), r"features\[1\].type is 'Features', but must be one of"),
    (wrong("features/1/type", None), r"features\[1\].type is None, but must be one of"),
    (wrong("features/1/type", []), r"features\[1\].type is \[\], but must be one of"),
    (wrong("features/1/properties", 5), r"features\[1\].properties is 5, but must be an object"),
    (
        wrong("features/1/properties/boundary", 1),
        r"features\[1\].properties.boundary is 1, but must be true or false",
    ),
    (wrong("features/1/properties/boundary", "true"), "boundary is 'true', but must be true or"),
    (
        wrong("features/1/properties/boundary", True),
        r"features\[1\].geometry is a boundary, and features\[0\].geometry is, but there must be",
    ),
    (
        wrong("features/2/properties/boundary", True),
        r"features\[2\].geometry.type is LineString, but that of a boundary must be Polygon",
    ),
    (wrong(GEOMETRY, 5), r"features\[1\].geometry is 5, but must be an object"),
    (wrong(f"{GEOMETRY}/type", "Curve"), r"features\[1\].geometry.type is 'Curve', but must be"),
    (wrong(f"{GEOMETRY}/coordinates", None), r"geometry.coordinates is None, but must be an array"),
    (wrong(f"{GEOMETRY}/coordinates", []), r"geometry.coordinates is \[\], but must have at least"),
    (
        wrong(f"{GEOMETRY}/coordinates/0", 5),
        r"geometry.coordinates\[0\] is 5, but must be an array",
    ),
    (
        wrong(f"{GEOMETRY}/coordinates/0/1", 5),
        r"coordinates\[0\]\[1\] is 5, but must be a position",
    ),
    (
        wrong(f"{GEOMETRY}/coordinates/0/1", [1, "2"]),
        r"features\[1\].geometry.coordinates\[0\]\[1\] is \[1, '2'\], but must be a position",
    ),
    (wrong(f"{GEOMETRY}/coordinates/0/1/0", 1e9), r"coordinates\[0\]\[1\] holds 1000000000.0"),
    (wrong(f"{GEOMETRY}/coordinates/0", RING[:1] * 5), r"coordinates\[0\] is .* 3 different"),
    (wrong("features/3/properties", {}), r"features\[3\].geometry.coordinates is a point whose"),
    (wrong("features/3/properties/radius", -1), "has radius -1, but must have one above 0 m"),
    (wrong("features/3/properties/radius", "2"), "whose property radius is '2', but must be a num"),
    (wrong("features/4/geometry/coordinates/1/0/2", []), r"coordinates\[1\]\[0\]\[2\] is \[\]"),
    (NESTED, "objects deep, but must be at most 10"),
]


@pytest.mark.parametrize(("data", "message"), BAD)
def test_an_entry_that_is_wrong_is_one_line_with_file_and_entry(data, message, tmp_path):
    (tmp_path / "yard.geojson").write_text(json.dumps(data))
    with pytest.raises(ValueError, match=rf"^\S*yard\.geojson: .*{message}") as told:
        load_site(tmp_path / "yard.geojson")
    assert "\n" not in str(told.value)
    assert len(str(told.value)) < 450


DEGREES = collection(feature("Polygon", [[[11.1, 52.1], [11.102, 52.1], [11.1, 52.101]]]))


def named(data, name):
    return data | {"crs": {"type": "name", "properties": {"name": name}}}


@pytest.mark.parametrize(
    "name",
    [
        "urn:ogc:def:crs:OGC:1.3:CRS84",
        "urn:ogc:def:crs:EPSG::4326",
        "urn:ogc:def:crs:EPSG:6.6:4326",
        "EPSG:4326",
        "epsg:4258",
        "WGS 84",
        "EPSG:4283",
        "OGC:CRS84 (WGS 84)",
    ],
)
def test_longitudes_and_latitudes_that_are_named_are_refused(name):
    with pytest.raises(ValueError, match=r"longitudes and latitudes: project it to metres first"):
        read_geojson(named(WHOLE, name))
    with pytest.raises(ValueError, match=r"longitudes and latitudes: project it to metres first"):
        read_geojson(WHOLE | {"crs": name})


@pytest.mark.parametrize("name", ["EPSG:32632", "urn:ogc:def:crs:EPSG::25832", "the yard's own"])
def test_other_systems_are_taken_for_metres(name):
    assert len(read_geojson(named(WHOLE, name))) == 10
    assert len(read_geojson(named(DEGREES, name))) == 1


def test_coordinates_within_a_metre_of_each_other_are_taken_for_degrees():
    with pytest.raises(ValueError, match=r"within 0.002 by 0.001 .*longitudes and latitudes\?"):
        read_geojson(DEGREES)


@pytest.mark.parametrize("crs", [5, {}, {"properties": {}}, {"properties": {"name": 4326}}])
def test_a_system_without_a_name_is_refused(crs):
    with pytest.raises(ValueError, match=r"crs is .*, but must be a name, or have properties"):
        read_geojson(WHOLE | {"crs": crs})
