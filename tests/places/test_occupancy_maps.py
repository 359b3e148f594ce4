"""Maps of map_server become the outlines of their occupied cells, within the tolerance."""

import math
import shutil

import numpy as np
import pytest
import shapely
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from hav_env import load_site
from hav_env.places import POLYGON, is_inside
from hav_env.places.areas import covered_area
from hav_env.places.contact import place_is_inside
from hav_env.places.formats import map_images
from hav_env.places.formats.cell_outlines import trace_cells
from hav_env.places.simplification import simplify_chains
from hav_env.places.site import join_outlines
from tests.places.maps import BLACK, GREY, PLAIN, WHITE, png_header, write_map
from tests.places.shapes import lines_of
from tests.support.budgets import budget

GRIDS = st.tuples(st.integers(1, 12), st.integers(1, 12), st.integers(0, 2**32 - 1))


def drawn(grid):
    """Return random cells: some dense, some sparse, some in thin lines."""
    height, width, seed = grid
    rng = np.random.default_rng(seed)
    cells = rng.random((height, width)) < rng.choice([0.2, 0.5, 0.8])
    return cells | np.eye(height, width, dtype=bool) if seed % 3 == 0 else cells


def squares(cells, size=1.0):
    """Return the occupied cells as one Shapely geometry; the first row is the lowest."""
    boxes = [shapely.box(i, j, i + 1, j + 1) for j, i in np.argwhere(cells)]
    union = shapely.union_all(boxes) if boxes else shapely.Polygon()
    return shapely.transform(union, lambda points: size * points)


@settings(max_examples=budget(150, 60))
@given(GRIDS)
def test_outlines_are_those_of_the_cells(grid):
    cells = drawn(grid)
    chains = trace_cells(cells)
    expected = squares(cells).boundary
    assert shapely.MultiLineString(chains).symmetric_difference(expected).length == 0.0
    site = join_outlines([(POLYGON, chains)] if chains else [])
    for j, i in np.ndindex(cells.shape):
        assert place_is_inside(site, i + 0.4, j + 0.3) != cells[j, i]


@settings(max_examples=budget(150, 60))
@given(GRIDS, st.sampled_from([0.0, 0.5, 1.0, 2.0]))
def test_simple_outlines_are_within_the_tolerance(grid, tolerance):
    chains = trace_cells(drawn(grid))
    if not chains:
        return
    simple = shapely.MultiLineString(simplify_chains(chains, tolerance))
    exact = shapely.MultiLineString(chains)
    assert shapely.hausdorff_distance(exact, simple, densify=0.02) <= tolerance + 1e-9


@settings(max_examples=budget(100, 40))
@given(GRIDS)
def test_cells_that_touch_at_a_corner_stay_together(grid):
    """No line slips through a wall of cells that share corners only."""
    cells = drawn(grid)
    chains = trace_cells(cells)
    simple = simplify_chains(chains, 0.5) if chains else []
    low, high = cells[:-1], cells[1:]
    rising = low[:, :-1] & high[:, 1:] & ~low[:, 1:] & ~high[:, :-1]
    falling = ~low[:, :-1] & ~high[:, 1:] & low[:, 1:] & high[:, :-1]
    corners = {tuple(point) for chain in simple for point in chain.tolist()}
    for j, i in np.argwhere(rising | falling):
        assert (i + 1.0, j + 1.0) in corners


CELLS = np.zeros((8, 10), bool)
CELLS[1, 1:9] = CELLS[1:7, 1] = CELLS[6, 1:9] = True
CELLS[3:5, 5:7] = True
SHADES = np.where(CELLS, BLACK, WHITE)[::-1]


