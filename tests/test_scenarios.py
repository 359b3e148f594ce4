"""Episodes are drawn as section V of the paper says, or as somebody has written them down."""

import itertools
import json
import math

import numpy as np
import pytest
from conftest import bits, budget
from scipy import stats

from hav_env import Batch, PlacementError, RandomPoses, explicit, load_explicit
from hav_env.world import FOOTPRINT, POTENTIAL

MANY = budget(4_000, 300)


def sample(scenario, num_worlds=MANY, seed=1):
    batch = Batch(scenario, num_worlds)
    batch.reset(seed)
    return batch.worlds


def rayleigh(low, high):
    return stats.rayleigh.cdf(high, scale=3.0) - stats.rayleigh.cdf(low, scale=3.0)


COUNTS = np.arange(1, 11)
INSIDE = rayleigh(COUNTS, COUNTS + 1)
CLIPPED = np.r_[rayleigh(0, 2), INSIDE[1:-1], rayleigh(10, np.inf)]
ROUNDED = np.r_[rayleigh(0, 1.5), rayleigh(COUNTS - 0.5, COUNTS + 0.5)[1:-1], rayleigh(9.5, np.inf)]


@pytest.mark.parametrize(
    ("options", "shares"),
    [
        ({"trailer_offset": 0.0, "trailer_redraw": False}, CLIPPED),
        ({"trailer_offset": 0.5, "trailer_redraw": False}, ROUNDED),
        ({"trailer_offset": 0.0, "trailer_redraw": True}, INSIDE / INSIDE.sum()),
    ],
    ids=["cut", "rounded", "redrawn"],
)
def test_trailer_counts_have_the_rayleigh_distribution(options, shares):
    counts = sample(RandomPoses(**options)).fleet.num_trailers.ravel()
    found = np.bincount(counts, minlength=11)
    assert found[0] == 0
    assert len(found) == 11
    assert stats.chisquare(found[1:], shares * MANY).pvalue > 1e-3


def test_truck_lengths_have_the_truncated_mixture_of_normals():
    def below(length):
        return 0.5 * stats.norm.cdf(length, 4.0, 0.6) + 0.5 * stats.norm.cdf(length, 10.7, 1.2)

    trucks = sample(RandomPoses(num_havs=2)).fleet.length[:, 0].ravel()
    assert trucks.min() >= 2.0
    assert trucks.max() < 12.0
    truncated = stats.kstest(
        trucks, lambda length: (below(length) - below(2.0)) / (below(12.0) - below(2.0))
    )
    assert truncated.pvalue > 1e-3


def test_trailer_lengths_are_uniform_and_independent():
    fleet = sample(RandomPoses()).fleet
    lengths, num_trailers = fleet.length[0, 1:], fleet.num_trailers[0]
    present = np.arange(1, 11)[:, None] <= num_trailers
    assert stats.kstest((lengths[present] - 2.0) / 10.0, "uniform").pvalue > 1e-3
    assert np.isinf(lengths[~present]).all()
    long = num_trailers >= 2
    for one in (fleet.length[0, 0], num_trailers, lengths[1]):
        correlation = stats.spearmanr(one[long], lengths[0][long]).statistic
        assert abs(correlation) < 4.0 / math.sqrt(long.sum())


@pytest.mark.parametrize("factor", [4.0, 2.0])
def test_poses_of_a_single_hav_are_uniform_in_a_square_of_four_footprints(factor):
    worlds = sample(RandomPoses(area_factor=factor))
    side = np.sqrt(factor * math.pi * worlds.fleet.radius[0, FOOTPRINT] ** 2)
    sizes = side, side, math.tau
    poses = [(worlds.state.x[0], worlds.state.y[0], worlds.state.heading[0, 0])]
    poses += [tuple(worlds.goals[0, g]) for g in range(2)]
    shares = [part / size for pose in poses for part, size in zip(pose, sizes, strict=True)]
    for share in shares:
        assert stats.kstest(share, "uniform").pvalue > 1e-3
    for one, other in itertools.combinations(shares, 2):
        assert abs(stats.spearmanr(one, other).statistic) < 4.0 / math.sqrt(MANY)


