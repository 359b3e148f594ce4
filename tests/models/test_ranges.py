"""Inside the stated ranges everything works; values outside are rejected by name."""

import math
import pathlib
from typing import Any, get_args, get_origin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from baselines.policies.avoid_jack import AvoidJack
from baselines.policies.dubins_pursuit import DubinsPursuit
from baselines.policies.random import Random
from baselines.policies.reserve import Reserve
from baselines.replay.trajectory import record_trajectory
from hav_env import (
    Column,
    Crossing,
    Field,
    Instant,
    Limited,
    Observation,
    OffAxle,
    OnAxle,
    PlacementError,
    RandomFleet,
    RandomPoses,
    Rectangles,
    Reward,
    SiteReward,
    Task,
    Yard,
    catalogue_fleet,
    parallel_env,
)
from hav_env.guidance import Feasible, Lattice, Roads
from hav_env.maths.elementary import sincos
from hav_env.maths.random_numbers import Seed
from hav_env.models.annotations import kinds_of, split_range
from hav_env.models.checks import check_fields
from hav_env.models.quantities import (
    Coordinate,
    Duration,
    Havs,
    Heading,
    Length,
    Skipped,
    Speed,
    Steering,
    Steps,
    Threads,
    Worlds,
)
from hav_env.scenarios import CatalogueFleet
from tests.support.budgets import budget
from train.curriculum import Curriculum

MODELS = (Task, RandomFleet, RandomPoses, Crossing, Yard, Column, OnAxle, OffAxle, Rectangles)
MODELS += (Observation, Reward, SiteReward, Field, Lattice, Limited, AvoidJack, DubinsPursuit)
MODELS += (Feasible, Roads, Random, Reserve, Curriculum)
FIELDS = [
    (model, field, *split_range(kind))
    for model in MODELS
    for field, kind in kinds_of(model).items()
]
UNLIMITED = {"goal_speed"}
NUMBERS = [place for place in FIELDS if place[2] in (int, float)]

ARGUMENTS = {
    "num_havs": Havs,
    "num_envs, num_worlds": Worlds,
    "frame_skip": Skipped,
    "threads": Threads,
    "seed, episode": Seed,
    "x, y": Coordinate,
    "heading": Heading,
    "lengths": Length,
}


def table(places) -> str:
    """Return rows of the least and the largest numbers, for the page."""
    rows = []
    for name, kind in places:
        _, allowed = split_range(kind)
        low, high = (
            f"{f'{n:,}' if isinstance(n, int) else f'{n:.6g}'} {allowed.unit}".rstrip()
            for n in (allowed.low, allowed.high)
        )
        rows.append(f"| `{name}` | {low} | {high} |")
    return "\n".join(rows)


def page() -> str:
    """Return the tables of docs/ranges.md."""
    head = "| argument | least | most |\n|---|---|---|\n"
    parts = [f"## Numbers beside the models\n\n{head}{table(ARGUMENTS.items())}"]
    for model in MODELS:
        numbers = [(field, kind) for field, kind in kinds_of(model).items() if split_range(kind)[1]]
        parts.append(f"## `{model.__name__}`\n\n{head}{table(numbers)}")
    return "\n\n".join(parts) + "\n"


def test_the_page_states_the_ranges():
    written = pathlib.Path("docs/ranges.md").read_text()
    assert written.endswith(page()), f"end docs/ranges.md with:\n{page()}"


@pytest.mark.parametrize(("model", "field", "kind", "allowed"), NUMBERS)
def test_every_number_of_every_model_has_a_range(model, field, kind, allowed):
    assert allowed is not None
    assert -math.inf < allowed.low < allowed.high
    assert allowed.high < math.inf or field in UNLIMITED
    assert allowed.low <= model._field_defaults[field] <= allowed.high


