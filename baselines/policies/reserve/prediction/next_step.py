"""This module predicts the next step of a HAV that receives no outlines of others."""

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import sizes
from baselines.policies.reserve.perception.other_agents import slot_at
from baselines.policies.reserve.perception.own_state import sag, stride
from baselines.policies.reserve.prediction.chain import keeps_clear_of, place_axles
from baselines.policies.reserve.prediction.motion import advance_chain, follow, sense_chain
from hav_env.compiled import rare_kernel

_SAGS = 6.0  # of rolling wheels from the places of straight steps: up to 5.7 were measured
_SHORTEST = 0.5  # of a step: no unit is shorter, which the preconditions check


@rare_kernel
def next_step_keeps_clear(rows):
    """Return whether the HAV is clear of all others after its next step, if they take one too."""
    turn, distance = follow(rows)
    sense_chain(rows)
    x, y, _ = advance_chain(rows, 0.0, 0.0, turn, distance)
    place_axles(rows, x, y)
    # for others without a slot, the HAV knows only the bound of their units
    step, steepest = rows[m.OWN_STEP], rows[m.OWN_STEERING_TANGENT]
    most = stride(step, steepest, _SHORTEST * step, sizes.MAX_TRAILERS)
    most += 2.0 * _SAGS * sag(step, steepest, _SHORTEST * step)
    if rows[m.OWN_REACH] + rows[m.OWN_STRIDE] + most > rows[m.COVERED_RADIUS]:
        return False
    for number in range(int(rows[m.NUM_SLOTS])):
        slot = slot_at(number)
        # during the step, the rest of one stride and the beginning of the other one
        # are together no longer than the longer stride
        margin = max(rows[m.OWN_STRIDE], rows[slot + m.SLOT_STRIDE])
        margin += _SAGS * (rows[m.OWN_SAG] + rows[slot + m.SLOT_SAG])
        if not keeps_clear_of(rows, slot, margin):
            return False
    return True
