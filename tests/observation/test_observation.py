"""Every column of an observation matches its name, computed again from the world."""

import math

import numpy as np
import pytest
from shapely import LineString, Point, shortest_line

from hav_env import Observation, Task, parallel_env
from hav_env.maths.dubins import shortest_path, turns
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.observation import list_columns, name_columns
from hav_env.observation.columns import scale_distance, scale_length
from hav_env.world.arrays import ARTICULATION, PHASE, SPEED, STEERING
from tests.support.budgets import budget
from tests.support.worlds import wrapped

RANGE = 60.0
COLUMN = pytest.param("column-5", marks=pytest.mark.exhaustive)


def scaled(distance):
    """Return a distance [m] on the scale of observations: logarithmic, 10 km are 1."""
    return min(math.log1p(distance) / math.log1p(1e4), 1.0)


def length(units):
    return min(units / 10.0, 10.0)


def polar(name, there):
    """Return the columns of a point, forward + 1j * left [m]."""
    bearing = there / abs(there) if there else 0j
    columns = scaled(abs(there)), bearing.real, bearing.imag
    return dict(
        zip(
            [f"{name}_{p}" for p in ("distance", "bearing_cosine", "bearing_sine")],
            columns,
            strict=True,
        )
    )


def angle(name, direction):
    return {f"{name}_cosine": direction.real, f"{name}_sine": direction.imag}


