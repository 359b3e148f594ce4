"""An observation suffices for AVOID-JACK: it is written here again, from the row alone."""

import math

import numpy as np
import pytest

from baselines.policies.avoid_jack import AvoidJack
from hav_env import Observation
from hav_env.envs.gymnasium_vector import HAVSwarmVectorEnv
from hav_env.maths.dubins import WORDS, shortest_path
from hav_env.policies.driver import PolicyDriver
from hav_env.world.arrays import SPEED, STEERING
from tests.support.budgets import budget

STRAIGHT_BELOW, CLOSE_FACTOR = 1e-3, 3.5
WHOLE = math.log(1.0 + 1e4)  # of the logarithmic scale of distances


class Row:
    """The columns of one observation by name, in metres and radians."""

    def __init__(self, values, columns):
        """Take the values of a row and the index of each column."""
        self._values, self._columns = values, columns

    def __getitem__(self, name):
        """Return the value of a column."""
        return float(self._values[self._columns[name]])

    def __contains__(self, name):
        """Return whether the row has a column."""
        return name in self._columns

    def metres(self, name):
        scaled = self[name]
        return math.copysign(math.expm1(abs(scaled) * WHOLE), scaled)

    def place(self, name):
        return self.metres(f"{name}_distance") * self.direction(f"{name}_bearing")

    def direction(self, name):
        return complex(self[f"{name}_cosine"], self[f"{name}_sine"])


def first_side(row):
    """Return the first side of the Dubins path of Algorithm 1: 1 left, -1 right, 0 straight."""
    truck, goal = 10.0 * row["length_0"], row.place("goal")
    if abs(goal) < CLOSE_FACTOR * truck:
        place, radius = goal, truck
    else:
        if row.metres("approach_path_first") >= STRAIGHT_BELOW:
            return row["approach_path_turn"]
        place, radius = row.place("approach"), row.metres("stable_radius")
    heading = np.angle(row.direction("goal_heading"))
    word, *segments = shortest_path(place.real, place.imag, heading, radius)
    sides = {"L": 1.0, "R": -1.0, "S": 0.0}
    letters = WORDS[word]
    for letter, length in zip(letters, segments, strict=True):
        if length >= STRAIGHT_BELOW:
            return sides[letter]
    return 0.0


def goal_vector(row, steering_max):
    """Return m^g: away from the HAV whose circle is entered deepest, or along the Dubins path."""
    if (
        "neighbor_0_present" in row
        and row["neighbor_0_present"]
        and row["neighbor_0_clearance"] <= 0
    ):
        return -row.direction("neighbor_0_bearing")  # the first is the one with the least clearance
    return np.exp(1j * steering_max * first_side(row))


def avoid_jack(row):
    """Return speed [m/s] and steering [rad], the paper's section IV."""
    steering_max = row["steering_max"] * math.pi / 2
    articulation_max, beta = row["articulation_max"] * math.pi, math.radians(75.0)
    joints = [j for j in range(1, 11) if row[f"length_{j}"] > 0.0]
    weights = [1 + math.tanh(0.5 - 2.0 * row[f"articulation_cosine_{j}"]) for j in joints]
    trailer = complex(row["articulation_cosine_1"], row["articulation_sine_1"])
    total = goal_vector(row, steering_max) + sum(weights) * trailer
    rate = math.sin(beta) / (10.0 * row["length_1"]) + math.tan(steering_max) / (
        10.0 * row["length_0"]
    )
    safe = (articulation_max - beta) / (0.2 * rate)
    steering = np.clip(np.angle(total), -steering_max, steering_max)
    return min(10.0 * row["speed_max"], safe), steering


CASES = {
    1: (AvoidJack(), {}),
    2: (AvoidJack(), {}),
    5: (AvoidJack(keep_first=False), {"observation": Observation(neighbors=4)}),
}


@pytest.mark.parametrize("num_havs", CASES)
def test_avoid_jack_needs_nothing_but_its_row(num_havs):
    policy, settings = CASES[num_havs]
    worlds, steps = budget(6, 2), budget(2_000, 400)
    env = HAVSwarmVectorEnv(
        worlds, scenario="paper-single", num_havs=num_havs, max_steps=steps, **settings
    )
    batch = env._process.batch
    columns = {name: i for i, name in enumerate(env._process.columns)}
    driver, limit = PolicyDriver(policy, batch), batch.worlds.fleet.limit
    observation, _ = env.reset(seed=3)
    checked, differing, evading = 0, 0, 0
    while True:
        speed, steering = driver.decide()
        for w in range(worlds):
            for k in range(num_havs):
                row = Row(observation[w, k], columns)
                if row["waits"]:
                    continue
                own_speed, own_steering = avoid_jack(row)
                assert own_speed == pytest.approx(speed[k, w], abs=1e-4)
                checked += 1
                evading += "neighbor_0_clearance" in row and row["neighbor_0_clearance"] < 0.0
                if abs(own_steering - steering[k, w]) > 1e-4:
                    differing += 1
        shares = 2.0 * speed / limit[:, SPEED] - 1.0, steering / limit[:, STEERING]
        actions = np.stack(shares, axis=-1).transpose(1, 0, 2)
        observation, _, _, truncated, _ = env.step(actions)
        if truncated.any():  # all worlds that have not ended before
            break
        driver.forget(batch.worlds.state.clock[0] == 0)
    assert checked > worlds * num_havs * steps / 5
    assert num_havs == 1 or evading > 0
    assert differing <= 0.0005 * checked  # within the rounding of a row at a switch