@pytest.mark.parametrize("ending", ["pgm", "png", "bmp"])
@pytest.mark.parametrize("mode", ["trinary", "scale", None])
def test_a_map_is_where_its_origin_says(ending, mode, tmp_path):
    pose = [3.0, -2.0, 0.4]
    path = write_map(tmp_path, SHADES, origin=pose, mode=mode, image=f"yard.{ending}")
    site = load_site(path, tolerance=0.0)
    assert site.kind.tolist() == [POLYGON]
    turned = shapely.affinity.rotate(squares(CELLS, 0.5), 0.4, origin=(0, 0), use_radians=True)
    expected = shapely.affinity.translate(turned, 3.0, -2.0)
    assert covered_area(site).symmetric_difference(expected).area < 1e-9
    assert shapely.hausdorff_distance(lines_of(site), expected.boundary) < 1e-9
    inside = shapely.affinity.rotate(shapely.Point(2.2, 1.2), 0.4, origin=(0, 0), use_radians=True)
    assert is_inside(site, inside.x + 3.0, inside.y - 2.0)


def test_half_a_cell_is_the_tolerance_by_default(tmp_path):
    stairs = np.triu(np.ones((40, 40), bool))
    path = write_map(tmp_path, np.where(stairs, BLACK, WHITE)[::-1])
    exact, usual, rough = (load_site(path, tolerance=t) for t in (0.0, None, 0.36))
    assert usual.segment.tolist() == load_site(path, tolerance=0.25).segment.tolist()
    assert exact.num_segments == 82
    assert rough.num_segments < 8  # steps at 45 degrees are 0.71 cells high
    for site, most in ((usual, 0.25), (rough, 0.36)):
        ends = lines_of(site), lines_of(exact)
        assert shapely.hausdorff_distance(*ends, densify=0.01) <= most + 1e-9


def test_thresholds_unknown_cells_and_negation(tmp_path):
    shades = np.array([[0, 88, 90, 204, 206, 255]])  # shares 1, 0.655, 0.647, 0.2, 0.192, 0
    exact = {"tolerance": 0.0}

    def length(**options):
        entries = options.pop("entries", {})
        return (
            covered_area(load_site(write_map(tmp_path, shades, **entries), **options)).area / 0.25
        )

    assert length(**exact) == pytest.approx(2)
    assert length(**exact, unknown="occupied") == pytest.approx(4)
    assert length(**exact, entries={"negate": 1}) == pytest.approx(3)
    assert length(**exact, entries={"negate": True}, unknown="occupied") == pytest.approx(5)
    assert length(**exact, entries={"occupied_thresh": 0.196}) == pytest.approx(4)
    assert length(**exact, entries={"occupied_thresh": 0.64}) == pytest.approx(3)
    assert length(**exact, entries={"resolution": "5e-1"}) == pytest.approx(2)


def test_transparency_is_unknown_in_scale_and_a_colour_in_trinary(tmp_path):
    clear, black, white = [0, 0, 0, 0], [0, 0, 0, 255], [255, 255, 255, 255]
    shades = np.array([[clear, black, white]])

    def cells(**options):
        mode = options.pop("mode")
        path = write_map(tmp_path, shades, image="yard.png", mode=mode)
        return covered_area(load_site(path, tolerance=0.0, **options)).area / 0.25

    assert cells(mode="scale") == pytest.approx(1)
    assert cells(mode="scale", unknown="occupied") == pytest.approx(2)
    assert cells(mode="trinary") == pytest.approx(2)  # (0 + 0 + 0 + 255) / 4 is 0.75 occupied


@pytest.mark.parametrize("mode", ["1", "P", "RGB", "I;16"])
def test_other_depths_of_images_are_read(mode, tmp_path):
    path = write_map(tmp_path, SHADES, image="yard.png")
    picture = Image.fromarray(SHADES.astype(np.uint8))
    if mode == "I;16":
        picture = Image.fromarray(SHADES.astype(np.uint16) * 257)
    else:
        picture = picture.convert(mode, **{"dither": Image.Dither.NONE} if mode == "1" else {})
    picture.save(tmp_path / "yard.png")
    site = load_site(path, tolerance=0.0)
    assert covered_area(site).symmetric_difference(squares(CELLS, 0.5)).area < 1e-9


