"""This package simulates swarms of trucks that pull trailers to goal poses.

The vehicles are Heavy Articulated Vehicles (HAVs): a truck and one to ten passive trailers. This
package exports all names that users need. Its subpackages are for extensions of the project.
"""

import importlib
from typing import TYPE_CHECKING, Any

import gymnasium
import pettingzoo

if TYPE_CHECKING:
    from hav_env.envs.hav_swarm_v0 import env, parallel_env
    from hav_env.envs.stable_baselines3 import HAVVecEnv
    from hav_env.evaluation.evaluate import evaluate
    from hav_env.evaluation.rollout import rollout
    from hav_env.mdp.model_kinds import find_model
    from hav_env.mdp.reward import Reward, reward_terms
    from hav_env.mdp.site_reward import SiteReward
    from hav_env.observation import Observation
    from hav_env.places import Site, build_site, load_site
    from hav_env.policies import (
        Filtered,
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
    from hav_env.safety import SafetyFilter
    from hav_env.scenarios import (
        Column,
        Crossing,
        Explicit,
        Field,
        PlacementError,
        RandomFleet,
        RandomPoses,
        RandomSitePoses,
        SitePoses,
        Yard,
        load_explicit,
        populate,
    )
    from hav_env.scenarios.catalogue_fleet import catalogue_fleet
    from hav_env.scenarios.explicit import explicit
    from hav_env.scenarios.presets import find_scenario
    from hav_env.scenarios.site_poses import site_poses
    from hav_env.simulator.batch import Batch
    from hav_env.vehicles import (
        Instant,
        Limited,
        Lines,
        OffAxle,
        OnAxle,
        Rectangles,
        catalogue,
        move,
    )
    from hav_env.world import sensing
    from hav_env.world.task import Task

__version__ = "0.1.0"

__all__ = [
    "Batch",
    "Column",
    "Crossing",
    "Explicit",
    "Field",
    "Filtered",
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
    "RandomSitePoses",
    "Rectangles",
    "Reward",
    "SafetyFilter",
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

# loaded at their first use: the compiler loads slowly, and HAVVecEnv needs an extra
_HOMES = {
    "hav_env.envs.hav_swarm_v0": (
        "env",
        "parallel_env",
    ),
    "hav_env.envs.stable_baselines3": ("HAVVecEnv",),
    "hav_env.evaluation.evaluate": ("evaluate",),
    "hav_env.evaluation.rollout": ("rollout",),
    "hav_env.mdp.model_kinds": ("find_model",),
    "hav_env.mdp.reward": (
        "Reward",
        "reward_terms",
    ),
    "hav_env.mdp.site_reward": ("SiteReward",),
    "hav_env.observation": ("Observation",),
    "hav_env.places": (
        "Site",
        "build_site",
        "load_site",
    ),
    "hav_env.policies": (
        "Filtered",
        "PolicyDriver",
        "act",
        "act_lanes",
        "allocate_memory",
        "broadcast_size",
        "decide",
        "heard",
        "make_policy",
        "memory_size",
    ),
    "hav_env.safety": ("SafetyFilter",),
    "hav_env.scenarios": (
        "Column",
        "Crossing",
        "Explicit",
        "Field",
        "PlacementError",
        "RandomFleet",
        "RandomPoses",
        "RandomSitePoses",
        "SitePoses",
        "Yard",
        "catalogue_fleet",
        "explicit",
        "load_explicit",
        "populate",
        "site_poses",
    ),
    "hav_env.scenarios.presets": ("find_scenario",),
    "hav_env.simulator.batch": ("Batch",),
    "hav_env.vehicles": (
        "Instant",
        "Limited",
        "Lines",
        "OffAxle",
        "OnAxle",
        "Rectangles",
        "catalogue",
        "move",
    ),
    "hav_env.world.sensing": ("sensing",),
    "hav_env.world.task": ("Task",),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    home = importlib.import_module(_HOME_OF[name])
    found = globals()[name] = getattr(home, name, home)  # sensing is a module itself
    return found


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