class Witness:
    """Observes one world from outside, with complex numbers for positions."""

    def __init__(self, batch, w):
        """Take a batch and the number of one of its worlds."""
        self.state, self.fleet = batch.worlds.state, batch.worlds.fleet
        self.w, self.num_goals = w, batch.scenario.num_goals
        self.places = self.state.x[:, w] + 1j * self.state.y[:, w]
        self.sensing_range = batch.task.sensing_range

    def headings(self, agent):
        return self.state.heading[agent, : self.fleet.num_trailers[agent, self.w] + 1, self.w]

    def lengths(self, agent):
        return self.fleet.length[agent, : self.fleet.num_trailers[agent, self.w] + 1, self.w]

    def footprint(self, agent):
        return self.lengths(agent)[1:].sum()

    def reach(self, agent):
        return max(self.footprint(agent), self.lengths(agent)[0])

    def chain(self, agent):
        """Return the axles of a HAV as points of the plane, from the front axle on."""
        units = self.lengths(agent) * np.exp(1j * self.headings(agent))
        return self.places[agent] + np.concatenate([[units[0], 0.0], -np.cumsum(units[1:])])

    def units(self, agent, most, first=0):
        """Return the columns of lengths and articulations."""
        columns, bends = {}, np.diff(self.headings(agent))
        for unit in range(first, most + 1):
            present = unit < len(self.lengths(agent))
            columns[f"length_{unit}"] = length(self.lengths(agent)[unit]) if present else 0.0
        for joint in range(1, most + 1):
            bend = np.exp(1j * bends[joint - 1]) if joint <= len(bends) else 0j
            columns[f"articulation_cosine_{joint}"] = bend.real
            columns[f"articulation_sine_{joint}"] = bend.imag
        return columns

    def largest_bend(self, agent):
        """Return the articulation farthest from zero, at most its limit [rad]."""
        bends = wrapped(np.diff(self.headings(agent)))
        limit = self.fleet.limit[agent, ARTICULATION, self.w]
        return float(np.clip(bends[np.argmax(np.abs(bends))], -limit, limit))

    def drivable(self, agent):
        """Return the larger of R_min and the radius at which the wheels are fully turned [m]."""
        truck, steepest = self.lengths(agent)[0], self.fleet.limit[agent, STEERING, self.w]
        return max(math.hypot(*self.lengths(agent)), truck / math.tan(steepest))

    def steering_along(self, agent, radius):
        steepest = self.fleet.limit[agent, STEERING, self.w]
        return min(math.atan(self.lengths(agent)[0] / radius) / steepest, 1.0)

    def own(self, agent, most):
        state, fleet, w = self.state, self.fleet, self.w
        limit, frame = fleet.limit[agent, :, w], np.exp(-1j * self.headings(agent)[0])
        waits = bool(state.waiting[agent, w])
        x, y, heading = state.goal[agent, :3, w]
        away = np.exp(1j * heading) * frame
        goal = (complex(x, y) - self.places[agent]) * frame
        approach = goal - self.lengths(agent)[0] * away
        columns = {
            "waits": float(waits),
            "goals_left": (self.num_goals - state.goal[agent, PHASE, w] - waits) / self.num_goals,
            "speed_max": min(limit[SPEED] / 10.0, 1.0),
            "steering_max": limit[STEERING] / (math.pi / 2),
            "articulation_max": limit[ARTICULATION] / math.pi,
            "stable_radius": scaled(math.hypot(*self.lengths(agent))),
            "drivable_steering": self.steering_along(agent, self.drivable(agent)),
            "footprint_radius": scaled(self.footprint(agent)),
            "largest_articulation": self.largest_bend(agent) / limit[ARTICULATION],
            **polar("goal", goal),
            **angle("goal_heading", away),
            **polar("approach", approach),
            **self.units(agent, most),
        }
        stable, drivable = math.hypot(*self.lengths(agent)), self.drivable(agent)
        for name, there, radius in (("goal", goal, drivable), ("approach", approach, stable)):
            path = shortest_path(there.real, there.imag, np.angle(away), radius)
            columns[f"{name}_path_turn"] = turns(path[0])[0]
            columns[f"{name}_path_first"] = scaled(path[1])
            columns[f"{name}_path_whole"] = scaled(sum(path[1:]))
            share = turns(path[0])[0] * min(path[1], 1.0)
            columns[f"{name}_path_steering"] = share * self.steering_along(agent, radius)
        return columns

    def clearance(self, agent, other):
        gap = abs(self.places[other] - self.places[agent])
        return gap - self.footprint(agent) - self.footprint(other)

    def senses(self, agent, other):
        gap = abs(self.places[other] - self.places[agent])
        return gap <= self.reach(agent) + self.reach(other) + self.sensing_range

    def neighbors(self, agent):
        """Return the sensed HAVs, least clearance first."""
        others = [k for k in range(len(self.places)) if k != agent and self.senses(agent, k)]
        return sorted(others, key=lambda other: self.clearance(agent, other))

    def between(self, agent, other):
        one, two = (
            LineString([(axle.real, axle.imag) for axle in self.chain(hav)])
            for hav in (agent, other)
        )
        ours, theirs = (Point(line.coords[0]) for line in (one, two))
        _, (x, y) = shortest_line(ours, two).coords
        frame = np.exp(-1j * self.headings(agent)[0])
        speed = 0.0 if self.state.waiting[other, self.w] else self.state.speed[other, self.w]
        there = complex(x - ours.x, y - ours.y) * frame
        nearness, exposed = (
            max(0.0, 1.0 - gap / 10.0) for gap in (abs(there), theirs.distance(one))
        )
        direction = there / abs(there)
        return {
            "speed": speed / 10.0,
            "front_nearness": nearness,
            "front_ahead": nearness * direction.real,
            "front_aside": nearness * direction.imag,
            "exposed_nearness": exposed,
        }

    def neighbor(self, agent, other, most, observation):
        frame = np.exp(-1j * self.headings(agent)[0])
        place, gap = self.places[agent], self.clearance(agent, other)
        chain = LineString([(axle.real, axle.imag) for axle in self.chain(other)])
        _, (x, y) = shortest_line(Point(place.real, place.imag), chain).coords
        return {
            "present": 1.0,
            **polar("", (self.places[other] - place) * frame),
            **angle("heading", np.exp(1j * self.headings(other)[0]) * frame),
            "footprint_radius": scaled(self.footprint(other)),
            "clearance": math.copysign(scaled(abs(gap)), gap),
            "truck_length": length(self.lengths(other)[0]),
            **polar("chain", (complex(x, y) - place) * frame),
            **(self.units(other, most, first=1) if observation.chains else {}),
            **(self.between(agent, other) if observation.fronts else {}),
        }

    def row(self, agent, observation, most):
        """Return all columns by name."""
        columns, found = self.own(agent, most), self.neighbors(agent)
        for rank in range(observation.neighbors):
            prefix = f"neighbor_{rank}_"
            if rank < len(found):
                seen = self.neighbor(agent, found[rank], most, observation)
                columns |= {prefix + name.removeprefix("_"): v for name, v in seen.items()}
        return columns