def places_of(worlds):
    """Return the positions of starts and goals (1 + G, N, 2, W)."""
    starts = np.stack([worlds.state.x, worlds.state.y], axis=1)
    return np.concatenate([starts[None], np.moveaxis(worlds.goals[:, :, :2], 1, 0)])


@pytest.mark.parametrize(("num_havs", "compiled", "pure"), [(2, 3000, 150), (5, 1500, 40)])
@pytest.mark.parametrize("factor", [4.0, 2.5])
def test_nobody_starts_or_ends_in_potential_collision(num_havs, compiled, pure, factor):
    assert_apart(RandomPoses(num_havs=num_havs, num_goals=3, area_factor=factor), compiled, pure)


def test_nobody_of_a_swarm_starts_or_ends_in_potential_collision():
    assert_apart(RandomPoses(num_havs=20), 300, 5)


def assert_apart(scenario, compiled, pure):
    worlds = sample(scenario, budget(compiled, pure), seed=7)
    places, radius = places_of(worlds), worlds.fleet.radius[:, FOOTPRINT]
    side = np.sqrt(scenario.area_factor * math.pi * (radius**2).sum(axis=0))
    assert (places >= 0.0).all()
    assert (places <= side).all()
    for i, h in itertools.combinations(range(scenario.num_havs), 2):
        gaps = np.hypot(*np.moveaxis(places[:, i] - places[:, h], 1, 0))
        assert (gaps > radius[i] + radius[h]).all()
    assert (worlds.record.first[:, POTENTIAL] == -1).all()  # and nothing has happened yet


def test_everybody_starts_without_articulation():
    worlds = sample(RandomPoses(num_havs=3), 50)
    assert (np.ptp(worlds.state.heading, axis=1) == 0.0).all()
    assert worlds.state.cosine == pytest.approx(np.cos(worlds.state.heading), abs=1e-15)
    assert worlds.state.sine == pytest.approx(np.sin(worlds.state.heading), abs=1e-15)


@pytest.mark.parametrize("num_havs", [1, 2, 20])
def test_an_episode_does_not_depend_on_the_others(num_havs):
    together, alone = Batch(RandomPoses(num_havs=num_havs), 12), Batch(RandomPoses(num_havs), 1)
    together.reset(5)
    for episode in (0, 3, 11):
        alone.reset(5, np.array([episode]))
        assert bits(alone.worlds) == bits(together.worlds, episode)


def test_an_episode_depends_on_seed_and_number():
    batch, seen = Batch(RandomPoses(), 8), set()
    for seed in (0, 1, 2**32 - 1):
        batch.reset(seed)
        seen |= {tuple(bits(batch.worlds, w)) for w in range(8)}
    assert len(seen) == 24


def test_beginning_again_forgets_the_episode_before():
    fresh, used = Batch(RandomPoses(num_havs=3), 2), Batch(RandomPoses(num_havs=3), 2)
    fresh.reset(4)
    used.reset(9)
    for _ in range(20):
        used.step(np.ones((3, 2)), np.full((3, 2), 0.5))
    used.reset(4)
    assert [bits(used.worlds, w) for w in (0, 1)] == [bits(fresh.worlds, w) for w in (0, 1)]


