"""Laws of every scenario that draws its episodes."""

import itertools
import math
import os
import subprocess
import sys

import numpy as np
import pytest

from hav_env import Batch, Crossing, RandomFleet, RandomPoses, build_site, find_scenario
from hav_env.scenarios import Explicit, Field, RandomSitePoses, SitePoses, populate
from hav_env.vehicles import VEHICLES
from hav_env.world.arrays import FOOTPRINT, POTENTIAL
from tests.support.budgets import COMPARED, COMPILED, budget
from tests.support.worlds import bits, places_of, sample

REAL = "field-4", "docks-6", "random poses on a site"
AMONG_WALLS = Explicit, Field, RandomSitePoses, SitePoses
DRAWN = [kind for kind in populate.table if kind not in AMONG_WALLS]
every_kind = pytest.mark.parametrize("kind", DRAWN)


@every_kind
@pytest.mark.parametrize(
    ("num_havs", "compiled", "pure"), [(1, 50, 5), (2, 3000, 100), (5, 1500, 30), (20, 300, 3)]
)
@pytest.mark.parametrize("share", [0.0, 1.0])
def test_nobody_starts_or_ends_in_potential_collision(kind, num_havs, compiled, pure, share):
    fleet = RandomFleet(footprint_truck_share=share)
    scenario = kind(num_havs=num_havs, num_goals=3, fleet=fleet)
    worlds = sample(scenario, budget(compiled, pure), seed=7)
    places, radius = places_of(worlds), worlds.fleet.radius[:, FOOTPRINT]
    gap = getattr(scenario, "gap", 0.0)
    for i, h in itertools.combinations(range(num_havs), 2):
        distance = np.hypot(*np.moveaxis(places[:, i] - places[:, h], 1, 0))
        assert (distance > radius[i] + radius[h]).all()
        assert (distance > radius[i] + radius[h] + gap - 1e-9).all()
    assert (worlds.record.first[:, POTENTIAL] == -1).all()  # and nothing has happened yet


@every_kind
def test_everybody_starts_without_articulation(kind):
    worlds = sample(kind(num_havs=3), 50)
    assert (np.ptp(worlds.state.heading, axis=1) == 0.0).all()
    assert worlds.state.cosine == pytest.approx(np.cos(worlds.state.heading), abs=1e-15)
    assert worlds.state.sine == pytest.approx(np.sin(worlds.state.heading), abs=1e-15)


@every_kind
@pytest.mark.parametrize("num_havs", [1, 2, 20])
def test_an_episode_does_not_depend_on_the_others(kind, num_havs):
    scenario = kind(num_havs=num_havs, num_goals=2)
    together, alone = Batch(scenario, 12), Batch(scenario, 1)
    together.reset(5)
    for episode in (0, 3, 11):
        alone.reset(5, np.array([episode]))
        assert bits(alone.worlds) == bits(together.worlds, episode)


def real_place(name):
    """Return a scenario among walls by its name in these tests."""
    if name in REAL[:2]:
        return find_scenario(name)
    site = build_site([(0, 0), (300, 0), (300, 300)], [[(150, 50), (200, 60), (180, 90)]])
    return RandomSitePoses(site, num_havs=2)


@pytest.mark.parametrize("name", REAL)
def test_nor_does_one_at_a_real_place(name):
    sizes = budget((12, 1), (3, 1))
    together, alone = (
        Batch(real_place(name), size, vehicle=VEHICLES.make("realistic")) for size in sizes
    )
    together.reset(5)
    for episode in budget((0, 3, 11), (0, 2)):
        alone.reset(5, np.array([episode]))
        assert bits(alone.worlds) == bits(together.worlds, episode)
        walls = together.worlds.place.segment[..., episode]
        assert np.array_equal(alone.worlds.place.segment[..., 0], walls)


@every_kind
def test_an_episode_depends_on_seed_and_number(kind):
    batch, seen = Batch(kind(), 8), set()
    for seed in (0, 1, 2**32 - 1):
        batch.reset(seed)
        seen |= {tuple(bits(batch.worlds, w)) for w in range(8)}
    assert len(seen) == 24