def beyond(kind, allowed):
    if kind is int:
        return [allowed.low - 1, allowed.high + 1, -(10**30), 10**30, 10**5000]
    out = [math.nextafter(allowed.low, -math.inf), math.nextafter(allowed.high, math.inf)]
    out += [-1e300, 1e300, math.inf, -math.inf, 10**400]
    outside = [value for value in out if not allowed.low <= value <= allowed.high]
    return [*outside, math.nan, np.float64(math.nan)]


NO_NUMBERS = [None, "1", b"1", True, np.True_, 1 + 0j, [1], (1,), {1}, {}, np.ones(1), np.array(1)]
NO_NUMBERS += [object(), int, np.datetime64(1, "s"), np.complex128(1), np.str_("1")]


@pytest.mark.parametrize(("model", "field", "kind", "allowed"), NUMBERS)
def test_what_is_outside_a_range_is_refused_by_name(model, field, kind, allowed):
    for value in beyond(kind, allowed):
        with pytest.raises(ValueError, match=f"^it {field} is .*, but must be") as told:
            check_fields("it", model()._replace(**{field: value}))
        assert "\n" not in str(told.value)
    for value in NO_NUMBERS:
        with pytest.raises(TypeError, match=f"^it {field} is .*, but must be"):
            check_fields("it", model()._replace(**{field: value}))
    if kind is int:
        with pytest.raises(ValueError, match=f"^it {field} is .*, but must be .*whole number"):
            check_fields("it", model()._replace(**{field: allowed.low + 0.5}))


# for a part of any class, ``check_vehicle`` states the rule
OTHERS = [place for place in FIELDS if place[2] not in (int, float, Any)]


@pytest.mark.parametrize(("model", "field", "kind", "_"), OTHERS)
def test_flags_words_and_models_are_checked_too(model, field, kind, _):
    assert kind is bool or get_origin(kind) is not None or hasattr(kind, "_fields")
    for value in (None, "certainly not", 2, [], np.ones(2), 1j):
        with pytest.raises((TypeError, ValueError), match=f"^it {field} is .*, but must be"):
            check_fields("it", model()._replace(**{field: value}))
    for value in get_args(kind) if get_origin(kind) else ():
        given = value() if isinstance(value, type) and value is not CatalogueFleet else value
        given = catalogue_fleet("wb-67") if value is CatalogueFleet else given
        check_fields("it", model()._replace(**{field: given}))


def numbers_in(model, *without, **bounds):
    """Return models whose numbers are anywhere in their ranges, often at their ends."""
    fields = {}
    for field, kind in kinds_of(model).items():
        base, allowed = split_range(kind)
        if field in without or allowed is None:
            if base is bool:
                fields[field] = st.booleans()
            continue
        low, high = bounds.get(field, (allowed.low, allowed.high))
        if base is int:
            spread = st.integers(low, high)
        else:
            spread = st.floats(low, high)
            if low > 0.0:  # small numbers as often as large ones
                spread |= st.floats(math.log(low), math.log(min(high, 1e300))).map(math.exp)
                spread = spread.map(lambda x, low=low, high=high: min(max(x, low), high))
        usual = model._field_defaults[field]
        fields[field] = st.sampled_from([low, high, usual]) | spread
    return st.fixed_dictionaries(fields).map(lambda given: model(**given))


def consistent(fleet: RandomFleet) -> RandomFleet:
    """Return a fleet with lengths in order and means between them."""
    low, high = sorted((fleet.min_length, fleet.max_length))
    high = high if high > low else high * 1.5 if high < 500.0 else high
    low = low if high > low else low * 0.5
    few, many = sorted((fleet.min_trailers, fleet.max_trailers))
    means = (min(max(mean, low), high) for mean in (fleet.short_truck_mean, fleet.long_truck_mean))
    short, long = means
    return fleet._replace(
        min_length=low,
        max_length=high,
        min_trailers=few,
        max_trailers=many,
        short_truck_mean=short,
        long_truck_mean=long,
    )


FLEETS = numbers_in(RandomFleet).map(consistent)
FEW = {"num_havs": (1, 20), "num_goals": (1, 5)}


