"""The arrays that a batch of worlds consists of, and the view of one world.

Shapes: N HAVs of a world, U units of a HAV (unit 0 is the truck; padded), G goals of a HAV, W
worlds; the world is the last axis. ``World`` names both the whole batch (arrays as commented) and
the view of one world (the same without the last axis), which is what kernels work on.

Quantities that belong together share an array and have named columns: every array is one more
argument of every kernel, and compiling and calling slow down with their number.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from hav_env.compiled import kernel, world_kernel

Array = Any  # np.ndarray


class State(NamedTuple):
    """What changes from step to step."""

    x: Array  # (N, W) truck's rear axle [m]
    y: Array  # (N, W)
    heading: Array  # (N, U, W) of every unit [rad], not wrapped, so that full turns show
    cosine: Array  # (N, U, W) of the heading, kept with it: most rules need it
    sine: Array  # (N, U, W)
    waiting: Array  # (N, W) bool: at its goal, maximum speed zero until all are
    clock: Array  # (4, W) columns STEP .. EPISODE


STEP, PHASE, SEED, EPISODE = range(4)  # steps done; goal under way; the key of the episode


class Fleet(NamedTuple):
    """What a HAV is: lengths and limits."""

    num_trailers: Array  # (N, W)
    length: Array  # (N, U, W) wheelbase l^0 and trailer lengths l^j [m], 1 beyond the last
    radius: Array  # (N, 2, W) columns FOOTPRINT, STABLE [m]
    limit: Array  # (N, 5, W) columns SPEED [m/s], STEERING, ARTICULATION [rad], STEERING_COSINE ..


FOOTPRINT, STABLE = range(2)  # d_i, the sum of the trailers' lengths; R_min, eq. (rmin)
SPEED, STEERING, ARTICULATION, STEERING_COSINE, STEERING_SINE = range(5)


class Nearby(NamedTuple):
    """Who is within sensing range of whom, found anew after every step."""

    count: Array  # (N, W)
    index: Array  # (N, N - 1, W) in ascending order
    grid: Array  # (4, B, W) scratch of the search, rows COLUMN .. BUCKET


COLUMN, ROW, NEXT, BUCKET = range(4)  # cell of a HAV; next HAV in its bucket; first in a bucket


class Record(NamedTuple):
    """What has happened to each HAV since the episode began."""

    first: Array  # (N, 3, 2, W) JACKKNIFE .. ACTUAL: WHEN (step) and WHERE (joint or partner)
    total: Array  # (N, 3, W) columns LARGEST .. MOVED
    goal: Array  # (N, G, 6, W) columns HIT_STEP .. CLOSEST
    miss: Array  # (N, G, 2, 3 + U - 1, W) HEADING_MISS, EUCLIDEAN_MISS: MISS_COUNT ..


NEVER = -1
JACKKNIFE, POTENTIAL, ACTUAL = range(3)
WHEN, WHERE = range(2)
# largest articulation [rad], not wrapped: beyond pi the HAV folded through; driven path [m];
# steps in which the HAV was not waiting
LARGEST, PATH, MOVED = range(3)
# at the hit: step, distance [m], absolute heading difference [rad], path driven since the episode
# began [m]; Dubins length with R_min from where the goal was assigned, least distance so far [m]
HIT_STEP, HIT_DISTANCE, HIT_HEADING, HIT_PATH, DUBINS, CLOSEST = range(6)
HEADING_MISS, EUCLIDEAN_MISS = range(2)
# steps in such a close miss; at the narrowest one: distance [m], absolute heading difference [rad]
# and from column MISS_ARTICULATION on all articulations [rad]
MISS_COUNT, MISS_DISTANCE, MISS_HEADING, MISS_ARTICULATION = range(4)


class World(NamedTuple):
    """All arrays of a batch, or the views of one of its worlds."""

    state: State
    fleet: Fleet
    goals: Array  # (N, G, 3, W) goal poses: x [m], y [m], heading [rad]
    nearby: Nearby
    record: Record


def allocate_worlds(num_worlds: int, num_havs: int, num_units: int, num_goals: int) -> World:
    """Return the arrays of a batch, zeroed; a scenario fills them."""
    n, u, g, w = num_havs, num_units, num_goals, num_worlds
    buckets = 1 << (2 * n - 1).bit_length()  # a power of two, at least twice the HAVs

    def real(*shape: int) -> np.ndarray:
        return np.zeros((*shape, w))

    def whole(*shape: int) -> np.ndarray:
        return np.zeros((*shape, w), np.int64)

    waiting = np.zeros((n, w), np.bool_)
    return World(
        State(real(n), real(n), real(n, u), real(n, u), real(n, u), waiting, whole(4)),
        Fleet(whole(n), real(n, u), real(n, 2), real(n, 5)),
        real(n, g, 3),
        Nearby(whole(n), whole(n, n - 1), whole(4, buckets)),
        Record(whole(n, 3, 2), real(n, 3), real(n, g, 6), real(n, g, 2, 3 + u - 1)),
    )


@world_kernel
def world_at(worlds, w):
    """Return the view of world ``w`` of a batch."""
    state, fleet, nearby, record = worlds.state, worlds.fleet, worlds.nearby, worlds.record
    return World(
        State(
            state.x[:, w],
            state.y[:, w],
            state.heading[:, :, w],
            state.cosine[:, :, w],
            state.sine[:, :, w],
            state.waiting[:, w],
            state.clock[:, w],
        ),
        Fleet(
            fleet.num_trailers[:, w],
            fleet.length[:, :, w],
            fleet.radius[:, :, w],
            fleet.limit[:, :, w],
        ),
        worlds.goals[:, :, :, w],
        Nearby(nearby.count[:, w], nearby.index[:, :, w], nearby.grid[:, :, w]),
        Record(
            record.first[:, :, :, w],
            record.total[:, :, w],
            record.goal[:, :, :, w],
            record.miss[:, :, :, :, w],
        ),
    )


@world_kernel
def turn_unit(state, agent, unit, heading):
    """Give a unit a heading [rad], with its cosine and sine."""
    state.heading[agent, unit] = heading
    state.cosine[agent, unit] = math.cos(heading)
    state.sine[agent, unit] = math.sin(heading)


@world_kernel
def put_straight(state, agent, x, y, heading):
    """Put a HAV somewhere without articulation: every unit has the truck's heading [rad]."""
    state.x[agent] = x
    state.y[agent] = y
    for unit in range(state.heading.shape[1]):
        turn_unit(state, agent, unit, heading)


