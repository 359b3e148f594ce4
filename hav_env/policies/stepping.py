"""This module advances worlds by one step in which a policy drives every HAV, compiled."""

from hav_env.compiled import fixed, kernel
from hav_env.policies.interface import act_for
from hav_env.simulator.transition import count_step, finish_step, move_hav, remove_arrived
from hav_env.world.task import IN_TURN


@kernel
def act_and_step(policy, memory, task, vehicle, world, speed, steering):
    """Let the HAVs of a block of worlds decide and move, together or in turn as the task states.

    Args:
        policy: Policy that drives every HAV.
        memory: (N, K, W) of the policy.
        task: Rules of the episode.
        vehicle: Vehicle model (kinematics).
        world: Block of worlds.
        speed: (N, W) speeds of the trucks [m/s], overwritten.
        steering: (N, W) steering angles [rad], overwritten.

    Returns:
        A number above 0 if worlds may have ended, as in ``step``.
    """
    num_havs = speed.shape[0]
    late_worlds, events, hits = 0, 0, 0
    # one loop for both orders: the policy's kernel is long and must be compiled only once
    for turn in range(2 * num_havs):
        decides, hav = _whose_turn(task, num_havs, turn)
        agent = fixed(hav)
        if decides:
            act_for(policy, memory, world, agent, speed, steering)
        else:
            if hav == 0:
                remove_arrived(task, world)
                late_worlds = count_step(task, world)
            happened, hit = move_hav(task, vehicle, world, agent, speed, steering)
            events, hits = events + happened, hits + hit
    return late_worlds + finish_step(task, world, events, hits)


@kernel
def _whose_turn(task, num_havs, turn):
    """Return whether a HAV decides or moves in this turn, and its index."""
    if task.order == IN_TURN:
        return turn % 2 == 0, turn // 2
    return turn < num_havs, turn if turn < num_havs else turn - num_havs
