"""This package writes observations: what a HAV senses as one flat row of named columns.

Everything is in the HAV's own frame. Lengths of units are in [0, 10], all else is in [-1, 1].
docs/environments.md has the table of the columns, and says how to add one.
"""

from hav_env.compiled import kernel
from hav_env.observation.columns import Column
from hav_env.observation.layout import (
    FIRST_OF_ROUTE,
    FIRST_OF_UNITS,
    Observation,
    check_observation,
    first_of_neighbors,
    list_columns,
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
    "Column",
    "Observation",
    "check_observation",
    "list_columns",
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
        world: a block.
        agent: which HAV.
        route: (N, ROUTE_SIZE, W) as ``plan_route`` left it.
        columns: (D, W) to be written, in the order of ``list_columns``.
    """
    observe_route(world, agent, route, columns, FIRST_OF_ROUTE)
    observe_itself(world, agent, columns, FIRST_OF_UNITS)
    if observation.neighbors > 0:
        first = first_of_neighbors(world.state.heading.shape[1] - 1)
        observe_neighbors(observation, world, agent, columns, first)
