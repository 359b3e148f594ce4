"""Rows of rays miss nothing: a brute force casts every ray at every segment and every body."""

import math

import numpy as np
import pytest

from hav_env import Observation, build_site, explicit, sensing
from hav_env.compiled import entry, lowest_bit, single
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.observation.sectors import SECTORS, rays_towards, with_rays
from hav_env.vehicles import OffAxle, Rectangles
from hav_env.world.obstacles.rays import across_segment, may_lie_along, to_segment
from tests.support.budgets import budget

MOST = 50.0
GOALS = [[[90.0, 40.0 * hav, 0.0]] for hav in range(3)]
SITE = build_site(
    lines=[
        [[20.0, 0.0], [30.0, 0.0]],  # along ray 0
        [[0.0, -9.0], [0.0, -30.0]],
        [[-12.0, -7.0], [-12.0, 5.0]],  # behind, across pi
        [[5.0, 5.0], [9.0, 9.0]],  # on a ray of 8, 16 and 32
        [[-6.0, 6.0], [4.0, 6.0]],  # begins on a ray
        [[48.0, 10.0], [53.0, 16.0]],  # partly out of range
        [[-80.0, -60.0], [-60.0, -80.0]],  # out of range
    ]
)


@pytest.mark.parametrize("kind", [float, single])
def test_no_ray_that_meets_a_circle_is_left_out(kind):
    rng = np.random.default_rng(0)
    bearings = [*rng.uniform(-math.pi, math.pi, budget(1000, 300))]
    bearings += [k * math.pi / 4 + e for k in range(-4, 5) for e in (-1e-7, 0.0, 1e-7)]
    for bearing in bearings:
        rays, far = int(rng.integers(1, 129)), 10 ** rng.uniform(-1, 3)
        radius = far * rng.choice([0.0, 1e-3, 0.1, 0.5, 0.999, 1.0, 3.0])
        x, y = far * math.cos(bearing), far * math.sin(bearing)
        first, count = rays_towards(kind(rays), kind(x), kind(y), kind(radius))
        assert 0 <= count <= rays
        assert 0 <= first < rays or count == 0
        cast = {(int(first) + k) % rays for k in range(int(count))}
        half = math.asin(min(radius / far, 1.0)) if radius < far else math.pi
        angles = 2 * math.pi * np.arange(rays) / rays
        off = abs((angles - bearing + math.pi) % (2 * math.pi) - math.pi)
        assert set(np.flatnonzero(off <= half)) <= cast


@entry
def list_sectors(first, last, sectors, listed):
    """Write the indices of the sectors of each row that have rays."""
    for row in range(first, last):
        count, end = 0, sectors.shape[1]
        for start in range(0, end, SECTORS):
            bits = with_rays(sectors[row], start, end)
            while bits != 0:
                listed[row, count] = start + lowest_bit(bits)
                bits &= bits - 1
                count += 1


@pytest.mark.parametrize("lanes", [1, 17, 63, 64, 65, 128])
def test_all_sectors_with_rays_are_listed_in_order(lanes):
    rng = np.random.default_rng(5)
    share = np.linspace(0.0, 1.0, 9)[:, None]
    has = rng.uniform(size=(9, lanes)) < share
    sectors = np.where(has, rng.choice([-256.0, 259.0, 33_000.0], has.shape), 0.0)
    listed = np.full(has.shape, -1)
    list_sectors(len(has), sectors.astype(np.float32), listed)
    for row, found in zip(has, listed, strict=True):
        indices = np.flatnonzero(row)
        assert np.array_equal(found[: indices.size], indices)
        assert (found[indices.size :] == -1).all()
    assert has[-1].all()