@every_kind
def test_beginning_again_forgets_the_episode_before(kind):
    fresh, used = Batch(kind(num_havs=3), 2), Batch(kind(num_havs=3), 2)
    fresh.reset(4)
    used.reset(9)
    for _ in range(20):
        used.step(np.ones((3, 2)), np.full((3, 2), 0.5))
    used.reset(4)
    assert [bits(used.worlds, w) for w in (0, 1)] == [bits(fresh.worlds, w) for w in (0, 1)]


SCRIPT = """
import hashlib
from hav_env import Batch
from hav_env.world.lanes import view_of
from hav_env import RandomSitePoses, build_site, find_scenario
from hav_env.scenarios import populate
from hav_env.vehicles import VEHICLES
from hav_env.world.units.parts import arrays_in

walled = "Explicit", "Field", "RandomSitePoses", "SitePoses"
plain = [kind for kind in populate.table if kind.__name__ not in walled]
site = build_site([(0, 0), (300, 0), (300, 300)], [[(150, 50), (200, 60), (180, 90)]])
for kind in (*plain, "field-4", "docks-6", RandomSitePoses):
    for num_havs in (1, 2, 5):
        if isinstance(kind, str):
            scenario, vehicle = find_scenario(kind)._replace(num_havs=num_havs), "realistic"
        elif kind is RandomSitePoses:
            scenario, vehicle = kind(site, num_havs), "realistic"
        else:
            scenario, vehicle = kind(num_havs=num_havs, num_goals=2), "on_axle"
        batch = Batch(scenario, 5, vehicle=VEHICLES.make(vehicle))
        batch.reset(3)
        for w in range(5):
            world = view_of(batch.worlds, w)
            parts = world.state, world.fleet, world.goals, world.nearby.count, world.record
            found = hashlib.sha256(b"".join(array.tobytes() for array in arrays_in(parts)))
            print(kind, num_havs, w, found.hexdigest())
"""


@pytest.mark.skipif(not COMPILED, reason=COMPARED)
def test_compiled_code_and_pure_python_draw_the_same_bits(capsys):
    other_mode = os.environ | {"NUMBA_DISABLE_JIT": "1", "HAV_THREADS": "1"}
    command = [sys.executable, "-c", SCRIPT]
    other = subprocess.run(command, env=other_mode, capture_output=True, text=True, check=True)
    exec(SCRIPT, {})
    own = capsys.readouterr().out
    assert len(own.splitlines()) == 15 * len((*DRAWN, *REAL))
    assert own == other.stdout


def test_numbers_of_episodes_must_match_the_worlds():
    with pytest.raises(ValueError, match="episodes"):
        Batch(RandomPoses(), 8).reset(0, np.arange(3))


@pytest.mark.parametrize("episode", [-1, 2**32])
def test_a_number_of_an_episode_beyond_32_bits_is_an_error(episode):
    with pytest.raises(ValueError, match="episode"):
        Batch(RandomPoses(), 1).reset(0, np.array([episode]))


@pytest.mark.parametrize("seed", [-1, 2**32, 10**30])
def test_a_seed_beyond_32_bits_is_an_error(seed):
    with pytest.raises(ValueError, match=f"seed is {seed}"):
        Batch(RandomPoses(), 1).reset(seed)


@pytest.mark.parametrize(
    ("kind", "field", "value"),
    [
        *(
            (kind, field, value)
            for value in (math.nan, 0)
            for kind in (*DRAWN, Field)
            for field in kind._fields
            if field != "fleet" and (field, value) != ("num_segments", 0)
        ),
        (Crossing, "gap", -1.0),
        (Crossing, "gap", math.inf),
    ],
)
def test_a_bad_parameter_of_a_scenario_is_named(kind, field, value):
    with pytest.raises(ValueError, match=f"scenario {field} is {value}, but must be"):
        Batch(kind()._replace(**{field: value}))


@pytest.mark.parametrize("scenario", [None, "random", (1, 2), 5])
def test_what_is_no_scenario_is_an_error(scenario):
    with pytest.raises(TypeError, match="is not a scenario"):
        Batch(scenario)
