"""This module states the training task for any stack: scenario, observation, reward."""

from typing import Any, Literal, Protocol

from baselines.cli.run_options import Backup, Safety
from hav_env import Observation, OnAxle, Reward, Task
from hav_env.mdp.decision_process import Settings
from hav_env.models.quantities import Precision
from hav_env.scenarios.presets import scenario_of
from train.curriculum import Curriculum, lengthen

CURRICULUM, OBSERVATION = Curriculum(), Observation(neighbors=1, fronts=True)
VEHICLE = OnAxle()
REWARD = Reward(goal=20.0, jackknife=-200.0, articulation=-4.0, time=-0.05)


class Exercise(Protocol):
    """The arguments of a training that define the task, not the learner."""

    @property
    def scenario(self) -> str:
        """Scenario: its name, a JSON file or module:Class."""

    @property
    def trailer_sigma(self) -> float:
        """Sigma of the trailer counts."""

    @property
    def observation(self) -> Observation:
        """Observation of the HAVs."""

    @property
    def vehicle(self) -> Any:
        """Kinematics of the HAVs."""

    @property
    def safety(self) -> Safety:
        """Events that the safety filter prevents, in training and in evaluations."""

    @property
    def backup(self) -> Backup:
        """Name of the backup behind the policy, in training and in evaluations."""

    @property
    def guidance(self) -> str:
        """Name of the guidance to the goals."""

    @property
    def precision(self) -> Precision:
        """Precision of the worlds in training; evaluations are in double precision."""

    @property
    def on_collision(self) -> Literal["record", "end"]:
        """Rule of training episodes for a collision of HAVs, see ``Task``."""

    @property
    def reward(self) -> Any:
        """Reward with the weights of its terms."""

    @property
    def frame_skip(self) -> int:
        """Number of simulator steps that an action is held."""

    @property
    def max_steps(self) -> int:
        """Step limit of a training episode, in simulator steps."""


def settings_of(arguments: Exercise, threads: int | None = None) -> Settings:
    """Return the settings of the training environments.

    Args:
        arguments: The arguments of a training.
        threads: Number of threads that step the worlds.
    """
    return {
        "threads": threads,
        "scenario": lengthen(scenario_of(arguments.scenario), arguments.trailer_sigma),
        "observation": arguments.observation,
        "vehicle": arguments.vehicle,
        "safety": arguments.safety,
        "backup": arguments.backup,
        "guidance": arguments.guidance,
        "precision": arguments.precision,
        "reward": arguments.reward,
        "frame_skip": arguments.frame_skip,
        "info": "ends",
        "task": Task(
            max_steps=arguments.max_steps,
            on_jackknife="end",
            on_collision=arguments.on_collision,
            on_obstacle="end",
        ),
    }
