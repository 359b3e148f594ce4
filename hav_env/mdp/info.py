"""This module reports on each HAV (``info``): running totals of an episode, by name."""

from typing import Any

from hav_env.compiled import generic, kernel
from hav_env.world.arrays import (
    ACTUAL,
    DISTANCE,
    EPISODE,
    HIT_DISTANCE,
    INTERVENTIONS,
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
    "episode_number",  # "episode" is the key that RecordEpisodeStatistics writes
)
OBSTACLE_REPORT = tuple(event.name for event in EVENTS if event.obstacles)
FILTER_REPORT = ("interventions",)
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


def name_numbers(reward: Any, obstacles: bool, filtered: bool) -> tuple[str, ...]:
    """Return the names of the infos of a HAV.

    Args:
        reward: Reward whose terms are reported.
        obstacles: Whether worlds have obstacles.
        filtered: Whether a safety filter changes commands.
    """
    returns = (f"return_{term}" for term in reward._fields)
    names = *REPORT, *returns, *(OBSTACLE_REPORT if obstacles else ())
    return (*names, *FILTER_REPORT) if filtered else names


@kernel
def write_report(world, agent, remaining, report):
    """Write the report on one HAV in every lane of a block of worlds.

    Args:
        world: Block of worlds.
        agent: Index of the HAV.
        remaining: (N, W) Dubins length to the goal under way [m].
        report: (len(REPORT), N, W) to write.
    """
    first, total, clock = world.record.first, world.record.total, world.state.clock
    num_goals = world.goals.shape[1]
    for lane in range(world.lanes):
        waits, phase = world.state.waiting[agent, lane], goal_under_way(world.state, agent, lane)
        distance, left = world.state.goal[agent, DISTANCE, lane], remaining[agent, lane]
        if waits:  # its last position: it may have been removed since
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


@kernel
def write_interventions(world, agent, report):
    """Write, in every lane, the number of steps in which a safety filter changed a HAV's command.

    Args:
        world: A block of worlds.
        agent: Index of the HAV.
        report: (len(FILTER_REPORT), N, W) to write; empty without a filter.
    """
    if report.shape[0] > 0:
        for lane in range(world.lanes):
            report[0, agent, lane] = world.record.total[agent, INTERVENTIONS, lane]


@generic
def write_obstacle_report(place, world, agent, report):
    """Write, in every lane, whether a HAV has collided with an obstacle, if the world has any.

    Args:
        place: Place of the block.
        world: Block of worlds.
        agent: Index of the HAV.
        report: (len(OBSTACLE_REPORT), N, W) to write, and more.

    Returns:
        Number of rows that it has written.
    """


@write_obstacle_report.register(Plane)
def _write_nothing(place, world, agent, report):
    return 0


@write_obstacle_report.register(Obstacles)
def _write_hits(place, world, agent, report):
    for lane in range(world.lanes):
        report[0, agent, lane] = obstacle_hit_at(place, world, agent, lane) != NEVER
    return 1
