"""This module declares the arrays of a batch of worlds: states, fleets, records.

Shapes: N HAVs of a world, U units of a HAV (unit 0 is the truck; padded), G goals of a HAV, W
worlds. The world is the last axis, the "lane". Kernels loop over HAVs and units outside and over
lanes inside, where one instruction works on several worlds. ``World`` is the type of a whole batch
and of a block of its lanes. Quantities that belong together share an array: every array is one more
argument of every kernel.
"""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from hav_env.compiled import kernel
from hav_env.maths.elementary import sincos, sqrt
from hav_env.maths.geometry import into_frame
from hav_env.world.place.guidance import Dubins, allocate_guidance
from hav_env.world.place.segments import allocate_place
from hav_env.world.units.joints import hitch_offset, hitch_on_axles, least_squared_radius
from hav_env.world.units.outlines import find_reach, shape_as_usual
from hav_env.world.units.parts import Array, Lines, allocate_bodies, allocate_joints, arrays_in


class State(NamedTuple):
    """The state of the worlds, which changes from step to step."""

    x: Array  # (N, W) truck's rear axle [m]
    y: Array  # (N, W)
    heading: Array  # (N, U, W) of every unit [rad], not wrapped, so it counts full turns
    cosine: Array  # (N, U, W) cosine of the heading, stored because most rules need it
    sine: Array  # (N, U, W) sine of the heading
    speed: Array  # (N, W) v^0 of the truck [m/s] in the last step
    steering: Array  # (N, W) phi of the truck [rad] in the last step
    ahead: Array  # (3, W) scratch: the unit ahead while the units of a HAV move one by one
    goal: Array  # (N, 7, W) the goal under way, columns X .. PHASE
    waiting: Array  # (N, W) bool: at its goal until it gets the next one: it stands, or brakes
    clock: Array  # (3, W) columns STEP .. EPISODE


AHEAD_SPEED, AHEAD_COSINE, AHEAD_SINE = range(3)
UNIT_FRONT_X, UNIT_FRONT_Y = range(2)  # while boxes are found: front end of a unit [m]
# of a goal: pose [m, m, rad], its direction; its distance [m]; its index among the HAV's goals
X, Y, HEADING, COSINE, SINE, DISTANCE, PHASE = range(7)
STEP, SEED, EPISODE = range(3)  # steps done; the key of the episode


class Fleet(NamedTuple):
    """The dimensions and the limits of the HAVs."""

    num_trailers: Array  # (N, W)
    length: Array  # (N, U, W) wheelbase l^0, trailer lengths l^j [m], inf beyond the last
    radius: Array  # (N, 2, W) columns FOOTPRINT, STABLE [m]
    limit: Array  # (N, 5, W) columns SPEED [m/s], STEERING, ARTICULATION [rad], STEERING_COSINE ..
    joints: Any  # OnAxles or Hitches, see hav_env.world.units.parts
    bodies: Any  # Lines or Outlines


FOOTPRINT, STABLE = range(2)  # d_i, the sum of the trailers' lengths; R_min, eq. (17)
SPEED, STEERING, ARTICULATION, STEERING_COSINE, STEERING_SINE = range(5)


FEW = 16  # HAVs up to which comparing all pairs is faster than a grid
# HAVs up to which comparing all pairs in every step is faster than keeping a list of candidates.
# Rollouts of 2 take 0.9 of the time and those of 6 in a yard 0.8; those of 5 or 8 at the paper's
# density take as long with a list, those of 10 would take 1.25 times as long
HANDFUL = 8


class Nearby(NamedTuple):
    """Neighbours of each HAV within sensing range, found anew after every step.

    Only pairs of HAVs on a list of candidates can be neighbours, see
    ``hav_env.world.neighborhood``. The world is the first axis of arrays that a kernel searches or
    fills for one world alone.
    """

    count: Array  # (N, W)
    index: Array  # (W, N, N - 1) int16, in ascending order
    circle: Array  # (N, 3, W) columns CENTER_X .. RADIUS [m] of the list; empty in small worlds
    num_pairs: Array  # (W,) on the list; in small worlds scratch: a bit for each pair, then 0
    pair: Array  # (W, N (N - 1) / 2, 3) int16: the list in ascending order, columns LOWER .. CLOSE
    grid: Array  # (W, 4, B) scratch of the search, rows COLUMN .. BUCKET; empty in small swarms
    were: Array  # (N, 2 + 2 U, W) x and y of the axles before the step; empty if not needed
    box: Array  # (N, 4, W) columns BOX_LEFT .. BOX_HIGH [m]: round HAVs that may touch others