def test_images_below_the_folder_are_read(tmp_path):
    path = write_map(tmp_path, SHADES)
    (tmp_path / "images").mkdir()
    shutil.move(tmp_path / "yard.pgm", tmp_path / "images/yard.pgm")
    path.write_text(yaml.safe_dump(PLAIN | {"image": "images/yard.pgm"}))
    assert load_site(path).num_segments == 12
    path.write_text(yaml.safe_dump(PLAIN | {"image": str(tmp_path / "images/yard.pgm")}))
    assert load_site(path).num_segments == 12


BAD = [
    ({"image": None}, "there is no entry image, but there must be one"),
    ({"image": 5}, "image is 5, but must be a path"),
    ({"image": "a\0b"}, r"image is 'a\\x00b', but must be a path"),
    ({"image": "../yard.pgm"}, "image is '../yard.pgm', but must be in the folder of the map"),
    ({"image": "/etc/passwd"}, "image is '/etc/passwd', but must be in the folder of the map"),
    ({"image": "yard.yaml"}, r"image \S*yard.yaml is no PGM, PNG or BMP that can be read"),
    ({"image": ".."}, "image is '..', but must be in the folder"),
    ({"resolution": None}, "there is no entry resolution"),
    ({"resolution": 0}, "resolution is 0, but must be at least 0.0001 m"),
    ({"resolution": -0.05}, "resolution is -0.05, but must be at least"),
    ({"resolution": "fine"}, "resolution is fine, a str and not a number"),
    ({"resolution": math.nan}, "resolution is nan, but must be"),
    ({"resolution": [0.1]}, r"resolution is \[0.1\], a list and not a number"),
    ({"origin": None}, "there is no entry origin"),
    ({"origin": [0, 0]}, r"origin is \[0, 0\], but must be \[x, y, yaw\]"),
    ({"origin": 5}, r"origin is 5, but must be \[x, y, yaw\]"),
    ({"origin": [0, "a", 0]}, r"origin\[1\] is a, a str and not a number"),
    ({"origin": [0, 0, 1e9]}, r"origin\[2\] is 1000000000.0, but must be at least -1e.06 rad"),
    ({"origin": [0, 2e8, 0]}, r"origin\[1\] is 200000000.0, but must be"),
    ({"negate": None}, "there is no entry negate"),
    ({"negate": 2}, "negate is 2, but must be 0 or 1"),
    ({"negate": "no"}, "negate is 'no', but must be 0 or 1"),
    ({"occupied_thresh": None}, "there is no entry occupied_thresh"),
    ({"occupied_thresh": 65}, "occupied_thresh is 65, but must be from 0 to 1"),
    ({"free_thresh": -1}, "free_thresh is -1, but must be from 0 to 1"),
    ({"free_thresh": 0.7}, "free_thresh is 0.7, but must be at most occupied_thresh, 0.65"),
    ({"mode": "raw"}, "mode is 'raw', but must be trinary or scale"),
    ({"mode": 5}, "mode is 5, but must be trinary or scale"),
]


@pytest.mark.parametrize(("entries", "message"), BAD)
def test_an_entry_that_is_wrong_is_one_line_with_file_and_entry(entries, message, tmp_path):
    path = write_map(tmp_path, SHADES)
    told = {name: value for name, value in (PLAIN | entries).items() if value is not None}
    path.write_text(yaml.safe_dump(told))
    with pytest.raises(ValueError, match=rf"^\S*yard\.yaml: {message}") as error:
        load_site(path)
    assert "\n" not in str(error.value)
    assert len(str(error.value)) < 500


