"""One step of one world: the whole decision process on one screen."""

from hav_env.compiled import world_kernel
from hav_env.events import (
    clear_record,
    record_articulation,
    record_assignment,
    record_collisions,
    record_goal,
)
from hav_env.geometry import clip
from hav_env.neighborhood import find_nearby
from hav_env.scenarios import populate
from hav_env.vehicles import move
from hav_env.world import EPISODE, MOVED, PATH, PHASE, SEED, SPEED, STEERING, STEP


@world_kernel
def begin(scenario, task, world, seed, episode):
    """Start an episode; return whether the scenario found room for its HAVs."""
    world.state.clock[SEED], world.state.clock[EPISODE] = seed, episode
    world.state.clock[STEP] = 0
    clear_record(world.record)
    placed = populate(scenario, world)
    _begin_phase(world, 0)
    find_nearby(task, world)
    record_collisions(world)
    return placed


@world_kernel
def step(task, vehicle, world, speed, steering):
    """Advance a world by one step.

    Args:
        task, vehicle: the rules and the kinematics.
        world: the view of one world.
        speed: (N,) [m/s] and steering: (N,) [rad], cut to the limits of each HAV. A HAV that
            waits at its goal stands, whatever its speed.
    """
    state, fleet = world.state, world.fleet
    state.clock[STEP] += 1
    for agent in range(state.x.shape[0]):
        if state.waiting[agent]:
            continue
        v = clip(speed[agent], 0.0, fleet.limit[agent, SPEED])
        steepest = fleet.limit[agent, STEERING]
        phi = clip(steering[agent], -steepest, steepest)
        move(vehicle, task.dt, world, agent, v, phi)
        world.record.total[agent, PATH] += v * task.dt
        world.record.total[agent, MOVED] += 1
        record_articulation(world, agent)
    if state.x.shape[0] > 1:
        find_nearby(task, world)
        record_collisions(world)
    _score_goals(task, world)


@world_kernel
def _score_goals(task, world):
    """Let HAVs that hit their goal wait; when all do, all receive their next goal."""
    state = world.state
    all_wait = True
    for agent in range(state.x.shape[0]):
        if not state.waiting[agent]:
            state.waiting[agent] = record_goal(task, world, agent)
        all_wait = all_wait and state.waiting[agent]
    if all_wait and state.clock[PHASE] + 1 < world.goals.shape[1]:
        _begin_phase(world, state.clock[PHASE] + 1)


@world_kernel
def _begin_phase(world, phase):
    world.state.clock[PHASE] = phase
    for agent in range(world.state.x.shape[0]):
        world.state.waiting[agent] = False
        record_assignment(world, agent)


@world_kernel
def succeeded(world):
    """Tell whether all HAVs have hit their last goals."""
    for agent in range(world.state.x.shape[0]):
        if not world.state.waiting[agent]:
            return False
    return True


@world_kernel
def ended(task, world):
    """Tell whether the episode is over: all last goals hit, or time is up."""
    return world.state.clock[STEP] >= task.max_steps or succeeded(world)
