"""This module predicts several paths of a lone HAV side by side, each in a lane.

A chain is a long sequence of operations that wait for each other. In lanes, one instruction does
the same operation for several chains, in the same order as ``motion.advance_chain`` does it for
one. The results are therefore equal. Values in a lane after the end of its trial are void.
"""

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory.sizes import TRIALS, TURN_RADII
from baselines.policies.reserve.perception.own_state import SURELY, hits_goal, sensed_goal
from baselines.policies.reserve.prediction.motion import (
    most_turn,
    pull_unit,
    sense_chain,
    turns_little,
)
from baselines.policies.reserve.prediction.paths import total_length
from hav_env.compiled import fixed, kernel, rare_kernel
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import TWO_PI, clip

RUNNING, SURVIVED, DROPPED = 0.0, 1.0, -1.0  # results of a trial

_SEGMENTS = 3  # of a path that is tried: most
_ROUGH_STEPS = 2.0  # steps at a time while arcs are measured: the path is predicted exactly later
_STRAIGHT_FOOTPRINTS = 2.0  # straight ahead behind a goal, until the HAV is nearly straight


@rare_kernel
def advance_trials(rows, distance):
    """Move the chains of all trials by one step: each truck by its ``TRIAL_TURN``.

    Args:
        rows: The HAV's memory.
        distance: Distance that the truck's rear axle moves after the turn [m].
    """
    for lane in range(TRIALS):
        sine, cosine = sincos(rows[m.TRIAL_TURN + lane])
        before_cosine = rows[m.TRIAL_CHAINS + lane]
        before_sine = rows[m.TRIAL_CHAINS + TRIALS + lane]
        ahead_cosine = before_cosine * cosine - before_sine * sine
        ahead_sine = before_sine * cosine + before_cosine * sine
        rows[m.TRIAL_CHAINS + lane] = ahead_cosine
        rows[m.TRIAL_CHAINS + TRIALS + lane] = ahead_sine
        rows[m.TRIAL_X + lane] += distance * ahead_cosine
        rows[m.TRIAL_Y + lane] += distance * ahead_sine
        rows[m.TRIAL_PULL + lane] = distance
        rows[m.TRIAL_LEAST + lane] = 1.0
    for unit in range(1, int(rows[m.OWN_TRAILERS]) + 1):
        # a loop for each: choosing inside would compute both
        if turns_little(rows, unit, distance):
            _pull_trials(rows, fixed(unit), True)
        else:
            _pull_trials(rows, fixed(unit), False)


@kernel
def _pull_trials(rows, unit, little):
    """Turn and move a unit of all trials after the one ahead; see ``pull_unit``."""
    length, fold_turn = rows[m.OWN_LENGTHS + unit], rows[m.OWN_FOLD_TURN]
    first = m.TRIAL_CHAINS + 2 * TRIALS * (unit - 1)
    chains = rows[first : first + 4 * TRIALS]
    for lane in range(TRIALS):
        cosine, sine, pull, turn, least = pull_unit(
            *(chains[lane], chains[TRIALS + lane]),
            *(chains[2 * TRIALS + lane], chains[3 * TRIALS + lane]),
            *(rows[m.TRIAL_PULL + lane], rows[m.TRIAL_TURN + lane], rows[m.TRIAL_LEAST + lane]),
            *(length, fold_turn, little),
        )
        chains[2 * TRIALS + lane], chains[3 * TRIALS + lane] = cosine, sine
        rows[m.TRIAL_PULL + lane], rows[m.TRIAL_TURN + lane] = pull, turn
        rows[m.TRIAL_LEAST + lane] = least


@kernel
def _begin_trial(rows, lane):
    """Begin a trial in a lane, with ``PREDICTED_CHAIN``."""
    for row in range(2 * (int(rows[m.OWN_TRAILERS]) + 1)):
        rows[m.TRIAL_CHAINS + TRIALS * row + lane] = rows[m.PREDICTED_CHAIN + row]
    rows[m.TRIAL_X + lane], rows[m.TRIAL_Y + lane] = 0.0, 0.0
    rows[m.TRIAL_HEADING + lane], rows[m.TRIAL_DRIVEN + lane] = 0.0, 0.0
    rows[m.TRIAL_BEYOND + lane], rows[m.TRIAL_RESULT + lane] = 0.0, RUNNING


@rare_kernel
def measure_first_turns(rows):
    """Measure the longest arc of each radius from here: as long as every joint keeps its limit.

    A whole turn is the longest.
    """
    sense_chain(rows)
    _measure_turns(rows)
    for number in range(TURN_RADII):
        rows[m.FIRST_TURNS_LEFT + number] = rows[m.TRIAL_HEADING + number]
        rows[m.FIRST_TURNS_RIGHT + number] = rows[m.TRIAL_HEADING + TURN_RADII + number]


@rare_kernel
def measure_last_turns(rows):
    """Measure the longest arc of each radius from a straight chain, unless it is known."""
    if rows[m.LAST_TURNS] > 0.0:
        return
    for unit in range(int(rows[m.OWN_TRAILERS]) + 1):
        rows[m.PREDICTED_CHAIN + 2 * unit], rows[m.PREDICTED_CHAIN + 2 * unit + 1] = 1.0, 0.0
    _measure_turns(rows)
    for number in range(TURN_RADII):
        rows[m.LAST_TURNS + number] = rows[m.TRIAL_HEADING + number]


