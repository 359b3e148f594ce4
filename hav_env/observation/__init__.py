"""This package writes observations: the sensing of a HAV as one flat row of named columns.

Everything is in the HAV's own frame. Lengths of units are in [0, 10], all else is in [-1, 1].
docs/environments.md has the table of the columns, and says how to add one.
"""

from hav_env.compiled import kernel
from hav_env.observation.columns import Column
from hav_env.observation.layout import (
    FIRST_OF_ROUTE,
    FIRST_OF_UNITS,
    Observation,
    behind_units,
    check_observation,
    list_columns,
    name_columns,
    settle,
)
from hav_env.observation.neighbors import observe_neighbors
from hav_env.observation.obstacles import OBSTACLE_SIZE, observe_obstacles
from hav_env.observation.own import MOTION, observe_itself, observe_motion
from hav_env.observation.rays import observe_rays
from hav_env.observation.route import observe_route, plan_route
from hav_env.observation.rows import write_rows
from hav_env.observation.scratch import SCRATCH_ROWS, Scratch
from hav_env.world.other_havs import CHAIN_ROWS

__all__ = [
    "CHAIN_ROWS",
    "SCRATCH_ROWS",
    "Column",
    "Observation",
    "Scratch",
    "check_observation",
    "list_columns",
    "name_columns",
    "observe",
    "plan_route",
    "settle",
    "write_rows",
]


_NUM_MOTION = len(MOTION)


@kernel
def observe(observation, world, agent, scratch, columns):
    """Write the observation of a HAV in every lane of a block of worlds.

    Args:
        observation: Observation settings, as ``settle`` returns them.
        world: Block of worlds.
        agent: Index of the HAV.
        scratch: Scratch rows as ``plan_route`` left them.
        columns: (D, L) columns to write, in the order of ``list_columns``.
    """
    observe_route(world, scratch, columns, FIRST_OF_ROUTE)
    observe_itself(world, agent, scratch, columns, FIRST_OF_UNITS)
    first = behind_units(world.state.heading.shape[1] - 1)
    if observation.motion:
        observe_motion(world, agent, columns, first)
        first += _NUM_MOTION
    if observation.obstacles > 0:
        observe_obstacles(world.place, observation, world, agent, scratch, columns, first)
        first += observation.obstacles * OBSTACLE_SIZE
    if observation.rays > 0:
        observe_rays(observation, world, agent, columns, first)
        first += observation.rays
    if observation.neighbors > 0:
        observe_neighbors(observation, world, agent, scratch, columns, first)
