"""This module defines random fields of walls that leave the path of each HAV alone free."""

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
from hav_env.scenarios.sites.witness import begin_way, drive_witness, meet_walls
from hav_env.world.arrays import HEADING, X, Y, put_straight
from hav_env.world.obstacles.collisions import gap_to_segment
from hav_env.world.place.segments import MOST_MOVED, Obstacles, Plane, place_segment

_NAMES = ("terminal-tractor", "eu-semi-trailer", "eu-truck-trailer", "eurocombi", "farm-train")
_ROUNDS = 100  # of walls drawn and ways driven
_DRAWS = 4  # random numbers of a wall
_CANDIDATES = 3  # for each wall in a round, as far as the memory suffices: about half are rejected


class Field(NamedTuple):
    """Random poses among random walls; use it with a vehicle that has hitches.

    The scenario first simulates each HAV alone, from its start to its goals along shortest Dubins
    paths. It then draws walls that keep a distance from all areas swept on these paths. So each HAV
    alone can reach its goals. Paths of different HAVs may cross.
    """

    num_havs: Havs = 1
    """Number of HAVs."""
    num_goals: Goals = 2
    """Number of consecutive goals of each HAV."""
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
    """Least distance of all bodies from walls on these paths [m]."""
    widening: Widening = 1.1
    """Radius of the turns of these paths over the least steady radius of a HAV."""
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


@check_relations.register
def _(field: Field) -> None:
    told = f"at least min_wall, {field.min_wall:g} m"
    require(field.max_wall >= field.min_wall, "scenario", field, "max_wall", told)


def populate_field(scenario, world, lane):
    """Draw one world; draw worlds without space for a pose or a wall again."""
    key = scenario_key(world, lane)
    draw = 0
    for _ in range(scenario.world_attempts):
        draw = draw_fleet(scenario.fleet, world.fleet, lane, key, draw)
        # phase -1 means the starts, which are drawn into the rows of the first goals
        for phase in range(-1, scenario.num_goals):
            draw = place_all(scenario, world, max(phase, 0), scenario.side, lane, key, draw)
            if draw < 0:
                break
            if phase < 0:
                keep_starts(scenario, world, lane)
        if draw >= 0:
            draw = build_walls(world.place, scenario, world, lane, key, draw)
        if draw >= 0:
            for agent in range(scenario.num_havs):
                put_at_start(world, agent, lane)
            return True
        draw = -draw
    return False


@kernel
def keep_starts(scenario, world, lane):
    """Keep the starts, which were drawn as first goals, in the rows of the current goals."""
    for agent in range(scenario.num_havs):
        for column in (X, Y, HEADING):
            world.state.goal[agent, column, lane] = world.goals[agent, 0, column, lane]


@kernel
def put_at_start(world, agent, lane):
    """Put a HAV where ``keep_starts`` keeps its start, straight."""
    start = world.state.goal
    x, y, heading = start[agent, X, lane], start[agent, Y, lane], start[agent, HEADING, lane]
    put_straight(world.state, agent, lane, x, y, heading)


@generic
def build_walls(place, scenario, world, lane, key, draw):
    """Draw walls that leave the path of each HAV free; return the next draw.

    It is negative if there was no space, or a HAV would jackknife on its path.
    """


@build_walls.register(Plane)
def _build_nothing(place, scenario, world, lane, key, draw):
    return draw


@build_walls.register(Obstacles)
def _build_beside_ways(place, scenario, world, lane, key, draw):
    """Take the first drawn walls that are not near any path.

    The kernel draws many at once, because driving takes longer than testing.
    """
    due, built = place.due[world.first + lane], 0
    rows = min(scenario.num_havs, _CANDIDATES)
    for _ in range(_ROUNDS):
        for row in range(rows):
            for column in range(scenario.num_segments):
                due[row, column] = 0.0
        walls = DrawnWalls(rows, key, draw, scenario.side, scenario.min_wall, scenario.max_wall)
        if not _drive_all(walls, scenario, world, lane):
            return -(draw + _DRAWS * scenario.num_segments)
        for row in range(rows):
            for column in range(scenario.num_segments):
                if due[row, column] == due[row, column] and built < scenario.num_segments:
                    x, y, cosine, sine, half, _ = _draw_wall(walls, draw)
                    dx, dy = half * cosine, half * sine
                    place_segment(place, built, lane, x - dx, y - dy, x + dx, y + dy)
                    built += 1
                draw += _DRAWS
        if built == scenario.num_segments:
            return draw
    return -draw


class DrawnWalls(NamedTuple):
    """Candidate walls of a round; a rejected one is NaN in ``Obstacles.due``."""

    rows: int
    """Number of their rows of ``Obstacles.due``, for every HAV."""
    key: tuple
    """Key of the episode's random numbers."""
    draw: int
    """Number of the first random number."""
    side: float
    """Side of the square with their middles [m]."""
    min_wall: float
    """Least length [m]."""
    max_wall: float
    """Largest length [m]."""


@kernel
def _draw_wall(walls, draw):
    """Return the wall of a random number, as a rectangle without width."""
    key = walls.key
    x, y = walls.side * uniform(*key, draw), walls.side * uniform(*key, draw + 1)
    sine, cosine = sincos(math.pi * uniform(*key, draw + 2))
    spread = walls.max_wall - walls.min_wall
    half = 0.5 * (walls.min_wall + spread * uniform(*key, draw + 3))
    return x, y, cosine, sine, half, 0.0


@meet_walls.register(DrawnWalls)
def _refuse_near_walls(walls, world, agent, lane, margin):
    place, draw = world.place, walls.draw
    driven, due = place.driven[agent, MOST_MOVED, lane], place.due[world.first + lane]
    for row in range(walls.rows):
        for column in range(due.shape[1]):
            if due[row, column] <= driven:
                gap = gap_to_segment(world, agent, _draw_wall(walls, draw), lane)
                due[row, column] = driven + gap - margin if gap > margin else math.nan
            draw += _DRAWS
    return False


@kernel
def _drive_all(walls, scenario, world, lane):
    """Simulate the paths of all HAVs to their goals; return whether none would jackknife."""
    due = world.place.due[world.first + lane]
    for agent in range(scenario.num_havs):
        put_at_start(world, agent, lane)
        begin_way(world, agent, lane)
        for row in range(walls.rows):
            for column in range(due.shape[1]):
                if due[row, column] == due[row, column]:  # not refused
                    due[row, column] = 0.0
        for phase in range(scenario.num_goals):
            goal = world.goals[agent, phase, :, lane]
            if not drive_witness(
                walls, world, agent, lane, goal, scenario.widening, scenario.margin
            ):
                return False
    return True
