"""Swarms of Heavy Articulated Vehicles: trucks that pull one to ten trailers to goal poses."""

from hav_env.batch import Batch
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
from hav_env.task import Task
from hav_env.vehicles import OnAxle

__version__ = "0.1.0"

__all__ = [
    "Batch",
    "Column",
    "Crossing",
    "Explicit",
    "OnAxle",
    "PlacementError",
    "RandomFleet",
    "RandomPoses",
    "Task",
    "Yard",
    "explicit",
    "find_scenario",
    "load_explicit",
]