def segments_to_cast():
    """Yield direction, middle and half vector of random segments, many of them degenerate."""
    rng = np.random.default_rng(1)
    for _ in range(budget(4000, 1000)):
        angle, bearing = 2 * math.pi * rng.integers(0, 32) / 32, rng.uniform(-math.pi, math.pi)
        tilt = rng.choice([0.0, math.pi, 1e-8, 1e-6, 3e-6, 1e-4, bearing, bearing])
        far = rng.choice([0.0, 1.0, 1.0, 30.0, -20.0])
        aside = rng.choice([0.0, 1e-11, 1e-9, 1e-7, 1e-5, 1e-3, 4.0])
        half = rng.choice([0.0, 1.0, 10.0, abs(far)])  # with its length, an end is at the origin
        x = far * math.cos(angle) - aside * math.sin(angle)
        y = far * math.sin(angle) + aside * math.cos(angle)
        along = angle + tilt
        yield (
            *(math.cos(angle), math.sin(angle), x, y),
            *(half * math.cos(along), half * math.sin(along), half),
        )


@pytest.mark.parametrize("kind", [float, single])
def test_only_segments_that_may_lie_along_rays_need_the_longer_formula(kind):
    short = met = 0
    for case in segments_to_cast():
        *direction, x, y, half_x, half_y, half = map(kind, case)
        if not may_lie_along(x, y, half_x, half_y, half):
            length = to_segment(*direction, x, y, half_x, half_y)
            assert across_segment(*direction, x, y, half_x, half_y) == length
            short, met = short + 1, met + (length < math.inf)
    assert short > 300
    assert met > 30


@pytest.mark.exhaustive
@pytest.mark.parametrize("rays", [1, 3, 16, 32, 128])
def test_rows_are_those_of_every_ray_at_every_segment(rays):
    count = budget(17, 2)
    starts = [[0.0, 0.0, 0.0], [14.0, 11.0, 2.0], [400.0, 0.0, 0.0]]
    scenario = explicit([[4.0, 5.0]] * 3, starts, GOALS, site=SITE)
    process = DecisionProcess(
        count,
        scenario=scenario,
        vehicle=OffAxle(bodies=Rectangles()),
        observation=Observation(neighbors=1, rays=rays, ray_range=MOST),
    )
    outcome = process.outcome()
    process.begin(np.zeros(count, int), np.arange(count), np.ones(count, np.bool_), outcome)
    columns = [process.columns.index(f"ray_{k}") for k in range(rays)]
    actions = np.random.default_rng(2).uniform(-1, 1, (count, 3, 2)).astype(np.float32)
    worlds, met = process.batch.worlds, 0
    for _ in range(budget(4, 2)):
        for w in range(count):
            for agent in range(3):
                seen = MOST * outcome.observation[w, agent, columns]
                angles = 2 * math.pi * np.arange(rays) / rays
                known = np.array(
                    [
                        [
                            sensing.ray(worlds, agent, math.cos(a + e), math.sin(a + e), MOST, w)
                            for a in angles
                        ]
                        for e in (-1e-5, 0.0, 1e-5)  # in single precision, an end may be passed
                    ]
                )
                assert (abs(seen - known).min(axis=0) < 2e-3).all()
                met += (seen < MOST).sum()
        outcome = process.step(actions)
    assert met > 0


def observed_after_a_step(episodes):
    """Return the rays of worlds a step after the given episodes begin."""
    count = len(episodes)
    process = DecisionProcess(
        count,
        scenario="field-4",
        vehicle="realistic",
        observation=Observation(neighbors=1, rays=24, ray_range=MOST),
    )
    outcome = process.outcome()
    process.begin(np.full(count, 6), episodes, np.ones(count, np.bool_), outcome)
    outcome = process.step(np.zeros((count, 4, 2), np.float32))
    rays = [name.startswith("ray") for name in process.columns]
    return outcome.observation[..., rays]


@pytest.mark.exhaustive
def test_rows_do_not_depend_on_the_lane():
    together = observed_after_a_step(np.arange(budget(131, 5)))
    assert (together < 1.0).any(axis=2).mean() > 0.5
    for w in {0, 4, 63, 64, 127, 128, 130}.intersection(range(len(together))):
        alone = observed_after_a_step(np.array([w]))
        assert np.array_equal(alone[0], together[w])
