"""This module masks the slots whose step the safety filter would change."""

from baselines.policies.context.memory import BANS, UNDER_WAY
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.elementary import atan2
from hav_env.safety.displacement import roughly_most
from hav_env.safety.keeping_apart import may_come_near, may_go_too_far, must_stand
from hav_env.safety.straightening import bound_backup, straightens_out
from hav_env.safety.trial_moves import IN_DOUBT, drive_on_trial, put_back
from hav_env.world.sensing import drivable_radius, limits, unit_length


@kernel
def widest_steering(policy, world, agent):
    """Return the steering angle of the outermost slots [rad]."""
    _, steepest, _ = limits(world, agent, 0)
    truck = unit_length(world, agent, 0, 0)
    return min(steepest, atan2(policy.sharp * truck, drivable_radius(world, agent, 0)))


@rare_kernel
def drive_slot(policy, world, agent, turned, speed, steering, rows):
    """Move a HAV by the trial step of a slot from its kept position: steering [rad]."""
    put_back(world, agent, rows)
    full, _, _ = limits(world, agent, 0)
    speed[agent, 0], steering[agent, 0] = full, turned
    drive_on_trial(policy.vehicle, policy.dt, world, agent, speed, steering)


@rare_kernel
def is_masked(policy, mine, world, agent, slot, turned, speed, steering, rows):
    """Return whether the safety filter would change a slot, in a block of one world.

    The HAV ends at the position after the slot's step, or anywhere if the slot is masked.
    """
    drive_slot(policy, world, agent, turned, speed, steering, rows)
    if may_go_too_far(policy, world, agent, 0):
        return True
    if may_come_near(policy, world, agent, 0) and must_stand(
        policy.safety,
        policy,
        world,
        agent,
        0,
        roughly_most(world, agent, 0, policy.dt),
        rows,
    ):
        return True
    bound_backup(policy.dt, world, agent, rows)
    if rows[IN_DOUBT, 0] != 0.0:
        if mine[BANS + slot, 0] > mine[UNDER_WAY, 0]:
            return True
        if not straightens_out(
            policy.safety,
            policy.vehicle,
            policy.dt,
            world,
            agent,
            speed,
            steering,
            rows,
        ):
            mine[BANS + slot, 0] = mine[UNDER_WAY, 0] + policy.ban
            return True
        drive_slot(policy, world, agent, turned, speed, steering, rows)
    return False
