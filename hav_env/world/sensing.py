"""This module senses for one HAV: itself, its goal, and its neighbours, in its own frame.

The origin of the frame is the rear axle of the HAV's truck, and "forward" points along the truck.
Policies read the world only through these functions. This is the decentralisation contract of the
paper. It also makes every policy independent of the position of the world in the plane.
"""

from hav_env.compiled import kernel
from hav_env.maths.elementary import sqrt
from hav_env.maths.geometry import into_frame, wrap
from hav_env.world.arrays import (
    ARTICULATION,
    COSINE,
    EPISODE,
    FOOTPRINT,
    HEADING,
    PHASE,
    SEED,
    SINE,
    SPEED,
    STABLE,
    STEERING,
    STEERING_COSINE,
    STEERING_SINE,
    STEP,
    World,
    X,
    Y,
    into_truck_frame,
    truck_distance,
)
from hav_env.world.bodies import front_end, nearest_on_bodies
from hav_env.world.collision import front_gap, offset_between
from hav_env.world.neighborhood import as_place
from hav_env.world.obstacles.nearest import num_obstacles, obstacle_point  # noqa: F401  sensed too
from hav_env.world.obstacles.rays import ray  # noqa: F401  likewise
from hav_env.world.other_havs import direction_of, place_of
from hav_env.world.place.guidance import route_of


@kernel
def num_trailers(world: World, agent: int, lane: int) -> int:
    """Return N_i, the number of trailers."""
    return world.fleet.num_trailers[agent, lane]


@kernel
def unit_length(world: World, agent: int, unit: int, lane: int) -> float:
    """Return l^unit [m], the length of a unit; unit 0 is the truck."""
    return world.fleet.length[agent, unit, lane]


@kernel
def stable_radius(world: World, agent: int, lane: int) -> float:
    """Return R_min [m], eq. (17)."""
    return world.fleet.radius[agent, STABLE, lane]


@kernel
def drivable_radius(world: World, agent: int, lane: int) -> float:
    """Return the radius of the tightest circle that the HAV can follow permanently [m].

    It is the larger of R_min, below which trailers may jackknife, and the smallest radius of the
    wheels, l^0 / tan(phi^max). The latter is larger for long trucks with short trailers.
    """
    cosine, sine = steering_direction(world, agent, lane)
    return max(
        stable_radius(world, agent, lane), unit_length(world, agent, 0, lane) * cosine / sine
    )


@kernel
def limits(world: World, agent: int, lane: int) -> tuple[float, float, float]:
    """Return maximum speed [m/s], steering [rad] and articulation [rad]."""
    limit = world.fleet.limit
    return limit[agent, SPEED, lane], limit[agent, STEERING, lane], limit[agent, ARTICULATION, lane]


@kernel
def steering_direction(world: World, agent: int, lane: int) -> tuple[float, float]:
    """Return cosine and sine of the maximum steering angle."""
    limit = world.fleet.limit
    return limit[agent, STEERING_COSINE, lane], limit[agent, STEERING_SINE, lane]


@kernel
def own_speed(world: World, agent: int, lane: int) -> float:
    """Return the speed in the last step [m/s]; it is 0 for a waiting HAV, unless it brakes."""
    stands = world.state.waiting[agent, lane] & (not world.rolls)
    return 0.0 if stands else world.state.speed[agent, lane]


@kernel
def own_steering(world: World, agent: int, lane: int) -> float:
    """Return the steering angle in the last step [rad], left positive.

    If wheels turn without delay, a HAV that stood has straight wheels: it may have waited, and the
    commands of waiting HAVs are void.
    """
    known = world.rolls | (own_speed(world, agent, lane) != 0.0)
    return world.state.steering[agent, lane] if known else 0.0


@kernel
def articulation(world: World, agent: int, joint: int, lane: int) -> float:
    """Return an articulation in [-pi, pi): joint 1 is the first, bending left is positive [rad]."""
    heading = world.state.heading
    return wrap(heading[agent, joint, lane] - heading[agent, joint - 1, lane])


