"""What one HAV can know: itself, its goal, and its neighbours, in its own frame.

The frame's origin is the rear axle of the HAV's truck, and "forward" is along the truck. Policies
read the world through these functions alone: that is the decentralisation contract of the paper,
and it makes every policy indifferent to where in the plane the world lies.
"""

from hav_env.compiled import world_kernel
from hav_env.geometry import into_frame, wrap
from hav_env.world import (
    ARTICULATION,
    EPISODE,
    FOOTPRINT,
    PHASE,
    SEED,
    SPEED,
    STABLE,
    STEERING,
    STEERING_COSINE,
    STEERING_SINE,
    STEP,
    truck_distance,
)


@world_kernel
def num_trailers(world, agent):
    """Return N_i."""
    return world.fleet.num_trailers[agent]


@world_kernel
def unit_length(world, agent, unit):
    """Return l^unit [m]; unit 0 is the truck."""
    return world.fleet.length[agent, unit]


@world_kernel
def stable_radius(world, agent):
    """Return R_min [m], eq. (rmin)."""
    return world.fleet.radius[agent, STABLE]


@world_kernel
def limits(world, agent):
    """Return maximum speed [m/s], steering [rad] and articulation [rad]."""
    limit = world.fleet.limit
    return limit[agent, SPEED], limit[agent, STEERING], limit[agent, ARTICULATION]


@world_kernel
def steering_direction(world, agent):
    """Return cosine and sine of the maximum steering angle."""
    return world.fleet.limit[agent, STEERING_COSINE], world.fleet.limit[agent, STEERING_SINE]


@world_kernel
def articulation_cosine(world, agent, joint):
    """Return the cosine of the articulation of trailer ``joint`` (1 is the first)."""
    cosine, sine = world.state.cosine, world.state.sine
    ahead = joint - 1
    return cosine[agent, joint] * cosine[agent, ahead] + sine[agent, joint] * sine[agent, ahead]


@world_kernel
def articulation_sine(world, agent, joint):
    """Return the sine of the articulation of trailer ``joint``: positive when it bends left."""
    cosine, sine = world.state.cosine, world.state.sine
    ahead = joint - 1
    return sine[agent, joint] * cosine[agent, ahead] - cosine[agent, joint] * sine[agent, ahead]


@world_kernel
def goal_pose(world, agent):
    """Return the goal under way: forward [m], left [m], heading relative to the truck's [rad]."""
    state, goals, phase = world.state, world.goals, world.state.clock[PHASE]
    forward, left = into_frame(
        goals[agent, phase, 0] - state.x[agent],
        goals[agent, phase, 1] - state.y[agent],
        state.cosine[agent, 0],
        state.sine[agent, 0],
    )
    return forward, left, wrap(goals[agent, phase, 2] - state.heading[agent, 0])


@world_kernel
def num_neighbors(world, agent):
    """Return how many other HAVs are in sensing range."""
    return world.nearby.count[agent]


@world_kernel
def neighbor_id(world, agent, k):
    """Return the number of the HAV that is neighbour ``k``; neighbours come in ascending order."""
    return world.nearby.index[agent, k]


@world_kernel
def neighbor_position(world, agent, k):
    """Return where the truck's rear axle of neighbour ``k`` is: forward [m], left [m]."""
    state, other = world.state, world.nearby.index[agent, k]
    return into_frame(
        state.x[other] - state.x[agent],
        state.y[other] - state.y[agent],
        state.cosine[agent, 0],
        state.sine[agent, 0],
    )


@world_kernel
def neighbor_distance(world, agent, k):
    """Return the distance [m] from truck to truck of neighbour ``k``."""
    return truck_distance(world.state, agent, world.nearby.index[agent, k])


@world_kernel
def neighbor_heading(world, agent, k, unit):
    """Return the heading of a unit of neighbour ``k`` relative to the own truck's [rad]."""
    other = world.nearby.index[agent, k]
    return wrap(world.state.heading[other, unit] - world.state.heading[agent, 0])


@world_kernel
def neighbor_footprint(world, agent, k):
    """Return the footprint radius d_h [m] of neighbour ``k``."""
    return world.fleet.radius[world.nearby.index[agent, k], FOOTPRINT]


@world_kernel
def neighbor_length(world, agent, k, unit):
    """Return the length [m] of a unit of neighbour ``k``."""
    return world.fleet.length[world.nearby.index[agent, k], unit]


@world_kernel
def own_footprint(world, agent):
    """Return the footprint radius d_i [m]."""
    return world.fleet.radius[agent, FOOTPRINT]


@world_kernel
def episode_key(world):
    """Return seed, number of the episode and step: the clock and dice that all HAVs share."""
    clock = world.state.clock
    return clock[SEED], clock[EPISODE], clock[STEP]
