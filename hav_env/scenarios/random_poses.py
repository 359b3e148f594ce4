"""This module has the paper's scenario, section V: random fleets, start poses and goal poses."""

import math
from typing import NamedTuple

from hav_env.compiled import kernel
from hav_env.maths.random_numbers import uniform
from hav_env.models.quantities import AreaFactor, Attempts, Goals, Havs, WorldAttempts
from hav_env.scenarios.fleets import Fleets, RandomFleet, draw_fleet, scenario_key
from hav_env.world.arrays import FOOTPRINT, put_straight
from hav_env.world.collision import collision_distance


class RandomPoses(NamedTuple):
    """Random HAVs at random poses, in a square four times as large as their footprints."""

    num_havs: Havs = 1
    """Number M of HAVs in the plane; the paper has 1 and 2."""
    num_goals: Goals = 2
    """Number of consecutive goals of each HAV."""
    fleet: Fleets = RandomFleet()
    """Trucks and trailers."""
    area_factor: AreaFactor = 4.0
    """Area of the square over the sum of the footprints' areas; 2 is double density."""
    pose_attempts: Attempts = 1_000
    """Attempts to place one HAV before the world is drawn again."""
    world_attempts: WorldAttempts = 50
    """Attempts to draw a world before the draw fails."""

    @property
    def max_trailers(self) -> int:
        """The fleet's."""
        return self.fleet.max_trailers

    @property
    def articulation_max(self) -> float:
        """The fleet's [rad]."""
        return self.fleet.articulation_max


def populate_random_poses(scenario, world, lane):
    """Draw one world; draw worlds without space for a pose again, a bounded number of times."""
    key = scenario_key(world, lane)
    draw = 0
    for _ in range(scenario.world_attempts):
        draw = draw_fleet(scenario.fleet, world.fleet, lane, key, draw)
        side = _area_side(scenario, world.fleet, lane)
        # phase -1 means the starts, which are drawn into the rows of the first goals
        for phase in range(-1, scenario.num_goals):
            draw = place_all(scenario, world, max(phase, 0), side, lane, key, draw)
            if draw < 0:
                break
            if phase < 0:
                for agent in range(scenario.num_havs):
                    x, y, heading = world.goals[agent, 0, :, lane]
                    put_straight(world.state, agent, lane, x, y, heading)
        if draw >= 0:
            return True
        draw = -draw
    return False


@kernel
def _area_side(scenario, fleet, lane):
    """Return A [m]: A^2 = 4 sum_i pi d_i^2 for the paper's area factor."""
    footprints = 0.0
    for agent in range(fleet.radius.shape[0]):
        radius = fleet.radius[agent, FOOTPRINT, lane]
        footprints += math.pi * radius * radius
    return math.sqrt(scenario.area_factor * footprints)


@kernel
def place_all(scenario, world, phase, side, lane, key, draw):
    """Draw the goals of a phase, none in potential collision with another; return the next draw.

    Args:
        scenario: the scenario.
        world: a block of worlds.
        phase: number of the goal, from 0.
        side: side of the square with the goals [m].
        lane: number of the world.
        key: of the episode's random numbers.
        draw: number of the first random number.

    Returns:
        The next draw; negative if there was no space.
    """
    goals = world.goals
    for agent in range(scenario.num_havs):
        free = False
        for _ in range(scenario.pose_attempts):
            goals[agent, phase, 0, lane] = side * uniform(*key, draw)
            goals[agent, phase, 1, lane] = side * uniform(*key, draw + 1)
            goals[agent, phase, 2, lane] = 2.0 * math.pi * uniform(*key, draw + 2)
            draw += 3
            free = _is_free(world, phase, agent, lane)
            if free:
                break
        if not free:
            return -draw
    return draw


@kernel
def _is_free(world, phase, agent, lane):
    goals = world.goals
    for other in range(agent):
        dx = goals[agent, phase, 0, lane] - goals[other, phase, 0, lane]
        dy = goals[agent, phase, 1, lane] - goals[other, phase, 1, lane]
        if math.sqrt(dx * dx + dy * dy) <= collision_distance(world.fleet, agent, other, lane):
            return False
    return True