def test_a_density_out_of_reach_is_an_error_that_says_so():
    crowded = RandomPoses(num_havs=20, area_factor=0.3, pose_attempts=10, world_attempts=2)
    with pytest.raises(PlacementError, match=r"3 of 3 worlds have no room for 20 HAVs.*0\.3"):
        Batch(crowded, 3).reset(0)


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
    ("field", "value"),
    [
        *((field, math.nan) for field in RandomPoses._fields if field != "trailer_redraw"),
        ("area_factor", math.inf),
        ("num_havs", 0),
        ("num_goals", 0),
        ("min_trailers", 0),
        ("max_trailers", 0),
        ("trailer_sigma", 0.0),
        ("min_length", 0.0),
        ("max_length", 2.0),
        ("short_truck_mean", 0.5),
        ("short_truck_mean", 13.5),
        ("long_truck_mean", -10.7),
        ("short_truck_deviation", 0.0),
        ("long_truck_deviation", -1.0),
        ("area_factor", 0.0),
        ("footprint_truck_share", -0.1),
        ("footprint_truck_share", 1.1),
        ("speed_max", 0.0),
        ("steering_max", 0.0),
        ("steering_max", math.pi / 2),
        ("articulation_max", 0.0),
        ("articulation_max", 3.2),
        ("pose_attempts", 0),
        ("world_attempts", 0),
    ],
)
def test_a_bad_parameter_of_a_random_scenario_is_named(field, value):
    with pytest.raises(ValueError, match=f"{field} is {value}, but must be"):
        Batch(RandomPoses()._replace(**{field: value}))


@pytest.mark.parametrize("scenario", [None, "random", (1, 2), 5])
def test_what_is_no_scenario_is_an_error(scenario):
    with pytest.raises(TypeError, match="is not a scenario"):
        Batch(scenario)


HAV = {"lengths": [4.0, 6.0], "start": [0.0, 0.0, 0.5], "goals": [[90.0, 0.0, 1.0]]}
OTHER = {"lengths": [3, 2, 5], "start": [30, 0, 0], "goals": [[-90, 0, 0]]}


def written(*havs, **limits):
    columns = [[hav[name] for hav in havs] for name in ("lengths", "start", "goals")]
    return explicit(*columns, **limits)


def test_a_written_scenario_is_what_was_written():
    batch = Batch(written(HAV, OTHER, speed_max=2.0, steering_max=0.5, articulation_max=1.0), 2)
    batch.reset(0)
    for w in range(2):
        world = batch.world(w)
        assert world.fleet.num_trailers.tolist() == [1, 2]
        assert world.fleet.length.tolist() == [[4, 6, math.inf], [3, 2, 5]]
        assert world.fleet.limit[:, :3].tolist() == [[2.0, 0.5, 1.0]] * 2
        assert world.state.x.tolist() == [0, 30]
        assert world.state.heading.tolist() == [[0.5] * 3, [0.0] * 3]
        assert world.goals.tolist() == [[[90, 0, 1]], [[-90, 0, 0]]]
        assert world.fleet.radius[:, FOOTPRINT].tolist() == [6, 7]


def test_a_scenario_from_a_file_is_the_same(tmp_path):
    (tmp_path / "two.json").write_text(json.dumps({"havs": [HAV, OTHER], "speed_max": 2.0}))
    loaded, given = load_explicit(tmp_path / "two.json"), written(HAV, OTHER, speed_max=2.0)
    for one, other in zip(loaded, given, strict=True):
        assert np.array_equal(one, other)


BAD = [
    ({"lengths": [4.0]}, "HAV 0.*truck and at least one trailer"),
    ({"lengths": [4.0, -6.0]}, "HAV 0 has lengths"),
    ({"lengths": [0.0, 6.0]}, "HAV 0 has lengths"),
    ({"lengths": [math.nan, 6.0]}, "HAV 0 has lengths"),
    ({"lengths": [4.0, math.inf]}, "HAV 0 has lengths"),
    ({"start": [0.0, 0.0]}, "HAV 0.*not a pose"),
    ({"start": [0.0, math.nan, 0.0]}, "HAV 0 has a pose that is not finite"),
    ({"goals": []}, "HAV 0 has 0 goals"),
    ({"goals": [[90.0, 0.0, 0.0]] * 2}, "HAV 1 has 1 goals"),
    ({"goals": [[90.0, 0.0, 0.0, 0.0]]}, "HAV 0.*not a pose"),
    ({"goals": [[90.0, math.inf, 0.0]]}, "HAV 0 has a pose that is not finite"),
    ({"start": [17.0, 0.0, 0.0]}, r"starts of HAVs 0 and 1 are 13\.00 m apart"),  # just touching
    ({"goals": [[-85.0, 0.0, 0.0]]}, "goals 1 of HAVs 0 and 1"),
]


