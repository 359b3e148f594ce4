"""This module has the environment for TorchRL: W compiled worlds as one batch, HAVs as a group.

``hav_env.envs.benchmarl`` builds BenchMARL tasks on it.
"""

from typing import Any, Unpack

import numpy as np

from hav_env.envs.reset_options import check_left_out
from hav_env.envs.views import observation_box
from hav_env.maths.random_numbers import SEED_LIMIT
from hav_env.mdp.actions import take_actions
from hav_env.mdp.buffers import Outcome
from hav_env.mdp.central_state import CentralState
from hav_env.mdp.decision_process import DecisionProcess, Settings
from hav_env.models.checks import check_value
from hav_env.models.quantities import Worlds
from hav_env.simulator.batch import check_seed

try:
    import torch
    from tensordict import TensorDict, TensorDictBase
    from torchrl.data import Binary, Bounded, Composite, Unbounded
    from torchrl.envs import EnvBase
except ImportError as error:
    message = "hav_env.envs.torchrl needs torchrl: run pip install -e '.[torchrl]' in the clone"
    raise ImportError(message) from error

GROUP = "agents"
_ENDS = ("done", "terminated", "truncated")


class TorchRLEnv(EnvBase):
    """W worlds of N HAVs; the batch size is (W,).

    ========================= =========== =======================================================
    key                       shape       content
    ========================= =========== =======================================================
    ("agents", "observation") (W, N, D)   float32
    ("agents", "action")      (W, N, 2)   speed and steering, float32, cut to [-1, 1]
    ("agents", "reward")      (W, N, 1)   float32
    "state"                   (W, S)      float32, of whole worlds; with ``state`` only
    "done", "terminated", ..  (W, 1)      bool: the HAVs of a world end together
    ========================= =========== =======================================================

    A HAV that was removed observes zeros and gets the reward 0. A world begins a new episode where
    ``_reset`` is true; TorchRL's collectors and rollouts set it.
    """

    def __init__(
        self,
        num_worlds: int = 1,
        state: bool = False,
        seed: int | None = None,
        device: Any = "cpu",
        **settings: Unpack[Settings],
    ) -> None:
        """Build the worlds.

        Args:
            num_worlds: Number of worlds W.
            state: Whether to add the central state, for critics (``CentralState``).
            seed: See ``set_seed``; None draws a seed.
            device: Device of the tensors; the simulation always runs on the CPU.
            settings: See ``hav_env.mdp.decision_process.DecisionProcess``: scenario, num_havs,
                task, its rules, vehicle, observation, reward, frame_skip.

        Raises:
            ValueError, TypeError: If an argument is invalid; the message names it, its value and
                the rule.
        """
        check_value("num_worlds", Worlds, num_worlds)
        check_value("state", bool, state)
        self.process = DecisionProcess(num_worlds, **settings)
        self.process.report(always=False)
        super().__init__(device=device, batch_size=torch.Size([num_worlds]))
        self._central = CentralState(self.process.batch) if state else None
        self._keys = np.zeros((2, num_worlds), np.int64)  # seed and number of the episodes
        # worlds whose next episode is the first one of their seed
        self._fresh = np.ones(num_worlds, np.bool_)
        self._last: Outcome | None = None
        havs = num_worlds, self.process.num_havs
        self.group_map = {GROUP: [f"hav_{k}" for k in range(havs[1])]}
        box = observation_box(self.process, *havs)
        self.observation_spec = self._worlds_of({
            GROUP: self._havs_of({"observation": _bounded(box.low, box.high)}),
            **self._state_spec(),
        })  # fmt: skip
        one = np.ones((*havs, 2), np.float32)
        self.action_spec = self._worlds_of({GROUP: self._havs_of({"action": _bounded(-one, one)})})
        reward = Unbounded(shape=(*havs, 1), dtype=torch.float32)
        self.reward_spec = self._worlds_of({GROUP: self._havs_of({"reward": reward})})
        self.done_spec = self._worlds_of(
            {end: Binary(n=1, shape=(num_worlds, 1), dtype=torch.bool) for end in _ENDS}
        )
        self.set_seed(
            int(np.random.default_rng().integers(SEED_LIMIT // 2)) if seed is None else seed
        )

    @property
    def columns(self) -> tuple[str, ...]:
        """Return the names of the observation columns of a HAV."""
        return self.process.columns

    def _set_seed(self, seed: int | None) -> None:
        """Make world w begin with the first episode of seed ``seed + w`` at its next reset.

        Raises:
            ValueError, TypeError: If the seed is invalid, or the seed of the last world is too
                large.
        """
        check_seed(seed)
        worlds = self.process.num_worlds
        if int(seed) + worlds > SEED_LIMIT:  # type: ignore[arg-type]
            most = f"{SEED_LIMIT - worlds}, for world w takes seed + w"
            raise ValueError(f"seed is {seed}, but must be at most {most}")
        self._seeds = int(seed) + np.arange(worlds)  # type: ignore[arg-type]
        self._fresh[:] = True

    def _reset(self, tensordict: TensorDictBase | None = None, **kwargs: Any) -> TensorDictBase:
        """Begin episodes in all worlds, or in those that ``_reset`` selects.

        Raises:
            ValueError: If the first reset leaves out a world.
        """
        worlds = self.process.num_worlds
        chosen = np.ones(worlds, np.bool_)
        mask = None if tensordict is None else tensordict.get("_reset", None)
        if mask is not None:
            chosen = mask.reshape(worlds).cpu().numpy().copy()
        check_left_out("_reset", chosen, self.process.begun)
        anew = chosen & self._fresh
        self._keys[1, chosen] += 1
        self._keys[1, anew], self._keys[0, anew] = 0, self._seeds[anew]
        self._fresh[chosen] = False
        outcome = self.process.outcome()
        # the other worlds continue; tensors returned before must not change
        if self._last is not None:
            outcome.observation[~chosen] = self._last.observation[~chosen]
        self.process.begin(self._keys[0], self._keys[1], chosen, outcome)
        self._last = outcome
        none = torch.zeros((worlds, 1), dtype=torch.bool)
        return self._to_tensordict(self._seen(outcome) | {end: none.clone() for end in _ENDS})

    def _step(self, tensordict: TensorDictBase) -> TensorDictBase:
        """Take the actions of all HAVs."""
        actions = tensordict[GROUP, "action"].detach().cpu().contiguous().numpy()
        shape = self.process.num_worlds, self.process.num_havs, 2
        outcome = self._last = self.process.step(take_actions("action", actions, shape))
        seen = self._seen(outcome)
        reward = np.ascontiguousarray(outcome.reward.T, np.float32)[..., None]
        seen[GROUP]["reward"] = torch.from_numpy(reward)
        terminated, truncated = (
            torch.from_numpy(ends[:, None]) for ends in (outcome.terminated, outcome.truncated)
        )
        done = terminated | truncated
        return self._to_tensordict(
            seen | {"done": done, "terminated": terminated, "truncated": truncated}
        )

    def _seen(self, outcome: Outcome) -> dict[str, Any]:
        """Return the observations, and the central state if enabled, by key."""
        seen: dict[str, Any] = {GROUP: {"observation": torch.from_numpy(outcome.observation)}}
        if self._central is not None:
            seen["state"] = torch.from_numpy(self._central.read_worlds())
        return seen

    def _to_tensordict(self, tensors: dict[str, Any]) -> TensorDictBase:
        """Return tensors in TorchRL's form, on the device of the environment."""
        havs = self.process.num_worlds, self.process.num_havs
        group = TensorDict(tensors[GROUP], batch_size=havs)
        tensordict = TensorDict(tensors | {GROUP: group}, batch_size=self.batch_size)
        return tensordict if self.device is None else tensordict.to(self.device)

    def _state_spec(self) -> dict[str, Any]:
        if self._central is None:
            return {}
        box, worlds = self._central.space, self.process.num_worlds
        low, high = (np.tile(limit, (worlds, 1)) for limit in (box.low, box.high))
        return {"state": _bounded(low, high)}

    def _worlds_of(self, specs: dict[str, Any]) -> Any:
        return Composite(specs, shape=self.batch_size, device=self.device)

    def _havs_of(self, specs: dict[str, Any]) -> Any:
        havs = self.process.num_worlds, self.process.num_havs
        return Composite(specs, shape=havs, device=self.device)


def _bounded(low: np.ndarray, high: np.ndarray) -> Any:
    limits = torch.from_numpy(low), torch.from_numpy(high)
    return Bounded(*limits, shape=limits[0].shape, dtype=torch.float32)