BOMB = "a: &a [1, 1]\nb: &b [*a, *a]\nimage: *b\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "the file holds None, but must hold entries such as image"),
        ("- 1", r"the file holds \[1\], but must hold entries"),
        ("image: [", "the file is no plain YAML"),
        ("image: !!python/object/apply:os.system ['true']", "the file is no plain YAML: could not"),
        ("image: !!python/name:os.system", "the file is no plain YAML: could not determine"),
        ("image: !mine 5", "the file is no plain YAML: could not determine a constructor"),
        (BOMB, r"the file has the alias \*a, but must have none"),
        ("[" * 16_000, "the file has more than 8 lists or maps in each other, but must have fewer"),
        (
            "{a: " * 4_000,
            "the file has more than 8 lists or maps in each other, but must have fewer",
        ),
        ("\0\0", "the file is no plain YAML"),
        ("x" * 17_000, "the file has more than 16384 bytes, the most of a map"),
        ("--- 1\n--- 2\n", "the file is no plain YAML"),
    ],
)
def test_yaml_of_strangers_runs_nothing_and_ends(text, message, tmp_path):
    (tmp_path / "yard.yaml").write_text(text)
    with pytest.raises(ValueError, match=rf"^\S*yard\.yaml: {message}") as error:
        load_site(tmp_path / "yard.yaml")
    assert "\n" not in str(error.value)
    assert len(str(error.value)) < 400


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (png_header(10**5, 10**5), "too large: there must be at most 16777216"),
        (png_header(10**4, 10**4), "has 10000 by 10000 cells: there must be at most 16777216"),
        (png_header(5_000, 5_000), "has 5000 by 5000 cells: there must be at most 16777216"),
        (b"P5 100000 100000 255\n", "too large|there must be at most 16777216"),
        (png_header(500, 500), "cannot be read to its end"),
        (b"P5 10 10 255\n123", "cannot be read to its end"),
        (b"P5 0 10 255\n", "no PGM, PNG or BMP that can be read|cannot be read"),
        (b"GIF89a" + bytes(100), "no PGM, PNG or BMP that can be read"),
        (b"", "no PGM, PNG or BMP that can be read"),
        (bytes(1_000), "no PGM, PNG or BMP that can be read"),
    ],
)
def test_images_of_strangers_are_bounded(content, message, tmp_path):
    path = write_map(tmp_path, SHADES)
    (tmp_path / "yard.pgm").write_bytes(content)
    with pytest.raises(
        ValueError, match=rf"^\S*yard\.yaml: image \S*yard\.pgm .*({message})"
    ) as told:
        load_site(path)
    assert "\n" not in str(told.value)


def test_links_out_of_the_folder_are_not_followed(tmp_path):
    (tmp_path / "map").mkdir()
    path = write_map(tmp_path / "map", SHADES)
    shutil.move(tmp_path / "map/yard.pgm", tmp_path / "secret.pgm")
    (tmp_path / "map/yard.pgm").symlink_to(tmp_path / "secret.pgm")
    with pytest.raises(ValueError, match="must be in the folder of the map or below"):
        load_site(path)


def test_a_large_file_and_a_ragged_map_are_refused(tmp_path, monkeypatch):
    path = write_map(tmp_path, np.indices((64, 64)).sum(axis=0) % 2 * 255)
    monkeypatch.setattr("hav_env.places.formats.cell_outlines._MOST_RUNS", 1_000)
    with pytest.raises(ValueError, match="have 8192 straight pieces, but must have at most 1000"):
        load_site(path)
    monkeypatch.setattr(map_images, "_MOST_BYTES", 1_000)
    with pytest.raises(ValueError, match=r"image .* has more than 1000 bytes"):
        load_site(path)


def test_a_map_without_obstacles_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"yard\.yaml: the file has no outline"):
        load_site(write_map(tmp_path, np.full((4, 4), GREY)))
    (tmp_path / "yard.pgm").unlink()
    with pytest.raises(FileNotFoundError, match=r"yard\.pgm"):
        load_site(tmp_path / "yard.yaml")
