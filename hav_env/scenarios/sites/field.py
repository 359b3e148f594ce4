"""This module has random fields of obstacles, in which each HAV's own way is free."""

import math
from typing import NamedTuple

from hav_env.compiled import generic, kernel
from hav_env.maths.elementary import sincos
from hav_env.maths.random_numbers import uniform
from hav_env.models.checks import check_relations, require
from hav_env.models.quantities import Attempts, Gap, Goals, Havs, Segments, Widening, WorldAttempts
from hav_env.scenarios.catalogue_fleet import catalogue_fleet
from hav_env.scenarios.fleets import Fleets, draw_fleet, scenario_key
from hav_env.scenarios.random_poses import place_all
from hav_env.scenarios.sites.witness import drive_witness
from hav_env.world.arrays import HEADING, X, Y, put_straight
from hav_env.world.obstacles.collisions import find_margin
from hav_env.world.place.segments import MOST_MOVED, Obstacles, Plane, place_segment

_NAMES = ("terminal-tractor", "eu-semi-trailer", "eu-truck-trailer", "eurocombi", "farm-train")
_ROUNDS = 100  # of segments drawn anew, each of which refuses a part of the rest


class Field(NamedTuple):
    """Random poses among random walls; drive it with a vehicle that knows hitches.

    First each HAV is simulated alone, from its start to its goals along shortest Dubins paths.
    Walls are then drawn until none is near to what any body swept on these ways. So each HAV alone
    can reach its goals. Ways of different HAVs may cross.
    """

    num_havs: Havs = 1
    """Number of HAVs."""
    num_goals: Goals = 2
    """Number of goals that each HAV gets, one after the other."""
    fleet: Fleets = catalogue_fleet(_NAMES)
    """Trucks and trailers."""
    side: Gap = 120.0
    """Side of the square in which starts, goals and the middles of walls lie [m]."""
    num_segments: Segments = 32
    """Number of walls."""
    min_wall: Gap = 4.0
    """Least length of a wall [m]."""
    max_wall: Gap = 20.0
    """Largest length of a wall [m]."""
    margin: Gap = 0.5
    """Distance that all bodies keep from walls on their ways [m]."""
    widening: Widening = 1.1
    """Radius of the turns of these ways over the least that a HAV can drive for good."""
    pose_attempts: Attempts = 1_000
    """Poses tried for one HAV before the world is drawn afresh."""
    world_attempts: WorldAttempts = 50
    """Worlds drawn before the density is held to be unreachable."""

    @property
    def max_trailers(self) -> int:
        """The fleet's."""
        return self.fleet.max_trailers

    @property
    def articulation_max(self) -> float:
        """The fleet's [rad]."""
        return self.fleet.articulation_max


@check_relations.register
def _(field: Field) -> None:
    told = f"at least min_wall, {field.min_wall:g} m"
    require(field.max_wall >= field.min_wall, "scenario", field, "max_wall", told)


def populate_field(scenario, world, lane):
    """Draw one world; worlds without room for a pose or a wall are drawn afresh."""
    key = scenario_key(world, lane)
    draw = 0
    for _ in range(scenario.world_attempts):
        draw = draw_fleet(scenario.fleet, world.fleet, lane, key, draw)
        # phase -1 stands for the starts, drawn where the first goals will be
        for phase in range(-1, scenario.num_goals):
            draw = place_all(scenario, world, max(phase, 0), scenario.side, lane, key, draw)
            if draw < 0:
                break
            if phase < 0:
                _keep_starts(scenario, world, lane)
        if draw >= 0:
            draw = build_walls(world.place, scenario, world, lane, key, draw)
        if draw >= 0:
            for agent in range(scenario.num_havs):
                _put_at_start(world, agent, lane)
            return True
        draw = -draw
    return False


@kernel
def _keep_starts(scenario, world, lane):
    """Keep the starts where the goals under way will stand."""
    for agent in range(scenario.num_havs):
        for column in (X, Y, HEADING):
            world.state.goal[agent, column, lane] = world.goals[agent, 0, column, lane]


@kernel
def _put_at_start(world, agent, lane):
    start = world.state.goal
    x, y, heading = start[agent, X, lane], start[agent, Y, lane], start[agent, HEADING, lane]
    put_straight(world.state, agent, lane, x, y, heading)


@generic
def build_walls(place, scenario, world, lane, key, draw):
    """Draw walls that leave every HAV's own way free; return the next draw.

    It comes back negative when there was no room, or a HAV would jackknife on its way.
    """


@build_walls.register(Plane)
def _build_nothing(place, scenario, world, lane, key, draw):
    return draw


@build_walls.register(Obstacles)
def _build_beside_ways(place, scenario, world, lane, key, draw):
    due = place.due[world.first + lane]
    for number in range(scenario.num_segments):
        for agent in range(scenario.num_havs):
            due[agent, number] = math.nan
    for _ in range(_ROUNDS):
        refused = 0
        for number in range(scenario.num_segments):
            new = due[0, number] != due[0, number]
            if new:
                _draw_wall(scenario, place, number, lane, key, draw)
                draw, refused = draw + 4, refused + 1
            for agent in range(scenario.num_havs):
                due[agent, number] = 0.0 if new else math.inf
        if refused == 0:
            return draw
        if not _drive_all(scenario, world, lane):
            return -draw
    return -draw


@kernel
def _draw_wall(scenario, place, number, lane, key, draw):
    x, y = scenario.side * uniform(*key, draw), scenario.side * uniform(*key, draw + 1)
    sine, cosine = sincos(math.pi * uniform(*key, draw + 2))
    spread = scenario.max_wall - scenario.min_wall
    half = 0.5 * (scenario.min_wall + spread * uniform(*key, draw + 3))
    dx, dy = half * cosine, half * sine
    place_segment(place, number, lane, x - dx, y - dy, x + dx, y + dy)


@kernel
def _drive_all(scenario, world, lane):
    """Simulate the ways of all HAVs to their goals; return whether none would jackknife."""
    for agent in range(scenario.num_havs):
        _put_at_start(world, agent, lane)
        world.place.driven[agent, MOST_MOVED, lane] = 0.0
        find_margin(world.place, world, agent, lane)
        for phase in range(scenario.num_goals):
            goal = world.goals[agent, phase, :, lane]
            driven = drive_witness(
                *(world, agent, lane, goal, scenario.widening, scenario.margin),
                scenario.num_segments,
            )
            if driven < 0.0:
                return False
    return True
