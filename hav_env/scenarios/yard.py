"""This module defines the scenario of a yard: rows of bays beside each other.

Each HAV drives from one bay to a random one opposite.
"""

import math
from typing import NamedTuple

from hav_env.compiled import kernel
from hav_env.maths.random_numbers import uniform
from hav_env.models.quantities import Gap, Goals, Havs
from hav_env.scenarios.fleets import Fleets, RandomFleet, draw_fleet, scenario_key
from hav_env.world.arrays import FOOTPRINT, HEADING, X, Y, put_straight

_WAY_AHEAD = math.pi / 2  # out of the start bays, across the aisle, into the goal bays


class Yard(NamedTuple):
    """A row of start bays and, across an aisle, a row of goal bays in random order.

    HAVs drive forward only, so they drive through bays. Each further goal is a bay in one more row
    behind one more aisle, in a new random order.
    """

    num_havs: Havs = 4
    """Number of HAVs, and of bays in a row."""
    num_goals: Goals = 1
    """Number of rows of goal bays, one behind the other."""
    fleet: Fleets = RandomFleet()
    """Trucks and trailers."""
    aisle: Gap = 100.0
    """Distance of the rows [m], from rear axles to rear axles. A HAV that moves to a bay far to the
    side turns a quarter circle, drives along the aisle and turns a quarter circle back. This takes
    2 R_min of the aisle's width; a bay nearer to the side takes less. R_min, equation (17) of the
    paper, is below 39.8 m in the default fleet (a truck and ten trailers of 12 m) and usually about
    15 m. So 100 m suffice for all HAVs, and none needs a loop."""
    gap: Gap = 10.0
    """Gap [m] between the footprints of HAVs in neighbouring bays."""

    @property
    def max_trailers(self) -> int:
        """The fleet's."""
        return self.fleet.max_trailers

    @property
    def articulation_max(self) -> float:
        """The fleet's [rad]."""
        return self.fleet.articulation_max


def populate_yard(scenario, world, lane):
    """Draw the fleet of one lane and assign its bays; the space always suffices.

    A bay is as wide as the footprint of its HAV, 2 d_i, and the gap; so all rows have one width.
    """
    key = scenario_key(world, lane)
    draw = draw_fleet(scenario.fleet, world.fleet, lane, key, 0)
    edge = _left_edge(scenario, world.fleet, lane)
    for agent in range(scenario.num_havs):
        half = _half_bay(scenario, world.fleet, agent, lane)
        put_straight(world.state, agent, lane, edge + half, 0.0, _WAY_AHEAD)
        edge += 2.0 * half
    for phase in range(scenario.num_goals):
        draw = _deal_bays(scenario, world.goals, phase, lane, key, draw)
        _place_row(scenario, world, phase, lane)
    return True


@kernel
def _half_bay(scenario, fleet, agent, lane):
    return fleet.radius[agent, FOOTPRINT, lane] + 0.5 * scenario.gap


@kernel
def _left_edge(scenario, fleet, lane):
    """Return the beginnings [m] of rows with their middle at 0."""
    width = 0.0
    for agent in range(scenario.num_havs):
        width += 2.0 * _half_bay(scenario, fleet, agent, lane)
    return -0.5 * width


@kernel
def _deal_bays(scenario, goals, phase, lane, key, draw):
    """Write the HAV of bay 0, 1, ... into its heading (Fisher and Yates' shuffle).

    The true headings come later, because a kernel allocates nothing. Returns the next draw.
    """
    for bay in range(scenario.num_havs):
        other = int((bay + 1) * uniform(*key, draw + bay))
        goals[bay, phase, HEADING, lane] = goals[other, phase, HEADING, lane]
        goals[other, phase, HEADING, lane] = bay
    return draw + scenario.num_havs


@kernel
def _place_row(scenario, world, phase, lane):
    goals, edge = world.goals, _left_edge(scenario, world.fleet, lane)
    for bay in range(scenario.num_havs):
        agent = int(goals[bay, phase, HEADING, lane])
        half = _half_bay(scenario, world.fleet, agent, lane)
        goals[agent, phase, X, lane] = edge + half
        goals[agent, phase, Y, lane] = (phase + 1) * scenario.aisle
        edge += 2.0 * half
    for agent in range(scenario.num_havs):
        goals[agent, phase, HEADING, lane] = _WAY_AHEAD