def scenarios_of(kind: Any, **bounds):
    bare = numbers_in(kind, **FEW, **bounds)
    return st.builds(lambda one, fleet: one._replace(fleet=fleet), bare, FLEETS)


RANDOM_POSES = scenarios_of(RandomPoses, pose_attempts=(1, 200), world_attempts=(1, 5))
SCENARIOS = st.one_of(RANDOM_POSES, *map(scenarios_of, (Crossing, Yard, Column)))
WORDS = st.fixed_dictionaries(
    {
        "on_goal": st.sampled_from(["park", "remove"]),
        "on_jackknife": st.sampled_from(["record", "end"]),
        "next_goal": st.sampled_from(["together", "alone"]),
    }
)


def agreeing(task: Task, words: dict[str, str]) -> Task:
    """Return a task whose fields agree: collisions between steps require records of every step."""
    every = 1 if task.continuous_collisions else task.record_every
    return task._replace(record_every=every, **words)


TASKS = st.builds(agreeing, numbers_in(Task), WORDS)
VEHICLES = st.builds(
    lambda vehicle, actuators: vehicle._replace(actuators=actuators),
    numbers_in(OnAxle, substeps=(1, 20)),
    st.just(Instant()) | numbers_in(Limited),
)
SETTINGS = {
    "task": TASKS,
    "observation": numbers_in(Observation, neighbors=(0, 30)),
    "reward": numbers_in(Reward),
    "frame_skip": st.sampled_from([1, 2, 30]),
    "seed": st.integers(0, 2**32 - 1),
}


@settings(max_examples=budget(100, 10))
@given(scenario=RANDOM_POSES, vehicle=numbers_in(OnAxle, substeps=(1, 20)), **SETTINGS)
def test_inside_the_ranges_an_environment_works(**models):
    drive_an_environment(**models)


@pytest.mark.exhaustive
@settings(max_examples=budget(300, 15))
@given(scenario=SCENARIOS, vehicle=VEHICLES, **SETTINGS)
def test_inside_the_ranges_every_environment_works(**models):
    drive_an_environment(**models)


def drive_an_environment(seed, **models):
    """Step an environment six times; all numbers are finite and in their spaces."""
    env = parallel_env(**models)
    try:
        observations, _ = env.reset(seed=seed)
    except PlacementError:
        return
    rng = np.random.default_rng(seed)
    for step in range(6):
        for row in observations.values():
            assert env.observation_space("hav_0").contains(row)
        assert env.state_space.contains(env.state())
        if not env.agents:
            break
        turn = [-1.0, 1.0, *rng.uniform(-1.0, 1.0, 4)][step]
        actions = {agent: np.array([1.0, turn]) for agent in env.agents}
        observations, rewards, *_ = env.step(actions)
        assert np.isfinite(list(rewards.values())).all()


@settings(max_examples=budget(200, 6))
@given(
    st.one_of(*map(numbers_in, (AvoidJack, DubinsPursuit, Random))),
    scenarios_of(Crossing),
    TASKS,
    st.integers(0, 2**32 - 1),
)
def test_inside_the_ranges_every_policy_drives(policy, scenario, task, seed):
    if isinstance(policy, AvoidJack):
        policy = policy._replace(beta=min(policy.beta, 0.99 * scenario.articulation_max))
        if policy.beta < 1e-3:
            return
    trajectory = record_trajectory(policy, scenario, seed, 0, task._replace(max_steps=5))
    columns = trajectory.x, trajectory.heading, trajectory.speed[:-1], trajectory.steering[:-1]
    assert all(np.isfinite(column).all() for column in columns)


def test_the_longest_episode_turns_by_less_than_sines_stand():
    most = {kind: split_range(kind)[1].high for kind in (Speed, Duration, Steering, Steps)}
    shortest = split_range(Length)[1].low
    turn = most[Speed] * most[Duration] * math.tan(most[Steering]) / shortest * most[Steps]
    assert turn < 2e15
    for angle in np.linspace(turn, 2e15, 1_000):
        assert max(map(abs, sincos(angle))) <= 1.0 + 1e-12