@kernel
def articulation_direction(world: World, agent: int, joint: int, lane: int) -> tuple[float, float]:
    """Return cosine and sine of an articulation: joint 1 is the first, bending left is positive."""
    cosine, sine = world.state.cosine, world.state.sine
    return into_frame(
        cosine[agent, joint, lane],
        sine[agent, joint, lane],
        cosine[agent, joint - 1, lane],
        sine[agent, joint - 1, lane],
    )


@kernel
def goal_pose(world: World, agent: int, lane: int) -> tuple[float, float, float]:
    """Return the goal under way: forward [m], left [m], heading relative to the truck's [rad]."""
    state, goal = world.state, world.state.goal
    dx = goal[agent, X, lane] - state.x[agent, lane]
    dy = goal[agent, Y, lane] - state.y[agent, lane]
    forward, left = into_truck_frame(state, agent, lane, dx, dy)
    return forward, left, wrap(goal[agent, HEADING, lane] - state.heading[agent, 0, lane])


@kernel
def goal_direction(world: World, agent: int, lane: int) -> tuple[float, float]:
    """Return cosine and sine of the goal's heading relative to the truck's."""
    goal = world.state.goal
    cosine, sine = goal[agent, COSINE, lane], goal[agent, SINE, lane]
    return into_truck_frame(world.state, agent, lane, cosine, sine)


@kernel
def route_ahead(world: World, agent: int, lane: int) -> tuple[bool, float, float, float, float]:
    """Return the route to the goal that the guidance knows, see ``route_of``."""
    return route_of(world.guidance, agent, lane)


@kernel
def waits(world: World, agent: int, lane: int) -> bool:
    """Return whether the HAV waits at its goal, for the others or because it was its last one.

    If HAVs get next goals alone, it waits at its last goal only.
    """
    return world.state.waiting[agent, lane]


@kernel
def goals_left(world: World, agent: int, lane: int) -> int:
    """Return the number of goals that the HAV has yet to hit."""
    hit = world.state.goal[agent, PHASE, lane] + (1.0 if world.state.waiting[agent, lane] else 0.0)
    return world.goals.shape[1] - int(hit)


@kernel
def num_neighbors(world: World, agent: int, lane: int) -> int:
    """Return the number of other HAVs in sensing range."""
    return world.nearby.count[agent, lane]


@kernel
def neighbor_id(world: World, agent: int, k: int, lane: int) -> int:
    """Return the index of the HAV that is neighbour ``k``; neighbours come in ascending order."""
    return as_place(world.nearby.index[world.first + lane, agent, k])


@kernel
def neighbor_position(world: World, agent: int, k: int, lane: int) -> tuple[float, float]:
    """Return the position of the truck's rear axle of neighbour ``k``: forward [m], left [m]."""
    return place_of(world, agent, neighbor_id(world, agent, k, lane), lane)


@kernel
def neighbor_distance(world: World, agent: int, k: int, lane: int) -> float:
    """Return the distance [m] between the own truck and the truck of neighbour ``k``."""
    return truck_distance(world.state, agent, neighbor_id(world, agent, k, lane), lane)


@kernel
def neighbor_point(
    world: World, agent: int, k: int, share: float, lane: int
) -> tuple[float, float]:
    """Return the position of a point of neighbour ``k``'s truck relative to the own same point.

    The points lie a share of the truck's length ahead of its rear axle: forward [m], left [m].
    """
    dx, dy = offset_between(world, agent, neighbor_id(world, agent, k, lane), share, lane)
    return into_truck_frame(world.state, agent, lane, dx, dy)


@kernel
def neighbor_point_distance(world: World, agent: int, k: int, share: float, lane: int) -> float:
    """Return the distance [m] between these points of both trucks, see ``neighbor_point``."""
    dx, dy = offset_between(world, agent, neighbor_id(world, agent, k, lane), share, lane)
    return sqrt(dx * dx + dy * dy)


