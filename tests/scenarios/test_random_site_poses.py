"""Random poses on sites: by Shapely, all bodies are clear, and by SciPy, paths are free."""

import functools
import json

import numpy as np
import pytest
import shapely

from baselines.__main__ import main
from hav_env import (
    Batch,
    Explicit,
    PlacementError,
    RandomPoses,
    RandomSitePoses,
    build_site,
    catalogue_fleet,
    evaluate,
    load_site,
    parallel_env,
)
from hav_env.cli.play import Play, open_environment
from hav_env.places import NOWHERE
from hav_env.places.areas import free_area
from hav_env.scenarios.presets import find_scenario, scenario_of
from hav_env.vehicles import VEHICLES
from hav_env.world.arrays import put_straight
from tests.support.budgets import budget
from tests.support.obstacles import body_shapes, gaps_to_walls
from tests.support.paths import ROOT
from tests.support.ways import way_bodies, way_of

YARD = load_site(ROOT / "examples/yard.geojson")
FLEET = catalogue_fleet(["eu-semi-trailer", "terminal-tractor"])
REAL = RandomSitePoses(YARD, num_havs=3, fleet=FLEET)
PAPER = scenario_of("paper-pair", 3, YARD)
kinds = pytest.mark.parametrize(
    ("scenario", "vehicle"), [(REAL, "realistic"), (PAPER, "on_axle")], ids=["real", "paper"]
)


def begun(scenario, vehicle, num_worlds, seed=5):
    batch = Batch(scenario, num_worlds, vehicle=VEHICLES.make(vehicle), threads=1)
    batch.reset(seed)
    return batch.worlds


@kinds
@pytest.mark.exhaustive
def test_starts_and_goals_are_clear_of_segments_and_of_each_other(scenario, vehicle):
    worlds, free = begun(scenario, vehicle, budget(60, 3)), free_area(YARD)
    for phase in range(-1, scenario.num_goals):
        for agent in range(scenario.num_havs if phase >= 0 else 0):
            for w in range(worlds.lanes):
                put_straight(worlds.state, agent, w, *worlds.goals[agent, phase, :, w])
        assert gaps_to_walls(worlds).min() > scenario.margin
        bodies = shapely.union_all(body_shapes(worlds), axis=1)  # (N, W)
        for one in range(scenario.num_havs):
            for other in range(one):
                assert (shapely.distance(bodies[one], bodies[other]) > scenario.margin).all()
        assert shapely.contains(free, bodies).all()


@pytest.mark.exhaustive
@kinds
def test_free_ways_touch_nothing(scenario, vehicle):
    """Their margin was kept at steps of half a metre: SciPy's path is between them, too."""
    scenario = scenario._replace(num_havs=2, free_ways=True)
    worlds = begun(scenario, vehicle, budget(8, 1))
    walls = shapely.STRtree(shapely.linestrings(YARD.segment.reshape(-1, 2, 2)))
    for w in range(worlds.lanes):
        for agent in range(2):
            way = way_of(worlds, agent, w, scenario.widening)
            _, gaps = walls.query_nearest(
                way_bodies(worlds, agent, w, way), all_matches=False, return_distance=True
            )
            assert gaps.min() > scenario.margin - 0.02


def test_poses_are_drawn_from_all_of_the_free_area():
    """Of a yard in two halves both are used alike, and no heading is more frequent."""
    site = build_site([(0, 0), (200, 0), (200, 100), (0, 100)], lines=[[(100, 0), (100, 100)]])
    scenario = scenario_of("paper-single", site=site)._replace(num_goals=1)
    worlds = begun(scenario, "realistic", count := budget(2_000, 40))
    left = np.count_nonzero(worlds.state.x[0] < 100)
    assert abs(left - count / 2) < 4 * np.sqrt(count / 4)
    assert abs(np.exp(1j * worlds.goals[0, 0, 2]).mean()) < 4 / np.sqrt(count)


