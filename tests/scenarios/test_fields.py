"""In random fields each HAV alone can reach its goals: SciPy and Shapely drive its way anew."""

import numpy as np
import pytest
import scipy.integrate
import shapely

from hav_env import Batch, Field
from hav_env.maths.dubins import shortest_path, turns
from hav_env.vehicles import VEHICLES
from hav_env.world.sensing import drivable_radius
from hav_env.world.units.reading import limits_in, offsets_in, shapes_in
from tests.support.budgets import budget
from tests.support.obstacles import touching_walls, wall_shapes

FIELD = Field(num_havs=2)


@pytest.fixture(scope="module")
def worlds():
    batch = Batch(FIELD, budget(20, 2), vehicle=VEHICLES.make("realistic"))
    batch.reset(9)
    return batch.worlds


def rates(distance, pose, curvature, lengths, offsets):
    """Return how x, y and all headings change for each metre: the general n-trailer."""
    heading = pose[2:]
    speed, rate, found = 1.0, curvature, [curvature]
    for j in range(1, len(heading)):
        bend = heading[j] - heading[j - 1]
        swing = offsets[j - 1] * rate
        own = -(speed * np.sin(bend) + swing * np.cos(bend)) / lengths[j]
        speed, rate = speed * np.cos(bend) - swing * np.sin(bend), own
        found.append(own)
    return [np.cos(heading[0]), np.sin(heading[0]), *found]


def way_of(worlds, agent, w):
    """Return the poses (T, 2 + units) of a HAV on its way to all goals, along Dubins paths."""
    units = worlds.fleet.num_trailers[agent, w] + 1
    lengths, offsets = worlds.fleet.length[agent, :units, w], offsets_in(worlds.fleet, w)[agent]
    radius = FIELD.widening * drivable_radius(worlds, agent, w)
    pose = np.r_[
        worlds.state.x[agent, w], worlds.state.y[agent, w], worlds.state.heading[agent, :units, w]
    ]
    way = [pose[None]]
    for x, y, heading in worlds.goals[agent, :, :, w]:
        seen = ((x - pose[0]) + 1j * (y - pose[1])) * np.exp(-1j * pose[2])
        word, *parts = shortest_path(seen.real, seen.imag, heading - pose[2], radius)
        for side, part in zip(turns(word), parts, strict=True):
            if part > 0.0:
                at = np.linspace(0.0, part, max(2, int(part / 0.25)))
                args = side / radius, lengths, offsets
                done = scipy.integrate.solve_ivp(
                    rates, (0.0, part), pose, "DOP853", at, args=args, rtol=1e-9, atol=1e-9
                )
                way.append(done.y.T)
                pose = done.y[:, -1]
        assert np.hypot(pose[0] - x, pose[1] - y) < 1e-5
    return np.concatenate(way)


def bodies_on(worlds, agent, w, way):
    """Return the bodies of a HAV at all poses, as Shapely has them."""
    units = way.shape[1] - 2
    lengths, offsets = worlds.fleet.length[agent, :units, w], offsets_in(worlds.fleet, w)[agent]
    along = np.exp(1j * way[:, 2:])
    front = (way[:, 0] + 1j * way[:, 1])[:, None] + lengths[0] * along[:, :1]
    behind = np.cumsum((lengths + offsets[:units]) * along, axis=1)
    fronts = np.concatenate([front, front - behind[:, :-1]], axis=1)
    half, ahead, rear = shapes_in(worlds.fleet, w)[agent, :units].T
    corners = np.stack(
        [
            fronts + (a + side * 1j * half) * along
            for a, side in ((ahead, 1), (ahead, -1), (-lengths - rear, -1), (-lengths - rear, 1))
        ],
        axis=-1,
    )
    return shapely.polygons(np.stack([corners.real, corners.imag], axis=-1)).ravel()


def test_no_wall_is_near_the_way_of_any_hav(worlds):
    walls, least = wall_shapes(worlds), []
    for w in range(worlds.lanes):
        tree = shapely.STRtree(walls[:, w])
        for agent in range(FIELD.num_havs):
            way = way_of(worlds, agent, w)
            bends = np.abs(np.diff(way[:, 2:], axis=1))
            limit = limits_in(worlds.fleet, w, worlds.fleet.limit[:, 2, w])[agent]
            assert (bends <= limit[1 : bends.shape[1] + 1]).all()
            bodies = bodies_on(worlds, agent, w, way)
            _, gaps = tree.query_nearest(bodies, all_matches=False, return_distance=True)
            least.append(gaps.min())
    assert min(least) > FIELD.margin - 0.01
    assert np.median(least) < FIELD.margin + 5.0


def test_nobody_starts_at_a_wall_and_walls_are_as_long_as_they_should_be(worlds):
    assert not touching_walls(worlds).any()
    lengths = shapely.length(wall_shapes(worlds))
    assert FIELD.min_wall - 1e-9 <= lengths.min() < lengths.max() <= FIELD.max_wall + 1e-9
    assert (worlds.place.count == FIELD.num_segments).all()


def test_walls_shorter_than_the_shortest_are_refused():
    with pytest.raises(ValueError, match=r"max_wall is 2\.0, but must be at least min_wall"):
        Batch(Field(max_wall=2.0), 1, vehicle=VEHICLES.make("realistic"))


def test_a_field_without_room_says_so():
    crowded = Field(num_havs=4, side=20.0, pose_attempts=5, world_attempts=3)
    with pytest.raises(ValueError, match="have no room"):
        Batch(crowded, 1, vehicle=VEHICLES.make("realistic")).reset(0)
