"""This module predicts a stretch: steps whose axles are included in an outline afterwards.

Steps and outlines are computed apart. Each unit waits for the unit ahead, and in the meantime a
processor can begin the next steps, unless the outlines are between them: half of the time.
"""

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory.sizes import MAX_UNITS
from baselines.policies.reserve.prediction.motion import advance_into
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.kdop import include_both

STRETCH = 16  # steps of a stretch, at most
# numbers of a step: cosine and sine of each unit's heading, x and y of the truck's rear axle [m]
_STEP_X = 2 * MAX_UNITS
_STEP_NUMBERS = _STEP_X + 2
STRETCH_SIZE = (STRETCH + 1) * _STEP_NUMBERS  # numbers of a stretch, with those before it


@kernel
def begin_stretch(rows, chains):
    """Begin a stretch with ``PREDICTED_CHAIN``."""
    for row in range(2 * (int(rows[m.OWN_TRAILERS]) + 1)):
        chains[row] = rows[m.PREDICTED_CHAIN + row]


@kernel
def add_step(rows, chains, step, x, y, turn, distance):
    """Predict a step of a stretch; arguments and result are as in ``advance_into``."""
    after = (step + 1) * _STEP_NUMBERS
    x, y, least = advance_into(rows, chains, step * _STEP_NUMBERS, after, x, y, turn, distance)
    chains[after + _STEP_X], chains[after + _STEP_X + 1] = x, y
    return x, y, least


@rare_kernel
def end_stretch(rows, chains, count, outline):
    """Include all axles after each step in an outline, and write ``PREDICTED_CHAIN``."""
    for step in range(1, count + 1):
        _include_step(rows, chains, step * _STEP_NUMBERS, outline)
    for row in range(2 * (int(rows[m.OWN_TRAILERS]) + 1)):
        rows[m.PREDICTED_CHAIN + row] = chains[count * _STEP_NUMBERS + row]


@kernel
def _include_step(rows, chains, at, outline):
    """Include the axles of a step; their places are those of ``place_axles``."""
    x, y, last = chains[at + _STEP_X], chains[at + _STEP_X + 1], int(rows[m.OWN_TRAILERS])
    length = rows[m.OWN_LENGTHS]
    nose_x, nose_y = x + length * chains[at], y + length * chains[at + 1]
    include_both(rows, outline, nose_x, nose_y, x, y)
    for unit in range(1, last + 1, 2):
        ahead_x, ahead_y = _axle_behind(rows, chains, at, unit, x, y)
        x, y = ahead_x, ahead_y
        if unit < last:
            x, y = _axle_behind(rows, chains, at, unit + 1, x, y)
        include_both(rows, outline, ahead_x, ahead_y, x, y)


@kernel
def _axle_behind(rows, chains, at, unit, x, y):
    """Return the axle of a unit: x, y [m], behind that of the unit ahead."""
    length = rows[m.OWN_LENGTHS + unit]
    return x - length * chains[at + 2 * unit], y - length * chains[at + 2 * unit + 1]