BOX_LEFT, BOX_RIGHT, BOX_LOW, BOX_HIGH = range(4)
CENTER_X, CENTER_Y, RADIUS = range(3)
# the two HAVs; 1 if they are near enough that they may touch, else 0
LOWER, HIGHER, CLOSE = range(3)
COLUMN, ROW, NEXT, BUCKET = range(4)  # cell of a HAV; next HAV in its bucket; first in a bucket


class Record(NamedTuple):
    """Events of each HAV since the episode began."""

    first: Array  # (N, E, 2, W) rows EVENT_ROWS: WHEN (step) and WHERE (joint or partner)
    total: Array  # (N, 5, W) columns LARGEST .. INTERVENTIONS
    goal: Array  # (N, G, 6, W) columns HIT_STEP .. CLOSEST
    miss: Array  # (N, G, 2, 3 + U - 1, W) HEADING_MISS, EUCLIDEAN_MISS: MISS_COUNT ..


NEVER = -1
# see hav_env.world.event_table; a plane without obstacles has no last row
EVENT_ROWS = JACKKNIFE, POTENTIAL, ACTUAL, OBSTACLE = tuple(range(4))
WHEN, WHERE = range(2)
# largest articulation [rad], not wrapped: beyond pi the HAV folded through; driven path [m]; steps
# in which it did not wait; 1.0 once it was removed; steps that a safety filter changed
LARGEST, PATH, MOVED, REMOVED, INTERVENTIONS = range(5)
# at the hit: step, distance [m], absolute heading difference [rad], path driven since the episode
# began [m]; Dubins length with R_min at the assignment of the goal, least distance so far [m]
HIT_STEP, HIT_DISTANCE, HIT_HEADING, HIT_PATH, DUBINS, CLOSEST = range(6)
HEADING_MISS, EUCLIDEAN_MISS = range(2)
# number of steps in the close miss; at the narrowest one: distance [m], absolute heading difference
# [rad] and from column MISS_ARTICULATION on all articulations [rad]
MISS_COUNT, MISS_DISTANCE, MISS_HEADING, MISS_ARTICULATION = range(4)


class World(NamedTuple):
    """All arrays of a batch, or of a block of its lanes."""

    state: State
    fleet: Fleet
    goals: Array  # (N, G, 3, W) goal poses: x [m], y [m], heading [rad]
    nearby: Nearby
    record: Record
    place: Any  # Plane or Obstacles, see hav_env.world.place.segments
    guidance: Any  # Dubins, or routes, see hav_env.world.place.guidance
    first: int  # index of lane 0 among the worlds of the batch
    lanes: int  # number of worlds from lane 0 on
    units: int  # number of units of a HAV up to which loops run
    rolls: bool  # waiting HAVs may roll on until they have come to rest


def allocate_worlds(
    num_worlds: int,
    num_havs: int,
    num_units: int,
    num_goals: int,
    continuous: bool = False,
    rolls: bool = False,
    hitched: bool = False,
    bodies: Any = Lines(),  # a NamedTuple is immutable
    num_segments: int = 0,
    guidance: Any = Dubins(),
    zeros: Callable[..., np.ndarray] = np.zeros,
) -> World:
    """Return the arrays of a batch.

    Until a scenario fills them, HAVs wait far from each other, which makes steps cheap.

    Args:
        num_worlds: Number of worlds W.
        num_havs: Number of HAVs N.
        num_units: Number of units U.
        num_goals: Number of goals G.
        continuous: Whether kernels look for collisions between steps.
        rolls: Whether waiting HAVs may roll on.
        hitched: Whether hitches may lie off the axles.
        bodies: Model of the bodies.
        num_segments: Largest number of obstacle segments S.
        guidance: Guidance without arrays for HAVs.
        zeros: Function that makes each array from its shape and type.
    """
    n, u, g, w = num_havs, num_units, num_goals, num_worlds
    events = len(EVENT_ROWS) if num_segments > 0 else OBSTACLE
    buckets = 1 << (2 * n - 1).bit_length()  # a power of two, at least twice the HAVs
    num_pairs = n * (n - 1) // 2

    def real(*shape: int) -> np.ndarray:
        return zeros((*shape, w), np.float64)

    def whole(*shape: int) -> np.ndarray:
        return zeros((*shape, w), np.int64)

    zero = real(n)
    far_apart = zero + (1e6 * np.arange(n)[:, None]).astype(zero.dtype)  # [m]
    waiting = np.ones((n, w), np.bool_)
    return World(
        State(
            *(far_apart, real(n), real(n, u), real(n, u), real(n, u), real(n), real(n)),
            *(real(3), real(n, 7), waiting, whole(3)),
        ),
        Fleet(
            whole(n),
            *(real(n, u) + 1.0, real(n, 2) + 1.0, real(n, 5) + 1.0),
            allocate_joints(hitched, (n, u, w), zeros),
            allocate_bodies(bodies, (n, u, w), zeros),
        ),
        real(n, g, 3),
        Nearby(
            *(whole(n), zeros((w, n, n - 1), np.int16)),
            *(real(n if n > HANDFUL else 0, 3), whole()),
            zeros((w, num_pairs, 3), np.int16),
            zeros((w, 4, buckets if n > FEW else 0), np.int64),
            real(n, 2 + 2 * u if continuous else 0),
            real(n if n > 1 else 0, 4),
        ),
        Record(whole(n, events, 2), real(n, 5), real(n, g, 6), real(n, g, 2, 3 + u - 1)),
        allocate_place(num_segments, (n, u, w), zeros),
        allocate_guidance(guidance, (n, w), zeros),
        *(0, num_worlds, num_units, rolls),
    )


