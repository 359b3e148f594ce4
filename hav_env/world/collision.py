"""This module measures distances between HAVs: circles of footprints, reaches, gaps.

``hav_env.world.bodies`` tests whether bodies touch.
"""

from hav_env.compiled import kernel
from hav_env.maths.elementary import sqrt
from hav_env.world.arrays import FOOTPRINT
from hav_env.world.bodies import front_end, nearest_on_bodies, reach_of

# more than the rounding error of axles of chains, even 1e13 m from the origin [m]
AXLE_ROUNDING = 0.1


@kernel
def collision_distance(fleet, agent, other, lane):
    """Return d_ih = d_i + d_h [m], the sum of two footprint radii."""
    return fleet.radius[agent, FOOTPRINT, lane] + fleet.radius[other, FOOTPRINT, lane]


@kernel
def potential_collision(task, world, agent, other, lane):
    """Return whether the footprint circles of two HAVs overlap, eq. (5).

    The task may move the circles and widen them; the paper's text does not.
    """
    dx, dy = offset_between(world, agent, other, task.potential_center, lane)
    trucks = world.fleet.length[agent, 0, lane] + world.fleet.length[other, 0, lane]
    limit = collision_distance(world.fleet, agent, other, lane)
    return sqrt(dx * dx + dy * dy) <= limit + task.potential_truck_share * trucks


@kernel
def offset_between(world, agent, other, share, lane):
    """Return x and y [m] from a point of one truck to the same point of another.

    The points lie a share of the truck's length ahead of its rear axle.
    """
    state, length = world.state, world.fleet.length
    own, others = share * length[agent, 0, lane], share * length[other, 0, lane]
    dx = state.x[other, lane] - state.x[agent, lane]
    dy = state.y[other, lane] - state.y[agent, lane]
    dx += others * state.cosine[other, 0, lane] - own * state.cosine[agent, 0, lane]
    dy += others * state.sine[other, 0, lane] - own * state.sine[agent, 0, lane]
    return dx, dy


@kernel
def reach(fleet, agent, lane):
    """Return the radius [m] round the truck's rear axle that holds the whole HAV."""
    return reach_of(fleet.bodies, fleet, agent, lane)


@kernel
def circle_radius(task, fleet, agent, lane):
    """Return the radius [m] round the truck's rear axle that holds its circle of the task."""
    share = task.potential_center + task.potential_truck_share
    return fleet.radius[agent, FOOTPRINT, lane] + share * fleet.length[agent, 0, lane]


@kernel
def squared_distance(world, agent, other, lane):
    """Return the squared distance [m^2] between the rear axles of two trucks."""
    dx = world.state.x[other, lane] - world.state.x[agent, lane]
    dy = world.state.y[other, lane] - world.state.y[agent, lane]
    return dx * dx + dy * dy


@kernel
def within(squared, limit):
    """Return whether a distance, given its square [m^2], is at most a limit [m], at least 0."""
    return squared <= limit * limit


@kernel
def front_gap(world, agent, other, lane):
    """Return the distance [m] from the front of a truck to the bodies of another HAV."""
    x, y = front_end(world.fleet.bodies, world, agent, lane)
    px, py = nearest_on_bodies(world.fleet.bodies, world, other, lane, x, y)
    return sqrt((px - x) * (px - x) + (py - y) * (py - y))