@pytest.mark.parametrize(("chains", "fronts"), [(False, False), (True, False), (True, True)])
@pytest.mark.parametrize("neighbors", [0, 2, 9])
@pytest.mark.parametrize("scenario", ["paper-single", "swarm-10", "crossing-8", COLUMN])
def test_a_row_is_the_world_seen_from_its_hav(scenario, neighbors, chains, fronts):
    num_worlds = budget(3, 1)
    process = DecisionProcess(
        num_worlds,
        scenario=scenario,
        observation=Observation(neighbors, chains, fronts),
        task=Task(sensing_range=RANGE),
    )
    everywhere, told = np.ones(num_worlds, np.bool_), process.outcome()
    process.begin(np.arange(num_worlds), np.zeros(num_worlds, np.int64), everywhere, told)
    most, rng = process.batch.scenario.max_trailers, np.random.default_rng(3)
    for _ in range(budget(12, 2)):
        for w in range(num_worlds):
            witness = Witness(process.batch, w)
            for agent in range(process.num_havs):
                expected = witness.row(agent, process.observation, most)
                found = dict(zip(process.columns, told.observation[w, agent], strict=True))
                absent = set(found) - set(expected)
                assert all(name.startswith("neighbor_") and found[name] == 0.0 for name in absent)
                assert not set(expected) - set(found)
                for name in ("goal_path", "approach_path"):
                    if expected[f"{name}_first"] < scaled(1e-3):  # the side is undetermined
                        expected[f"{name}_turn"] = found[f"{name}_turn"]
                for name, value in expected.items():
                    assert found[name] == pytest.approx(value, abs=1e-5), name
        actions = rng.uniform(-1, 1, (num_worlds, process.num_havs, 2))
        actions[..., 0] = 1.0
        for _ in range(budget(20, 1)):
            told = process.step(actions)


@pytest.mark.parametrize("chains", [False, True])
@pytest.mark.parametrize(("neighbors", "num_havs"), [(0, 1), (4, 1), (4, 3), (2, 3), (100, 3)])
def test_columns_have_names_of_their_own_and_are_as_many_as_the_space_is_long(
    neighbors, num_havs, chains
):
    env = parallel_env(num_havs=num_havs, observation=Observation(neighbors, chains))
    columns = env._world.process.columns
    assert len(set(columns)) == len(columns)
    for agent, row in env.reset(seed=0)[0].items():
        assert row.shape == env.observation_space(agent).shape == (len(columns),)
    seen = {name.split("_")[1] for name in columns if name.startswith("neighbor_")}
    assert seen == {str(k) for k in range(min(neighbors, num_havs - 1))}


def test_columns_of_more_neighbours_come_after_those_of_fewer():
    for most in (1, 4, 10):
        few, more = (name_columns(Observation(k), most) for k in (1, 3))
        assert more[: len(few)] == few


def test_distances_and_lengths_can_be_read_back():
    distances = np.concatenate([[0.0], np.geomspace(1e-6, 9_999.0, 200)])
    columns = np.array([scale_distance(d) for d in distances.astype(np.float32)], float)
    assert np.expm1(columns * np.log1p(1e4)) == pytest.approx(distances, rel=3e-6, abs=1e-7)
    assert (np.diff(columns) >= 0.0).all()
    assert 10.0 * scale_length(np.float32(12.5)) == 12.5


@pytest.mark.parametrize(("scale", "most"), [(scale_distance, 1.0), (scale_length, 10.0)])
def test_what_is_beyond_the_scale_is_cut(scale, most):
    assert scale(np.float32(1e9)) == scale(np.float32(math.inf)) == most
    assert scale(np.float32(0.0)) == 0.0


def test_columns_take_the_signs_that_their_bounds_allow():
    num_worlds = budget(400, 20)
    process = DecisionProcess(num_worlds, num_havs=5, task=Task(sensing_range=500.0))
    everywhere, told = np.ones(num_worlds, np.bool_), process.outcome()
    process.begin(np.arange(num_worlds), np.zeros(num_worlds, np.int64), everywhere, told)
    rows = told.observation.reshape(-1, len(process.columns))
    turns_and_places = ("bearing", "goal_heading", "path_turn", "r_heading")
    columns = list_columns(process.observation, process.batch.scenario.max_trailers)
    for (name, low, high), column in zip(columns, rows.T, strict=True):
        assert low <= column.min() <= column.max() <= high
        if any(part in name for part in turns_and_places) and "chain" not in name:
            assert column.min() < -0.3
            assert column.max() > 0.3
        if low == 0.0:
            assert (column >= 0.0).all()


def test_sines_and_cosines_of_a_row_are_of_one_angle():
    process = DecisionProcess(4, scenario="swarm-10")
    everywhere, told = np.ones(4, np.bool_), process.outcome()
    process.begin(np.arange(4), np.zeros(4, np.int64), everywhere, told)
    rows = dict(
        zip(process.columns, told.observation.reshape(-1, len(process.columns)).T, strict=True)
    )
    pairs = [name for name in rows if "cosine" in name]
    assert len(pairs) > 20
    for name in pairs:
        square = rows[name] ** 2 + rows[name.replace("cosine", "sine")] ** 2
        absent = square == 0.0
        assert square[~absent] == pytest.approx(1.0, abs=1e-5)
        assert absent.sum() == 0 or name.startswith(("articulation", "neighbor"))
