"""Drawings show the colliding shapes: rectangles and hitches of pictures equal the simulator's."""

import numpy as np
import pytest
import shapely

from hav_env import Lines, OffAxle, Rectangles
from hav_env.rendering import scene_of
from hav_env.rendering.bodies import draw_bodies
from hav_env.rendering.camera import Camera
from hav_env.rendering.canvas import Canvas
from hav_env.rendering.colors import CALM, GROUND, RED
from hav_env.rendering.scene import ends_of, outlines_of, shares_of
from hav_env.rendering.viewer import Viewer
from hav_env.world.bodies import find_box
from hav_env.world.chain import ends_behind, front_axle
from tests.support.worlds import catalogue_like

SIZE = (700, 500)


def rectangles(worlds, hav=0) -> list:
    """Return the bodies of a HAV as Shapely's, each cut out of the plane at its own heading."""
    fleet, state = worlds.fleet, worlds.state
    x, y = front_axle(worlds, hav, 0)
    found = []
    for unit in range(fleet.num_trailers[hav, 0] + 1):
        half, ahead, behind = fleet.bodies.shape[hav, unit, :, 0]
        flat = shapely.box(-fleet.length[hav, unit, 0] - behind, -half, ahead, half)
        turned = shapely.affinity.rotate(
            flat, state.heading[hav, unit, 0], origin=(0, 0), use_radians=True
        )
        found.append(shapely.affinity.translate(turned, x, y))
        _, _, x, y = ends_behind(worlds, hav, unit, 0, x, y)
    return found


@pytest.fixture(scope="module")
def worlds():
    return catalogue_like(OffAxle(bodies=Rectangles())).worlds


def test_outlines_are_the_rectangles_that_collide(worlds):
    scene = scene_of(worlds, 0, 0.2)
    for hav in range(2):
        outlines, bodies = outlines_of(scene, hav), rectangles(worlds, hav)
        assert len(outlines) == len(bodies) == 4
        for outline, body in zip(outlines, bodies, strict=True):
            drawn = shapely.Polygon(outline)
            assert drawn.symmetric_difference(body).area < 1e-9
            assert drawn.exterior.is_ccw
        left, right, low, high = find_box(worlds.fleet.bodies, worlds, hav, 0)
        np.testing.assert_allclose(outlines.min(axis=(0, 1)), [left, low])
        np.testing.assert_allclose(outlines.max(axis=(0, 1)), [right, high])


@pytest.mark.parametrize("near", [True, False])
def test_pixels_are_inked_where_bodies_are_and_nowhere_else(worlds, near):
    scene, canvas, camera = scene_of(worlds, 0, 0.2), Canvas(SIZE), Camera(SIZE, 0.0, 30)
    scene = scene._replace(steering=np.zeros(2))  # wheels that are turned stick out
    scene.heading[0, 1] = scene.heading[0, 2]
    scene.shape[0, 1, 0] = 0.3  # a drawbar of some pixels
    outlines = outlines_of(scene, 0)
    camera.aim(outlines.min(axis=(0, 1)), outlines.max(axis=(0, 1)), margin=20)
    canvas.clear()
    draw_bodies(canvas, camera, scene, 0, near)
    canvas.shrink()
    inked = (canvas.frame() != np.array(GROUND)).any(axis=-1)
    union = shapely.union_all([shapely.Polygon(camera.project(outline)) for outline in outlines])
    down, right = np.indices(inked.shape)
    inside = shapely.contains_xy(union.buffer(-1.0), right + 0.5, down + 0.5)
    outside = ~shapely.contains_xy(union.buffer(1.5), right + 0.5, down + 0.5)
    assert inside.sum() > 5_000
    assert inked[inside].all()
    assert not inked[outside].any()


def test_all_corners_are_in_the_picture_and_drawn_at_every_zoom(worlds):
    scene = scene_of(worlds, 0, 0.2)
    for zoom in (0.05, 0.3, 1.0):
        viewer = Viewer("rgb_array", size=SIZE)
        viewer._zoom = zoom
        before, gone = viewer.draw(scene), scene._replace(removed=np.array([True, False]))
        assert (before != viewer.draw(gone)).any()
    low, high = viewer._camera.seen()
    corners = np.concatenate([outlines_of(scene, hav).reshape(-1, 2) for hav in range(2)])
    assert (corners > low).all()
    assert (corners < high).all()


def test_who_sticks_into_the_picture_is_drawn(worlds):
    """A HAV of which only an overhang is in sight: its circle and its chain are not."""
    viewer, scene = Viewer("rgb_array", size=SIZE, follow=1), scene_of(worlds, 0, 0.2)
    viewer.draw(scene)
    _, high = viewer._camera.seen()
    scene.shape[0, :, 2] = 40.0
    scene.heading[0] = 0.0
    scene = scene._replace(x=np.array([high[0] + scene.footprint[0] + 1.0, scene.x[1]]))
    assert 0 in viewer._in_sight(scene, np.arange(2))


@pytest.mark.parametrize(
    "bodies", [pytest.param(Lines(), marks=pytest.mark.exhaustive), Rectangles()]
)
def test_joints_are_drawn_at_the_hitches(bodies):
    worlds = catalogue_like(OffAxle(bodies=bodies)).worlds
    scene = scene_of(worlds, 0, 0.2)
    viewer = Viewer("rgb_array", size=SIZE, follow=0)
    viewer.trails = viewer.circles = False
    frame = viewer.draw(scene)
    for right, down in viewer._camera.project(ends_of(scene, 0)[1:]):
        assert tuple(frame[int(down), int(right)]) == CALM


def test_each_joint_has_the_colour_of_its_own_limit():
    worlds = catalogue_like(OffAxle(bodies=Rectangles())).worlds
    bend = abs(worlds.state.heading[0, 2, 0] - worlds.state.heading[0, 1, 0])
    worlds.fleet.joints.limit[0, 2, 0] = 0.9 * bend  # that of the second joint alone
    scene = scene_of(worlds, 0, 0.2)
    shares = shares_of(scene, 0)
    assert shares.argmax() == 1
    assert shares[1] == pytest.approx(1 / 0.9)
    viewer = Viewer("rgb_array", size=SIZE, follow=0)
    viewer.trails = viewer.circles = False
    frame, places = viewer.draw(scene), viewer._camera.project(ends_of(scene, 0)[1:])
    colors = [tuple(frame[int(down), int(right)]) for right, down in places]
    assert colors == [CALM, RED, CALM]
