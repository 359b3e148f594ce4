"""What is told of each HAV beside its observation: running totals of an episode, by name."""

from hav_env.compiled import kernel
from hav_env.world.arrays import (
    ACTUAL,
    DISTANCE,
    EPISODE,
    HIT_DISTANCE,
    JACKKNIFE,
    LARGEST,
    NEVER,
    PATH,
    PHASE,
    POTENTIAL,
    SEED,
    STEP,
    WHEN,
    WHERE,
)
from hav_env.world.events import goals_hit

REPORT = (
    "is_success",
    "goals_hit",
    "waits",
    "distance_to_goal",
    "dubins_to_goal",
    "jackknifed",
    "potential_collision",
    "actual_collision",
    "collision_partner",
    "largest_articulation",
    "path_length",
    "steps",
    "seed",
    "episode_number",  # "episode" is what RecordEpisodeStatistics writes
)
_SUCCESS, _HITS, _WAITS, _DISTANCE, _DUBINS, _JACKKNIFED, _POTENTIAL, _ACTUAL = range(8)
_PARTNER, _LARGEST, _PATH, _STEPS, _SEED, _EPISODE = range(8, 14)


@kernel
def write_report(world, agent, remaining, report):
    """Write the report on one HAV in every lane of a block of worlds.

    Args:
        world, agent: as everywhere.
        remaining: (N, W) Dubins length to the goal under way [m].
        report: (len(REPORT), N, W) to be written.
    """
    first, total, clock = world.record.first, world.record.total, world.state.clock
    num_goals = world.goals.shape[1]
    for lane in range(world.lanes):
        waits, phase = world.state.waiting[agent, lane], clock[PHASE, lane]
        distance, left = world.state.goal[agent, DISTANCE, lane], remaining[agent, lane]
        if waits:  # where it stopped: it may have been removed since
            distance, left = world.record.goal[agent, phase, HIT_DISTANCE, lane], 0.0
        report[_WAITS, agent, lane] = waits
        report[_DISTANCE, agent, lane] = distance
        report[_DUBINS, agent, lane] = left
    for lane in range(world.lanes):
        jackknifed = first[agent, JACKKNIFE, WHEN, lane] != NEVER
        collided = first[agent, ACTUAL, WHEN, lane] != NEVER
        hits = goals_hit(world, agent, lane)
        report[_HITS, agent, lane] = hits
        report[_JACKKNIFED, agent, lane] = jackknifed
        report[_ACTUAL, agent, lane] = collided
        unharmed = (not jackknifed) & (not collided)
        report[_SUCCESS, agent, lane] = (hits == num_goals) & unharmed
    for lane in range(world.lanes):
        report[_POTENTIAL, agent, lane] = first[agent, POTENTIAL, WHEN, lane] != NEVER
        report[_PARTNER, agent, lane] = first[agent, ACTUAL, WHERE, lane]
    for lane in range(world.lanes):
        report[_LARGEST, agent, lane] = total[agent, LARGEST, lane]
        report[_PATH, agent, lane] = total[agent, PATH, lane]
    for lane in range(world.lanes):
        report[_STEPS, agent, lane] = clock[STEP, lane]
        report[_SEED, agent, lane] = clock[SEED, lane]
        report[_EPISODE, agent, lane] = clock[EPISODE, lane]
