"""This module defines the scenario of a crossing.

All HAVs start on a circle and must drive through its centre to the other side.
"""

import math
from typing import NamedTuple

from hav_env.compiled import kernel
from hav_env.maths.elementary import sincos
from hav_env.models.quantities import Gap, Goals, Havs
from hav_env.scenarios.fleets import Fleets, RandomFleet, draw_fleet, scenario_key
from hav_env.world.arrays import HEADING, X, Y, put_straight
from hav_env.world.collision import collision_distance


class Crossing(NamedTuple):
    """HAVs at even angles on a circle, heading to its centre; goals on the opposite side.

    The circle is as small as the fleet of the episode allows. Further goals lie at the two ends in
    turn and point away from the centre, so all HAVs turn round and come back.
    """

    num_havs: Havs = 2
    """Number of HAVs that meet at the centre."""
    num_goals: Goals = 1
    """Number of times that each HAV crosses."""
    fleet: Fleets = RandomFleet()
    """Trucks and trailers."""
    gap: Gap = 20.0
    """Least gap [m] between the footprints of two HAVs at the start and at their goals, and between
    the front of a truck and the centre."""

    @property
    def max_trailers(self) -> int:
        """The fleet's."""
        return self.fleet.max_trailers

    @property
    def articulation_max(self) -> float:
        """The fleet's [rad]."""
        return self.fleet.articulation_max


def populate_crossing(scenario, world, lane):
    """Draw the fleet of one lane and put it on its circle; the space always suffices."""
    draw_fleet(scenario.fleet, world.fleet, lane, scenario_key(world, lane), 0)
    radius = _circle_radius(scenario, world.fleet, lane)
    for agent in range(scenario.num_havs):
        outward = 2.0 * math.pi * agent / scenario.num_havs
        inward = outward - math.pi
        sine, cosine = sincos(outward)
        put_straight(world.state, agent, lane, radius * cosine, radius * sine, inward)
        for phase in range(scenario.num_goals):
            opposite = phase % 2 == 0
            side = -radius if opposite else radius
            world.goals[agent, phase, X, lane] = side * cosine
            world.goals[agent, phase, Y, lane] = side * sine
            world.goals[agent, phase, HEADING, lane] = inward if opposite else outward
    return True


@kernel
def _circle_radius(scenario, fleet, lane):
    """Return the radius [m] of the least circle on which all HAVs keep their gaps.

    HAVs that are k places apart among N have the chord 2 r sin(pi k / N) between them. A truck may
    stick out of its footprint; but every HAV stands on a ray of its own and ends before the centre,
    so no chains touch.
    """
    radius = 0.0
    for agent in range(scenario.num_havs):
        radius = max(radius, fleet.length[agent, 0, lane] + scenario.gap)
        for other in range(agent):
            sine, _ = sincos(math.pi * (agent - other) / scenario.num_havs)
            chord = collision_distance(fleet, agent, other, lane) + scenario.gap
            radius = max(radius, 0.5 * chord / sine)
    return radius