def world_size(*shape: Any) -> int:
    """Return the number of bytes of the arrays of one world, without allocating them.

    Args:
        *shape: Arguments of ``allocate_worlds`` from the number of HAVs on.
    """

    def unbacked(shape: tuple[int, ...], kind: type) -> np.ndarray:
        return np.broadcast_to(kind(0), shape)

    allocate = functools.partial(allocate_worlds, zeros=unbacked)
    return sum(array.nbytes for array in arrays_in(allocate(1, *shape)))


@kernel
def turn_unit(state, agent, unit, lane, heading):
    """Set the heading [rad] of a unit; return its cosine and sine, which are stored with it."""
    sine, cosine = sincos(heading)
    state.heading[agent, unit, lane] = heading
    state.cosine[agent, unit, lane] = cosine
    state.sine[agent, unit, lane] = sine
    return cosine, sine


@kernel
def put_straight(state, agent, lane, x, y, heading):
    """Put a HAV at a pose without articulation: every unit has the truck's heading [rad]."""
    state.x[agent, lane] = x
    state.y[agent, lane] = y
    for unit in range(state.heading.shape[1]):
        turn_unit(state, agent, unit, lane, heading)


@kernel
def derive_radii(fleet, agent, lane, truck_share):
    """Set the footprint radius d_i and R_min from a HAV's lengths and hitches.

    d_i is the distance from the truck's rear axle to the end of the last trailer of a straight HAV,
    sum_j l^j if all are hitched on axles. A share of the truck's length is added (0 in the paper).
    A hitch ahead of an axle counts as a path there and back.

    If all are hitched on axles, R_min = sqrt(sum_j (l^j)^2) over the truck and all trailers, eq.
    (rmin).
    """
    truck = fleet.length[agent, 0, lane]
    footprint = truck_share * truck + abs(hitch_offset(fleet.joints, agent, 0, lane))
    for unit in range(1, fleet.num_trailers[agent, lane] + 1):
        offset = hitch_offset(fleet.joints, agent, unit, lane)
        footprint += abs(fleet.length[agent, unit, lane] + offset)
    fleet.radius[agent, FOOTPRINT, lane] = footprint
    squares = least_squared_radius(fleet.joints, fleet, agent, lane)
    fleet.radius[agent, STABLE, lane] = sqrt(squares)
    find_reach(fleet.bodies, fleet, agent, lane)


@kernel
def set_limits(scenario, fleet, agent, lane):
    """Set the limits of a HAV to the scenario's, with on-axle hitches and the default bodies."""
    sine, cosine = sincos(scenario.steering_max)
    fleet.limit[agent, SPEED, lane] = scenario.speed_max
    fleet.limit[agent, STEERING, lane] = scenario.steering_max
    fleet.limit[agent, ARTICULATION, lane] = scenario.articulation_max
    fleet.limit[agent, STEERING_COSINE, lane] = cosine
    fleet.limit[agent, STEERING_SINE, lane] = sine
    hitch_on_axles(fleet.joints, agent, lane, scenario.articulation_max)
    shape_as_usual(fleet.bodies, agent, lane)


@kernel
def into_truck_frame(state, agent, lane, dx, dy):
    """Rotate a difference of positions [m], or a direction, into a truck's frame: forward, left."""
    return into_frame(dx, dy, state.cosine[agent, 0, lane], state.sine[agent, 0, lane])


@kernel
def goal_under_way(state, agent, lane):
    """Return the index of the goal that a HAV drives to, or waits at, from 0."""
    return int(state.goal[agent, PHASE, lane])


@kernel
def is_removed(world, agent, lane):
    """Return whether a HAV was removed from its world; in Python, slices select several."""
    return world.record.total[agent, REMOVED, lane] != 0.0


@kernel
def truck_distance(state, agent, other, lane):
    """Return the distance [m] between the rear axles of two trucks."""
    dx = state.x[other, lane] - state.x[agent, lane]
    dy = state.y[other, lane] - state.y[agent, lane]
    return sqrt(dx * dx + dy * dy)
