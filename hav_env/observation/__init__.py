"""Sensing written as one flat row of named columns: what a learner sees of its HAV.

Everything is in the HAV's own frame and in [-1, 1], lengths of units apart, which are in [0, 10].
docs/environments.md has the table of the columns.
"""

from hav_env.compiled import kernel
from hav_env.observation.layout import (
    Observation,
    bounds_of,
    check_observation,
    name_columns,
    settle,
)
from hav_env.observation.neighbors import observe_neighbors
from hav_env.observation.own import observe_itself
from hav_env.observation.route import (
    LENGTH,
    ROUTE_SIZE,
    TO_APPROACH,
    TO_GOAL,
    observe_route,
    plan_route,
)

__all__ = [
    "LENGTH",
    "ROUTE_SIZE",
    "TO_APPROACH",
    "TO_GOAL",
    "Observation",
    "bounds_of",
    "check_observation",
    "name_columns",
    "observe",
    "plan_route",
    "settle",
]


@kernel
def observe(observation, world, agent, route, columns):
    """Write what a HAV sees in every lane of a block of worlds.

    Args:
        observation: settled for the number of HAVs.
        world, agent: a block; which HAV.
        route: (N, ROUTE_SIZE, W) as ``plan_route`` left it.
        columns: (D, W) to be written, in the order of ``name_columns``.
    """
    observe_route(world, agent, route, columns)
    observe_itself(world, agent, columns)
    if observation.neighbors > 0:
        observe_neighbors(observation, world, agent, columns)
