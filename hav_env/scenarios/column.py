"""This module defines the scenario of a column: one HAV behind the other, straight on."""

from typing import NamedTuple

from hav_env.models.quantities import Gap, Goals, Havs
from hav_env.scenarios.fleets import Fleets, RandomFleet, draw_fleet, scenario_key
from hav_env.world.arrays import FOOTPRINT, HEADING, X, Y, put_straight
from hav_env.world.collision import reach


class Column(NamedTuple):
    """HAVs one behind the other on a line, HAV 0 in front; goals are the same column further on."""

    num_havs: Havs = 5
    """Number of HAVs in the column."""
    num_goals: Goals = 1
    """Number of times that the column moves on."""
    fleet: Fleets = RandomFleet()
    """Trucks and trailers."""
    distance: Gap = 200.0
    """Distance that the column moves on for each goal [m]."""
    gap: Gap = 10.0
    """Gap [m] between the footprint of a HAV and that of the one behind, or the front of its truck
    if that sticks out."""

    @property
    def max_trailers(self) -> int:
        """The fleet's."""
        return self.fleet.max_trailers

    @property
    def articulation_max(self) -> float:
        """The fleet's [rad]."""
        return self.fleet.articulation_max


def populate_column(scenario, world, lane):
    """Draw the fleet of one lane and line it up; the space always suffices."""
    fleet = world.fleet
    draw_fleet(scenario.fleet, fleet, lane, scenario_key(world, lane), 0)
    x = 0.0
    for agent in range(scenario.num_havs):
        if agent > 0:
            between = fleet.radius[agent - 1, FOOTPRINT, lane] + reach(fleet, agent, lane)
            x -= between + scenario.gap
        put_straight(world.state, agent, lane, x, 0.0, 0.0)
        for phase in range(scenario.num_goals):
            world.goals[agent, phase, X, lane] = x + (phase + 1) * scenario.distance
            world.goals[agent, phase, Y, lane] = 0.0
            world.goals[agent, phase, HEADING, lane] = 0.0
    return True