@pytest.mark.parametrize(("change", "message"), BAD)
def test_a_mistake_in_a_written_scenario_is_named(change, message, tmp_path):
    with pytest.raises(ValueError, match=message):
        written(HAV | change, OTHER)
    path = tmp_path / "bad.json"
    path.write_text(json.dumps({"havs": [HAV | change, OTHER]}))
    with pytest.raises(ValueError, match=rf"bad\.json.*{message}"):
        load_explicit(path)


@pytest.mark.parametrize(
    ("field", "value"),
    [(f, v) for f in ("speed_max", "steering_max", "articulation_max") for v in (0, -1, math.nan)]
    + [("speed_max", math.inf), ("steering_max", math.pi / 2), ("articulation_max", 3.2)],
)
def test_a_bad_limit_of_a_written_scenario_is_named(field, value):
    with pytest.raises(ValueError, match=f"{field} is"):
        written(HAV, **{field: value})


def test_an_articulation_limit_of_half_a_turn_is_allowed():
    assert written(HAV, articulation_max=math.pi).articulation_max == math.pi


def test_lists_of_unequal_length_are_an_error():
    with pytest.raises(ValueError, match="1 HAVs have lengths, 2 a start and 1 goals"):
        explicit([[4, 6]], [[0, 0, 0], [30, 0, 0]], [[[9, 9, 9]]])
    with pytest.raises(ValueError, match="at least one HAV"):
        explicit([], [], [])


def test_arrays_will_do_for_lists():
    from_arrays = explicit(
        np.array([HAV["lengths"]]), np.array([HAV["start"]]), np.array([HAV["goals"]])
    )
    for one, other in zip(from_arrays, written(HAV), strict=True):
        assert np.array_equal(one, other)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "not a JSON file"),
        ("", "not a JSON file"),
        ("\udcff", "not a JSON file"),
        ("[]", 'an object with a list "havs"'),
        ("{}", 'an object with a list "havs"'),
        ('{"havs": []}', "at least one HAV"),
        ('{"havs": [5]}', "HAV 0 must have"),
        ('{"havs": [{"lengths": [4, 6]}]}', "HAV 0 must have"),
        (json.dumps({"havs": [HAV | {"colour": 1}]}), "HAV 0 must have"),
        (json.dumps({"havs": [HAV], "speed": 1}), "unknown entry 'speed'"),
        (json.dumps({"havs": [HAV], "speed_max": "fast"}), "fast"),
        (json.dumps({"havs": [HAV], "speed_max": None}), "not a number"),
        (json.dumps({"havs": [HAV | {"lengths": 5}]}), "is not a list"),
        (json.dumps({"havs": [HAV | {"goals": 5}]}), "is not a list"),
        (json.dumps({"havs": [HAV | {"goals": [5]}]}), "is not a list"),
        (json.dumps({"havs": [HAV | {"start": ["a", 0, 0]}]}), "a"),
    ],
)
def test_a_file_that_holds_no_scenario_is_an_error_that_names_it(text, message, tmp_path):
    path = tmp_path / "scenario.json"
    path.write_bytes(text.encode(errors="surrogateescape"))
    with pytest.raises(ValueError, match=rf"scenario\.json.*{message}"):
        load_explicit(path)


def test_a_file_that_is_missing_is_an_error(tmp_path):
    with pytest.raises(FileNotFoundError, match="nothing"):
        load_explicit(tmp_path / "nothing.json")