@rare_kernel
def _measure_turns(rows):
    """Write the longest turns of ``PREDICTED_CHAIN`` into ``TRIAL_HEADING``: left, then right."""
    step, bound = _ROUGH_STEPS * rows[m.OWN_STEP], rows[m.OWN_LEAST_COSINE]
    for lane in range(TRIALS):
        _begin_trial(rows, lane)
        side = 1.0 if lane < TURN_RADII else -1.0
        rows[m.TRIAL_CURVATURES + lane] = side / rows[m.RADII + lane % TURN_RADII]
        rows[m.TRIAL_LENGTHS + lane] = step / rows[m.RADII + lane % TURN_RADII]
    running = TRIALS
    while running > 0:
        for lane in range(TRIALS):
            turn = rows[m.TRIAL_LENGTHS + lane]
            rows[m.TRIAL_TURN + lane] = turn if rows[m.TRIAL_CURVATURES + lane] > 0.0 else -turn
        advance_trials(rows, step)
        running = 0
        for lane in range(TRIALS):
            turned, result = rows[m.TRIAL_HEADING + lane], rows[m.TRIAL_RESULT + lane]
            result = DROPPED if rows[m.TRIAL_LEAST + lane] < bound else result
            further = turned + rows[m.TRIAL_LENGTHS + lane]
            turned = further if result == RUNNING else turned
            result = SURVIVED if (result == RUNNING) & (turned >= TWO_PI) else result
            rows[m.TRIAL_HEADING + lane], rows[m.TRIAL_RESULT + lane] = turned, result
            running += 1 if result == RUNNING else 0


@rare_kernel
def empty_trials(rows):
    """End all trials, and let those that begin do so with the own chain as it is now."""
    sense_chain(rows)
    for lane in range(TRIALS):
        rows[m.TRIAL_RESULT + lane] = DROPPED


@rare_kernel
def begin_trial(rows, lane, path):
    """Begin the trial of a path of at most three segments in a lane."""
    _begin_trial(rows, lane)
    rows[m.TRIAL_TOTAL + lane] = total_length(rows, path)
    for segment in range(_SEGMENTS):
        used = segment < rows[path + m.NUM_SEGMENTS]
        row = TRIALS * segment + lane
        rows[m.TRIAL_CURVATURES + row] = rows[path + m.CURVATURES + segment] if used else 0.0
        rows[m.TRIAL_LENGTHS + row] = rows[path + m.LENGTHS + segment] if used else 0.0


@rare_kernel
def run_trials(policy, rows):
    """Run all trials until one that runs now ends."""
    most = most_turn(rows, rows[m.OWN_STEP])
    before = 0
    for lane in range(TRIALS):
        before += 1 if rows[m.TRIAL_RESULT + lane] == RUNNING else 0
    running = before
    while running == before:
        _steer_trials(rows, rows[m.OWN_STEP], most)
        advance_trials(rows, rows[m.OWN_STEP])
        running = _judge_trials(policy, rows)


@kernel
def _steer_trials(rows, distance, most):
    """Write the turn of each truck: along its path, and straight on behind the goal."""
    for lane in range(TRIALS):
        rest, wanted = rows[m.TRIAL_DRIVEN + lane] + 0.5 * distance, 0.0
        for segment in range(_SEGMENTS):
            along = min(rest, rows[m.TRIAL_LENGTHS + TRIALS * segment + lane])
            wanted += rows[m.TRIAL_CURVATURES + TRIALS * segment + lane] * along
            rest -= along
        turn = clip(wanted - rows[m.TRIAL_HEADING + lane], -most, most)
        turn = 0.0 if rows[m.TRIAL_BEYOND + lane] > 0.0 else turn
        # a path that has ended before this step has not hit the goal
        ended = rows[m.TRIAL_DRIVEN + lane] > rows[m.TRIAL_TOTAL + lane]
        missed = ended & (rows[m.TRIAL_BEYOND + lane] == 0.0)
        result = rows[m.TRIAL_RESULT + lane]
        rows[m.TRIAL_RESULT + lane] = DROPPED if (result == RUNNING) & missed else result
        rows[m.TRIAL_HEADING + lane] += turn
        rows[m.TRIAL_TURN + lane] = turn


@kernel
def _judge_trials(policy, rows):
    """Write the results of trials that end with this step, and return how many go on.

    A trial survives if its path hits the goal while every articulation stays allowed. Behind a goal
    that is not the last one, that must hold straight ahead too, until the HAV is straight again.
    """
    goal_x, goal_y, goal_heading = sensed_goal(rows)
    bound, distance = rows[m.OWN_LEAST_COSINE], rows[m.OWN_STEP]
    last = rows[m.OWN_GOALS_LEFT] == 1.0
    straight = _STRAIGHT_FOOTPRINTS * rows[m.OWN_FOOTPRINT]
    running = 0
    for lane in range(TRIALS):
        hit = hits_goal(
            policy,
            goal_x - rows[m.TRIAL_X + lane],
            goal_y - rows[m.TRIAL_Y + lane],
            goal_heading - rows[m.TRIAL_HEADING + lane],
            SURELY,
        )
        was_beyond = rows[m.TRIAL_BEYOND + lane] > 0.0
        beyond = was_beyond | hit
        driven = rows[m.TRIAL_DRIVEN + lane] + distance
        driven = 0.0 if beyond & (not was_beyond) else driven
        result = rows[m.TRIAL_RESULT + lane]
        done = beyond & (last | (driven >= straight))
        ended = DROPPED if rows[m.TRIAL_LEAST + lane] < bound else SURVIVED if done else RUNNING
        result = ended if result == RUNNING else result
        rows[m.TRIAL_BEYOND + lane] = 1.0 if beyond else 0.0
        rows[m.TRIAL_DRIVEN + lane], rows[m.TRIAL_RESULT + lane] = driven, result
        running += 1 if result == RUNNING else 0
    return running
