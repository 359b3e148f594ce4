"""This package simulates swarms of trucks that pull trailers to goal poses.

The vehicles are Heavy Articulated Vehicles (HAVs): a truck and one to ten passive trailers. This
package has all names that users need. The packages inside are for those who add to them.
"""

import importlib
from typing import TYPE_CHECKING, Any

import gymnasium
import pettingzoo

from hav_env.envs.hav_swarm_v0 import env, parallel_env
from hav_env.mdp.reward import Reward, reward_terms
from hav_env.mdp.site_reward import SiteReward
from hav_env.models.names import find_model
from hav_env.observation import Observation
from hav_env.places import Site, build_site, load_site
from hav_env.policies import (
    PolicyDriver,
    act,
    act_lanes,
    allocate_memory,
    broadcast_size,
    decide,
    heard,
    make_policy,
    memory_size,
)
from hav_env.scenarios import (
    Column,
    Crossing,
    Explicit,
    Field,
    PlacementError,
    RandomFleet,
    RandomPoses,
    SitePoses,
    Yard,
    catalogue_fleet,
    explicit,
    load_explicit,
    populate,
    site_poses,
)
from hav_env.scenarios.presets import find_scenario
from hav_env.simulator.batch import Batch
from hav_env.vehicles import Instant, Limited, Lines, OffAxle, OnAxle, Rectangles, catalogue, move
from hav_env.world import sensing
from hav_env.world.task import Task

if TYPE_CHECKING:
    from hav_env.envs.stable_baselines3 import HAVVecEnv
    from hav_env.evaluation.evaluate import evaluate
    from hav_env.evaluation.rollout import rollout

__version__ = "0.1.0"

__all__ = [
    "Batch",
    "Column",
    "Crossing",
    "Explicit",
    "Field",
    "HAVVecEnv",
    "Instant",
    "Limited",
    "Lines",
    "Observation",
    "OffAxle",
    "OnAxle",
    "PlacementError",
    "PolicyDriver",
    "RandomFleet",
    "RandomPoses",
    "Rectangles",
    "Reward",
    "Site",
    "SitePoses",
    "SiteReward",
    "Task",
    "Yard",
    "act",
    "act_lanes",
    "allocate_memory",
    "broadcast_size",
    "build_site",
    "catalogue",
    "catalogue_fleet",
    "decide",
    "env",
    "evaluate",
    "explicit",
    "find_model",
    "find_scenario",
    "heard",
    "load_explicit",
    "load_site",
    "make_policy",
    "memory_size",
    "move",
    "parallel_env",
    "populate",
    "reward_terms",
    "rollout",
    "sensing",
    "site_poses",
]

# loaded when they are wanted: tables take the time of pyarrow, HAVVecEnv needs an extra
_LAZY = {
    "HAVVecEnv": "hav_env.envs.stable_baselines3",
    "evaluate": "hav_env.evaluation.evaluate",
    "rollout": "hav_env.evaluation.rollout",
}


def __getattr__(name: str) -> Any:
    if name not in _LAZY:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(_LAZY[name]), name)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]


for _name in ("HAVSwarm", "HAVSingle"):
    gymnasium.register(
        id=f"{_name}-v0",
        entry_point=f"hav_env.envs.gymnasium_single:{_name}Env",
        vector_entry_point=f"hav_env.envs.gymnasium_vector:{_name}VectorEnv",
    )
if hasattr(pettingzoo, "register"):  # from 1.27 on
    pettingzoo.register("parallel", "hav/swarm-v0", "hav_env.envs.hav_swarm_v0:parallel_env")
    pettingzoo.register("aec", "hav/swarm-v0", "hav_env.envs.hav_swarm_v0:env")
