"""Swarms of Heavy Articulated Vehicles: trucks that pull one to ten trailers to goal poses."""

import gymnasium
import pettingzoo

from hav_env.envs.hav_swarm_v0 import env, parallel_env
from hav_env.mdp.reward import Reward
from hav_env.observation import Observation
from hav_env.scenarios import (
    Column,
    Crossing,
    Explicit,
    PlacementError,
    RandomFleet,
    RandomPoses,
    Yard,
    explicit,
    load_explicit,
)
from hav_env.scenarios.presets import find_scenario
from hav_env.simulator.batch import Batch
from hav_env.vehicles import OnAxle
from hav_env.world.task import Task

__version__ = "0.1.0"

__all__ = [
    "Batch",
    "Column",
    "Crossing",
    "Explicit",
    "Observation",
    "OnAxle",
    "PlacementError",
    "RandomFleet",
    "RandomPoses",
    "Reward",
    "Task",
    "Yard",
    "env",
    "explicit",
    "find_scenario",
    "load_explicit",
    "parallel_env",
]

for _name in ("HAVSwarm", "HAVSingle"):
    gymnasium.register(
        id=f"{_name}-v0",
        entry_point=f"hav_env.envs.gymnasium_single:{_name}Env",
        vector_entry_point=f"hav_env.envs.gymnasium_vector:{_name}VectorEnv",
    )
if hasattr(pettingzoo, "register"):  # from 1.27 on
    pettingzoo.register("parallel", "hav/swarm-v0", "hav_env.envs.hav_swarm_v0:parallel_env")
    pettingzoo.register("aec", "hav/swarm-v0", "hav_env.envs.hav_swarm_v0:env")