def test_without_a_boundary_poses_lie_in_the_box_of_the_segments():
    site = build_site(
        lines=[[(-500.0, 300.0), (-300.0, 310.0)], [(-400.0, 500.0), (-390.0, 500.0)]]
    )
    worlds = begun(scenario_of("paper-single", site=site), "realistic", budget(50, 5))
    assert ((worlds.state.x >= -500) & (worlds.state.x <= -300)).all()
    assert ((worlds.state.y >= 300) & (worlds.state.y <= 500)).all()


def test_a_site_without_room_is_named():
    crowded = scenario_of("swarm-50", site=YARD)._replace(pose_attempts=3, world_attempts=2)
    told = r"1 of 1 worlds have no space for 50 HAVs.*Site\(72 segments, x from 0 to 120 m, y from"
    with pytest.raises(PlacementError, match=told):
        begun(crowded, "realistic", 1)


def test_a_site_and_its_file_make_the_same_scenario(tmp_path):
    file = tmp_path / "yard.json"
    file.write_text(json.dumps({"boundary": [[0, 0], [90, 0], [90, 60], [0, 60]]}))
    chosen = scenario_of("dense-5", 2, file)
    assert isinstance(chosen, RandomSitePoses)
    assert (chosen.num_havs, chosen.num_goals, chosen.fleet) == (2, 2, RandomPoses().fleet)
    assert np.array_equal(chosen.site.segment, load_site(file).segment)
    again = scenario_of(chosen, site=YARD)
    assert again.site is YARD
    env = parallel_env(scenario="paper-pair", site=str(file))
    assert np.array_equal(env.scenario.site.segment, chosen.site.segment)


def test_havs_that_are_written_down_stand_on_a_site_if_they_are_clear_of_it():
    written = find_scenario(ROOT / "examples/two_havs.json")
    far = build_site(lines=[[(-900.0, 0.0), (-900.0, 5.0)]])
    placed = scenario_of(written, site=far)
    assert isinstance(placed, Explicit)
    assert placed.site is far
    with pytest.raises(ValueError, match=r"scenario has Site\(1 segments.*but must have no site"):
        scenario_of(placed, site=far)
    x, y, _ = written.start[0]
    with pytest.raises(ValueError, match=r"the start of HAV 0 is at .* must not touch a line"):
        scenario_of(written, site=build_site(lines=[[(x - 0.5, y - 9.0), (x - 0.5, y + 9.0)]]))


@pytest.mark.parametrize("name", ["crossing-2", "yard-4", "column-5", "field-1", "docks-6"])
def test_scenarios_with_a_layout_of_their_own_have_no_other_site(name):
    own = type(find_scenario(name)).__name__
    with pytest.raises(ValueError, match=f"of the class {own}, but must be RandomPoses or written"):
        scenario_of(name, site=YARD)


@pytest.mark.parametrize(
    ("site", "error", "message"),
    [
        (5, TypeError, "site is 5, but must be a Site or the path of a file"),
        (NOWHERE, ValueError, "site has no segments, but must have at least one"),
        ("none.json", OSError, "none.json"),
        ("yard.png", ValueError, "must end in one of: .json"),
    ],
)
def test_what_is_no_site_is_an_error(site, error, message):
    with pytest.raises(error, match=message):
        scenario_of("paper-pair", site=site)


def test_environments_evaluations_and_commands_take_a_site(capsys):
    """Scenarios that cannot have a site report it."""
    told = "scenario is of the class Crossing, but must be RandomPoses or written down"
    for call in (parallel_env, functools.partial(evaluate, "random")):
        with pytest.raises(ValueError, match=told):
            call(scenario="crossing-2", site=YARD)
    path = str(ROOT / "examples/yard.geojson")
    for command in ("evaluate", "watch"):
        assert main([command, "random", "--scenario", "crossing-2", "--site", path]) == 2
        assert told in capsys.readouterr().err
    with pytest.raises(ValueError, match=told):
        open_environment(Play(scenario="crossing-2", site=path), None)