@kernel
def neighbor_heading(world: World, agent: int, k: int, unit: int, lane: int) -> float:
    """Return the heading of a unit of neighbour ``k`` relative to the own truck's [rad]."""
    other = neighbor_id(world, agent, k, lane)
    return wrap(world.state.heading[other, unit, lane] - world.state.heading[agent, 0, lane])


@kernel
def neighbor_heading_direction(world: World, agent: int, k: int, lane: int) -> tuple[float, float]:
    """Return cosine and sine of the heading of neighbour ``k`` relative to the own truck's."""
    return direction_of(world, agent, neighbor_id(world, agent, k, lane), lane)


@kernel
def neighbor_footprint(world: World, agent: int, k: int, lane: int) -> float:
    """Return the footprint radius d_h [m] of neighbour ``k``."""
    return world.fleet.radius[neighbor_id(world, agent, k, lane), FOOTPRINT, lane]


@kernel
def neighbor_length(world: World, agent: int, k: int, unit: int, lane: int) -> float:
    """Return the length [m] of a unit of neighbour ``k``."""
    return world.fleet.length[neighbor_id(world, agent, k, lane), unit, lane]


@kernel
def neighbor_trailers(world: World, agent: int, k: int, lane: int) -> int:
    """Return the number of trailers of neighbour ``k``."""
    return world.fleet.num_trailers[neighbor_id(world, agent, k, lane), lane]


@kernel
def neighbor_articulation(
    world: World, agent: int, k: int, joint: int, lane: int
) -> tuple[float, float]:
    """Return cosine and sine of an articulation of neighbour ``k``, as for the HAV itself."""
    return articulation_direction(world, neighbor_id(world, agent, k, lane), joint, lane)


@kernel
def neighbor_nearest_point(world: World, agent: int, k: int, lane: int) -> tuple[float, float]:
    """Return the nearest point of the bodies of neighbour ``k``: forward [m], left [m]."""
    state, other = world.state, neighbor_id(world, agent, k, lane)
    x, y = state.x[agent, lane], state.y[agent, lane]
    px, py = nearest_on_bodies(world.fleet.bodies, world, other, lane, x, y)
    return into_truck_frame(state, agent, lane, px - x, py - y)


@kernel
def neighbor_before_front(world: World, agent: int, k: int, lane: int) -> tuple[float, float]:
    """Return the point of the bodies of neighbour ``k`` that is nearest to the own front.

    It is relative to the own front: forward [m], left [m].
    """
    x, y = front_end(world.fleet.bodies, world, agent, lane)
    other = neighbor_id(world, agent, k, lane)
    px, py = nearest_on_bodies(world.fleet.bodies, world, other, lane, x, y)
    return into_truck_frame(world.state, agent, lane, px - x, py - y)


@kernel
def neighbor_front_gap(world: World, agent: int, k: int, lane: int) -> float:
    """Return the distance from the front of neighbour ``k`` to the own bodies [m]."""
    return front_gap(world, neighbor_id(world, agent, k, lane), agent, lane)


@kernel
def neighbor_speed(world: World, agent: int, k: int, lane: int) -> float:
    """Return the speed of neighbour ``k`` in the last step [m/s].

    It is 0 for a waiting neighbour, unless it brakes (``hav_env.vehicles.Limited``).
    """
    return own_speed(world, neighbor_id(world, agent, k, lane), lane)


@kernel
def own_footprint(world: World, agent: int, lane: int) -> float:
    """Return the footprint radius d_i [m]."""
    return world.fleet.radius[agent, FOOTPRINT, lane]


@kernel
def episode_key(world: World, lane: int) -> tuple[int, int, int]:
    """Return seed, number of the episode and step: the clock and random numbers that HAVs share."""
    clock = world.state.clock
    return clock[SEED, lane], clock[EPISODE, lane], clock[STEP, lane]
