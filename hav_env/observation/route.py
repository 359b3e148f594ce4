"""The Dubins paths that lie ahead of a HAV."""

from hav_env.compiled import fixed, kernel
from hav_env.dubins import shortest_path_towards, turns
from hav_env.observation.layout import PATHS, scale_distance
from hav_env.sensing import goal_direction, goal_pose, stable_radius, unit_length

# of a path: side of its first segment, length of that segment and of the whole path [m]
TURN, FIRST, LENGTH = range(3)
TO_GOAL, TO_APPROACH, ROUTE_SIZE = 0, 3, 6


@kernel
def plan_route(world, agent, route, remaining):
    """Find the shortest Dubins paths to the goal and to the approach point, with radius R_min.

    Args:
        world, agent: a block; which HAV.
        route: (N, ROUTE_SIZE, W), of which row ``agent`` is written in every lane of the block.
        remaining: (N, W), the length of the path to the goal [m], likewise.
    """
    for place in range(2):
        to = fixed(TO_APPROACH * place)
        for lane in range(world.lanes):
            before = place * unit_length(world, agent, 0, lane)
            forward, left, heading = goal_pose(world, agent, lane)
            cosine, sine = goal_direction(world, agent, lane)
            word, first, second, third = shortest_path_towards(
                forward - before * cosine,
                left - before * sine,
                heading,
                cosine,
                sine,
                stable_radius(world, agent, lane),
            )
            side, _, _ = turns(word)
            route[agent, to + TURN, lane] = side
            route[agent, to + FIRST, lane] = first
            route[agent, to + LENGTH, lane] = first + second + third
    for lane in range(world.lanes):
        remaining[agent, lane] = route[agent, TO_GOAL + LENGTH, lane]


@kernel
def observe_route(world, agent, route, columns):
    """Write the columns of both paths."""
    for place in range(2):
        to = fixed(TO_APPROACH * place)
        for lane in range(world.lanes):
            columns[PATHS + to + TURN, lane] = route[agent, to + TURN, lane]
            columns[PATHS + to + FIRST, lane] = scale_distance(route[agent, to + FIRST, lane])
            columns[PATHS + to + LENGTH, lane] = scale_distance(route[agent, to + LENGTH, lane])
