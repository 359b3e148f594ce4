"""This module predicts the chain of a HAV along a route, and measures the arcs that it can drive.

The prediction takes Euler steps of ``OnAxle()`` at full speed, in the truck's frame. It writes to
scratch arrays, not to the state.
"""

from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import TWO_PI, into_frame
from hav_env.world.arrays import ARTICULATION, SPEED
from hav_env.world.sensing import drivable_radius

NUM_RADII = 6  # of arcs, from the truck's tightest to one that all trailers can drive for good
MOST_CANDIDATES = 32  # candidates in a sorted list
WIDEST_SHARE = 1.001  # times the radius that trailers can drive for good
_ROUGH = 2.0  # steps of the simulator in one step of the measurement of arcs
_LONGER = 1.1  # times the measured arc: a chain that is bent to the other side drives more

# scratch of a world: radii; the longest arcs [rad] of the chain as it is, to the left and to the
# right, and of a straight chain; lengths [m] and numbers of candidates; then cosine and sine of
# each unit
AT_RADII, AT_LEFT, AT_RIGHT, AT_LAST = range(0, 4 * NUM_RADII, NUM_RADII)
AT_LENGTHS, AT_NUMBERS = 4 * NUM_RADII, 4 * NUM_RADII + MOST_CANDIDATES
AT_CHAIN = 4 * NUM_RADII + 2 * MOST_CANDIDATES


def planning_rows(units: int) -> int:
    """Return the number of scratch rows that planning needs for HAVs with this number of units."""
    return AT_CHAIN + 2 * units


@kernel
def step_length(guidance, world, agent, lane):
    """Return the distance that a truck drives in a step at full speed [m]."""
    return guidance.step * world.fleet.limit[agent, SPEED, lane]


@kernel
def bend_bound(guidance, world, agent, lane):
    """Return the least permitted cosine of an articulation: of its limit minus the margin."""
    limit = min(world.fleet.limit[agent, ARTICULATION, lane], 0.25 * TWO_PI)
    _, cosine = sincos(max(limit - guidance.margin, 0.0))
    return cosine


@rare_kernel
def put_chain(guidance, world, agent, lane, straight):
    """Write the chain to scratch in the truck's frame, in its current shape or straight."""
    rows, state = guidance.scratch, world.state
    for unit in range(world.fleet.num_trailers[agent, lane] + 1):
        cosine, sine = into_frame(
            state.cosine[agent, unit, lane],
            state.sine[agent, unit, lane],
            state.cosine[agent, 0, lane],
            state.sine[agent, 0, lane],
        )
        rows[AT_CHAIN + 2 * unit, lane] = 1.0 if straight else cosine
        rows[AT_CHAIN + 2 * unit + 1, lane] = 0.0 if straight else sine


@rare_kernel
def pull_chain(guidance, world, agent, lane, turn, distance):
    """Move the chain by one Euler step: the truck turns, then drives; the trailers follow.

    Returns:
        The least cosine of an articulation, and the least cosine of a unit's heading minus the
        truck's heading.
    """
    rows = guidance.scratch
    sine, cosine = sincos(turn)
    before_cosine, before_sine = rows[AT_CHAIN, lane], rows[AT_CHAIN + 1, lane]
    ahead_cosine = before_cosine * cosine - before_sine * sine
    ahead_sine = before_sine * cosine + before_cosine * sine
    rows[AT_CHAIN, lane], rows[AT_CHAIN + 1, lane] = ahead_cosine, ahead_sine
    truck_cosine, truck_sine = ahead_cosine, ahead_sine
    pull, least, spread = distance, 1.0, 1.0
    for unit in range(1, world.fleet.num_trailers[agent, lane] + 1):
        at = AT_CHAIN + 2 * unit
        before_cosine, before_sine = rows[at, lane], rows[at + 1, lane]
        _, bend = into_frame(ahead_cosine, ahead_sine, before_cosine, before_sine)
        sine, cosine = sincos(pull * bend / world.fleet.length[agent, unit, lane])
        own_cosine = before_cosine * cosine - before_sine * sine
        own_sine = before_sine * cosine + before_cosine * sine
        rows[at, lane], rows[at + 1, lane] = own_cosine, own_sine
        straightness = own_cosine * ahead_cosine + own_sine * ahead_sine
        least = min(least, straightness)
        spread = min(spread, own_cosine * truck_cosine + own_sine * truck_sine)
        pull, ahead_cosine, ahead_sine = pull * straightness, own_cosine, own_sine
    return least, spread


@rare_kernel
def measure_arcs_of(guidance, world, agent, lane, tightest):
    """Write the radii, evenly spaced in curvature, and the longest arcs that the chain can drive.

    The measurement takes coarse steps, up to a whole turn.
    """
    rows = guidance.scratch
    widest = WIDEST_SHARE * drivable_radius(world, agent, lane)
    for number in range(NUM_RADII):
        share = number / (NUM_RADII - 1.0)
        radius = 1.0 / ((1.0 - share) / tightest + share / widest)
        rows[AT_RADII + number, lane] = radius
        rows[AT_LEFT + number, lane] = _longest_arc(guidance, world, agent, lane, radius, False)
        rows[AT_RIGHT + number, lane] = _longest_arc(guidance, world, agent, lane, -radius, False)
        rows[AT_LAST + number, lane] = _longest_arc(guidance, world, agent, lane, radius, True)


@rare_kernel
def _longest_arc(guidance, world, agent, lane, radius, straight):
    """Return the angle that a chain can turn on a circle [rad]; a negative radius turns right."""
    distance = _ROUGH * step_length(guidance, world, agent, lane)
    turn, bound = distance / radius, bend_bound(guidance, world, agent, lane)
    put_chain(guidance, world, agent, lane, straight)
    turned = 0.0
    while turned < TWO_PI:
        least, _ = pull_chain(guidance, world, agent, lane, turn, distance)
        if least < bound:
            return _LONGER * turned
        turned += abs(turn)
    return TWO_PI
