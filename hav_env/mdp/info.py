"""This module reports on each HAV (``info``): running totals of an episode, by name."""

from hav_env.compiled import generic, kernel
from hav_env.world.arrays import (
    ACTUAL,
    DISTANCE,
    EPISODE,
    HIT_DISTANCE,
    LARGEST,
    NEVER,
    PATH,
    SEED,
    STEP,
    WHEN,
    WHERE,
    goal_under_way,
)
from hav_env.world.event_table import EVENTS, obstacle_hit_at, unharmed
from hav_env.world.goals import goals_hit
from hav_env.world.place.segments import Obstacles, Plane

REPORT = (
    "is_success",
    "goals_hit",
    "waits",
    "distance_to_goal",
    "dubins_to_goal",
    *(event.name for event in EVENTS if not event.obstacles),
    "collision_partner",
    "largest_articulation",
    "path_length",
    "steps",
    "seed",
    "episode_number",  # "episode" is what RecordEpisodeStatistics writes
)
OBSTACLE_REPORT = tuple(event.name for event in EVENTS if event.obstacles)
_NUM_EVENTS = len(EVENTS) - len(OBSTACLE_REPORT)
_TOLD_SUCCESS = REPORT.index("is_success")
_TOLD_HITS = REPORT.index("goals_hit")
_TOLD_WAITS = REPORT.index("waits")
_TOLD_DISTANCE = REPORT.index("distance_to_goal")
_TOLD_DUBINS = REPORT.index("dubins_to_goal")
_TOLD_EVENTS = REPORT.index(EVENTS[0].name)
_TOLD_PARTNER = REPORT.index("collision_partner")
_TOLD_LARGEST = REPORT.index("largest_articulation")
_TOLD_PATH = REPORT.index("path_length")
_TOLD_STEPS = REPORT.index("steps")
_TOLD_SEED = REPORT.index("seed")
_TOLD_EPISODE = REPORT.index("episode_number")


@kernel
def write_report(world, agent, remaining, report):
    """Write the report on one HAV in every lane of a block of worlds.

    Args:
        world: the block.
        agent: the HAV.
        remaining: (N, W) Dubins length to the goal under way [m].
        report: (len(REPORT), N, W) to be written.
    """
    first, total, clock = world.record.first, world.record.total, world.state.clock
    num_goals = world.goals.shape[1]
    for lane in range(world.lanes):
        waits, phase = world.state.waiting[agent, lane], goal_under_way(world.state, agent, lane)
        distance, left = world.state.goal[agent, DISTANCE, lane], remaining[agent, lane]
        if waits:  # where it stopped: it may have been removed since
            distance, left = world.record.goal[agent, phase, HIT_DISTANCE, lane], 0.0
        report[_TOLD_WAITS, agent, lane] = waits
        report[_TOLD_DISTANCE, agent, lane] = distance
        report[_TOLD_DUBINS, agent, lane] = left
    for lane in range(world.lanes):
        hits = goals_hit(world, agent, lane)
        report[_TOLD_HITS, agent, lane] = hits
        report[_TOLD_SUCCESS, agent, lane] = (hits == num_goals) & unharmed(world, agent, lane)
    for event in range(_NUM_EVENTS):
        for lane in range(world.lanes):
            report[_TOLD_EVENTS + event, agent, lane] = first[agent, event, WHEN, lane] != NEVER
    for lane in range(world.lanes):
        report[_TOLD_PARTNER, agent, lane] = first[agent, ACTUAL, WHERE, lane]
    for lane in range(world.lanes):
        report[_TOLD_LARGEST, agent, lane] = total[agent, LARGEST, lane]
        report[_TOLD_PATH, agent, lane] = total[agent, PATH, lane]
    for lane in range(world.lanes):
        report[_TOLD_STEPS, agent, lane] = clock[STEP, lane]
        report[_TOLD_SEED, agent, lane] = clock[SEED, lane]
        report[_TOLD_EPISODE, agent, lane] = clock[EPISODE, lane]


@generic
def write_obstacle_report(place, world, agent, report):
    """Write in every lane whether a HAV has collided with an obstacle, where there are any.

    Args:
        place: of the block.
        world: the block.
        agent: the HAV.
        report: (len(OBSTACLE_REPORT), N, W) to be written.
    """


@write_obstacle_report.register(Plane)
def _write_nothing(place, world, agent, report):
    pass


@write_obstacle_report.register(Obstacles)
def _write_hits(place, world, agent, report):
    for lane in range(world.lanes):
        report[0, agent, lane] = obstacle_hit_at(place, world, agent, lane) != NEVER
