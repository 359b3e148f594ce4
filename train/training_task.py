"""This module states the training task for any stack: scenario, observation, reward."""

from typing import Any, Protocol

from hav_env import Observation, OnAxle, Reward, Task
from hav_env.mdp.decision_process import Settings
from hav_env.scenarios.presets import scenario_of
from train.curriculum import Curriculum, lengthen

CURRICULUM, OBSERVATION = Curriculum(), Observation(neighbors=1, fronts=True)
VEHICLE = OnAxle()
REWARD = Reward(goal=20.0, jackknife=-200.0, articulation=-4.0, time=-0.05)


class Exercise(Protocol):
    """The arguments of a training that say what is practised, not how it is learned."""

    @property
    def scenario(self) -> str:
        """The scenario's name, or a JSON file."""

    @property
    def trailer_sigma(self) -> float:
        """Sigma of the trailer counts."""

    @property
    def observation(self) -> Observation:
        """The observation of others."""

    @property
    def vehicle(self) -> Any:
        """The kinematics."""

    @property
    def reward(self) -> Any:
        """Weights of its terms."""

    @property
    def frame_skip(self) -> int:
        """For how many steps of the simulator an action is held."""

    @property
    def max_steps(self) -> int:
        """Largest length of an episode to train on, in steps of the simulator."""


def settings_of(arguments: Exercise, threads: int | None = None) -> Settings:
    """Return what the environments are built from.

    Args:
        arguments: of a training.
        threads: how many step the worlds.
    """
    return {
        "threads": threads,
        "scenario": lengthen(scenario_of(arguments.scenario), arguments.trailer_sigma),
        "observation": arguments.observation,
        "vehicle": arguments.vehicle,
        "reward": arguments.reward,
        "frame_skip": arguments.frame_skip,
        "info": "ends",
        "task": Task(max_steps=arguments.max_steps, on_jackknife="end", on_collision="end"),
    }
