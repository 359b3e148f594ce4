"""This module has the tasks for BenchMARL: IPPO, MAPPO, MASAC and others on batched worlds.

    HAVTask.PAPER_PAIR.get_task({"frame_skip": 5, "state": True})

The members of ``HAVTask`` are scenarios. A configuration holds the arguments of ``TorchRLEnv``
beside the number of worlds, the seed and the device; ``scenario`` replaces that of the member.
"""

from collections.abc import Callable
from typing import Any

from hav_env.envs.torchrl import TorchRLEnv

try:
    from benchmarl.environments.common import Task, TaskClass
    from torchrl.data import Composite
    from torchrl.envs import EnvBase
except ImportError as error:
    message = (
        "hav_env.envs.benchmarl needs benchmarl: run pip install -e '.[benchmarl]' in the clone"
    )
    raise ImportError(message) from error


class HAVTaskClass(TaskClass):
    """One scenario as a BenchMARL task."""

    def get_env_fun(
        self, num_envs: int, continuous_actions: bool, seed: int | None, device: Any
    ) -> Callable[[], EnvBase]:
        """Return a function that creates the environment.

        Args:
            num_envs: Number of worlds W.
            continuous_actions: Must be True: discrete actions do not exist.
            seed: Seed of the first world.
            device: Device of the tensors.
        """
        config = {"scenario": self.name.lower().replace("_", "-"), **self.config}
        return lambda: TorchRLEnv(num_envs, seed=seed, device=device, **config)

    def supports_continuous_actions(self) -> bool:
        """Return True: speed and steering."""
        return True

    def supports_discrete_actions(self) -> bool:
        """Return False."""
        return False

    def max_steps(self, env: EnvBase) -> int:
        """Return the largest number of actions in an episode."""
        process = env.process
        return -(-process.batch.task.max_steps // process.frame_skip)

    def has_render(self, env: EnvBase) -> bool:
        """Return False: ``python -m baselines watch`` renders policies."""
        return False

    def group_map(self, env: EnvBase) -> dict[str, list[str]]:
        """Return the names of the HAVs of the one group."""
        return env.group_map

    def observation_spec(self, env: EnvBase) -> Composite:
        """Return the spec of the observations of one world."""
        spec = env.full_observation_spec_unbatched.clone()
        return Composite({group: spec[group] for group in env.group_map})

    def state_spec(self, env: EnvBase) -> Composite | None:
        """Return the spec of the central state of one world, or None if it is disabled."""
        if not self.config.get("state", False):
            return None
        return Composite(state=env.full_observation_spec_unbatched["state"].clone())

    def action_spec(self, env: EnvBase) -> Composite:
        """Return the spec of the actions of one world."""
        return env.full_action_spec_unbatched

    def info_spec(self, env: EnvBase) -> None:
        """Return None: infos are empty."""

    def action_mask_spec(self, env: EnvBase) -> None:
        """Return None: every action is allowed."""

    @staticmethod
    def env_name() -> str:
        """Return the name of the environment."""
        return "hav"


class HAVTask(Task):
    """Scenarios by name; ``get_task({"scenario": ...})`` takes any other scenario."""

    PAPER_SINGLE = None
    PAPER_PAIR = None
    CROSSING_8 = None
    SWARM_5 = None
    SWARM_10 = None
    SWARM_20 = None

    @staticmethod
    def associated_class() -> type[HAVTaskClass]:
        """Return the class of the tasks."""
        return HAVTaskClass

    def get_task(self, config: dict[str, Any] | None = None) -> HAVTaskClass:
        """Return a task; without a configuration, use the default arguments."""
        return HAVTaskClass(self.name, config or {})
