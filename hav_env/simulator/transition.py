"""This module steps a block of worlds, and ends their episodes.

It has the whole transition of the decision process: motion, events, goals, time.
"""

from hav_env.compiled import fixed, kernel, rare_kernel
from hav_env.vehicles import acting_block, actuate, actuators_of, move
from hav_env.world.arrays import (
    ACTUAL,
    JACKKNIFE,
    PHASE,
    REMOVED,
    STEP,
    WHEN,
    goal_under_way,
    is_removed,
)
from hav_env.world.continuous_collision import note_axles
from hav_env.world.event_table import obstacle_hit_at
from hav_env.world.events import record_collisions, record_jackknifes, record_motion
from hav_env.world.goals import assign_goal, record_approach
from hav_env.world.lanes import block_of
from hav_env.world.neighborhood import find_nearby
from hav_env.world.obstacles.collisions import (
    add_motion,
    note_posture,
    record_obstacle_collisions,
)
from hav_env.world.place.guidance import follow_route
from hav_env.world.task import ALONE, END, REMOVE

# x of the first removed HAV, and the distance between removed HAVs [m]
_REMOVED_X, _REMOVED_SPACING = 1e13, 1e8


@kernel
def step(task, vehicle, world, speed, steering):
    """Advance a block of worlds by one step.

    Args:
        task: Rules of the episode.
        vehicle: Vehicle model (kinematics).
        world: Block of worlds.
        speed: (N, W) [m/s], clipped to the limit of each HAV. A HAV that waits at its goal stands
            or brakes, whatever its commanded speed.
        steering: (N, W) [rad], clipped as well.

    Returns:
        A number above 0 if worlds may have ended: time is up, a goal was hit, or an event happened.
    """
    hits, events = 0, 0
    late_worlds = count_step(task, world)
    for hav in range(world.state.x.shape[0]):
        happened, hit = move_hav(task, vehicle, world, fixed(hav), speed, steering)
        events, hits = events + happened, hits + hit
    return late_worlds + finish_step(task, world, events, hits)


@kernel
def move_hav(task, vehicle, world, agent, speed, steering):
    """Move one HAV of a block of worlds by its command, and record the results.

    Returns:
        Number of lanes in which it may have jackknifed or collided with an obstacle, and number of
        lanes in which it hit its goal.
    """
    actuators = actuators_of(vehicle)
    actuate(actuators, task.dt, world, agent, speed, steering)
    moving = acting_block(actuators, world, agent)
    note_posture(moving.place, moving, agent)
    move(vehicle, task.dt, moving, agent)
    record_motion(task, moving, agent)
    add_motion(moving.place, moving, agent)
    if task.record_every == 1:
        events = _look_for_events(task, moving, agent)
    else:  # an event may have made the HAV wait
        events = _look_for_events(task, world, agent)
    hits = record_approach(task, moving, agent)
    follow_route(moving.guidance, moving, agent)
    return events, hits


@kernel
def _look_for_events(task, world, agent):
    """Look for jackknifes and obstacle collisions of a HAV; return how many there may be."""
    events = record_jackknifes(task, world, agent)
    return events + record_obstacle_collisions(world.place, task, world, agent)


@kernel
def finish_step(task, world, events, hits):
    """Look for collisions and assign goals, once all HAVs have moved.

    Args:
        task: Rules of the episode.
        world: Block of worlds.
        events: Number of events that the moves of the HAVs may have caused.
        hits: Number of goals hit.

    Returns:
        Number of events that there may be in all.
    """
    num_havs = world.state.x.shape[0]
    if num_havs > 1:
        find_nearby(task, world)
        events += record_collisions(task, world)
    if task.continuous_collisions:
        for agent in range(num_havs):
            note_axles(world, agent)
    if hits > 0:
        _assign_next_goals(task, world)
    return hits + events


@kernel
def count_step(task, world):
    """Count the step; return the number of worlds whose time is up."""
    clock, late_worlds = world.state.clock, 0
    for lane in range(world.lanes):
        clock[STEP, lane] += 1
        late_worlds += late(task, world, lane)
    return late_worlds


@rare_kernel
def _assign_next_goals(task, world):
    """Give waiting HAVs their next goal: all together, once all wait, or each by itself."""
    for lane in range(world.lanes):
        if task.next_goal == ALONE or all_wait(world, lane):
            for agent in range(world.state.x.shape[0]):
                phase = goal_under_way(world.state, agent, lane) + 1
                if world.state.waiting[agent, lane] and phase < world.goals.shape[1]:
                    assign_goal(world, agent, lane, phase)


@kernel
def remove_arrived(task, world):
    """Remove HAVs that have hit their last goals, if that is the rule, each to its own place.

    The caller that takes an action calls this first, so users see the outcome at the goal before.
    """
    if task.on_goal == REMOVE:
        _remove_arrived(task, world)


@rare_kernel
def _remove_arrived(task, world):
    """Put each removed HAV at a place where no HAV can touch or sense it.

    A HAV that drives straight on from the farthest start for the longest episode moves 1e12 m. The
    distance between places exceeds the longest range and two reaches.
    """
    for lane in range(world.lanes):
        for agent in range(world.state.x.shape[0]):
            if arrived(world, agent, lane) and not is_removed(world, agent, lane):
                world.record.total[agent, REMOVED, lane] = 1.0
                world.state.speed[agent, lane] = 0.0  # the HAV may have rolled
                world.state.x[agent, lane] = _REMOVED_X + _REMOVED_SPACING * agent
                if task.continuous_collisions:
                    note_axles(block_of(world, lane, 1, world.units), agent)


@kernel
def arrived(world, agent, lane):
    """Return whether a HAV has hit its last goal."""
    last = world.state.goal[agent, PHASE, lane] == world.goals.shape[1] - 1
    return last & world.state.waiting[agent, lane]


@kernel
def all_wait(world, lane):
    """Return whether all HAVs of a world wait at their goals under way."""
    for agent in range(world.state.x.shape[0]):
        if not world.state.waiting[agent, lane]:
            return False
    return True


@kernel
def terminated(task, world, agents, lane):
    """Return whether an episode is over for the first ``agents`` HAVs of a world.

    It is over if all of them have hit their last goals, or one of them had an accident that ends
    it. HAVs that touch at their start poses (in one of a thousand worlds of the paper's pairs) had
    no accident.
    """
    first, finished, broken = world.record.first, True, False
    for agent in range(agents):
        jackknifed = first[agent, JACKKNIFE, WHEN, lane] > 0
        collided = first[agent, ACTUAL, WHEN, lane] > 0
        broken = broken | ((task.on_jackknife == END) & jackknifed)
        broken = broken | ((task.on_collision == END) & collided)
        hit = obstacle_hit_at(world.place, world, agent, lane) > 0
        broken = broken | ((task.on_obstacle == END) & hit)
        finished = finished & arrived(world, agent, lane)
    return finished | broken


@kernel
def late(task, world, lane):
    """Return whether time is up."""
    return world.state.clock[STEP, lane] >= task.max_steps


@kernel
def ended(task, world, lane):
    """Return whether an episode is over: terminated, or time is up.

    In Python it also accepts a slice of lanes.
    """
    return late(task, world, lane) | terminated(task, world, world.state.x.shape[0], lane)