@kernel
def derive_radii(fleet, agent, truck_share):
    """Set what follows from a HAV's lengths: footprint radius d_i and minimal stable radius R_min.

    d_i = sum_j l^j over the trailers, plus a share of the truck's length (the paper's is 0).

    R_min = sqrt(sum_j (l^j)^2) over the truck and all trailers, eq. (rmin).
    """
    truck = fleet.length[agent, 0]
    footprint, squares = truck_share * truck, truck * truck
    for unit in range(1, fleet.num_trailers[agent] + 1):
        length = fleet.length[agent, unit]
        footprint += length
        squares += length * length
    fleet.radius[agent, FOOTPRINT] = footprint
    fleet.radius[agent, STABLE] = math.sqrt(squares)


@kernel
def set_limits(fleet, agent, speed, steering, articulation):
    """Set the limits of a HAV [m/s, rad, rad]."""
    fleet.limit[agent, SPEED] = speed
    fleet.limit[agent, STEERING] = steering
    fleet.limit[agent, ARTICULATION] = articulation
    fleet.limit[agent, STEERING_COSINE] = math.cos(steering)
    fleet.limit[agent, STEERING_SINE] = math.sin(steering)


@world_kernel
def truck_distance(state, agent, other):
    """Return the distance [m] between the rear axles of two trucks."""
    dx = state.x[other] - state.x[agent]
    dy = state.y[other] - state.y[agent]
    return math.sqrt(dx * dx + dy * dy)
