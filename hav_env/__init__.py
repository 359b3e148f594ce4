"""Swarms of Heavy Articulated Vehicles: trucks that pull one to ten trailers to goal poses."""

from hav_env.batch import Batch
from hav_env.scenarios import (
    Explicit,
    PlacementError,
    RandomPoses,
    explicit,
    load_explicit,
)
from hav_env.task import Task
from hav_env.vehicles import OnAxle

__version__ = "0.1.0"

__all__ = [
    "Batch",
    "Explicit",
    "OnAxle",
    "PlacementError",
    "RandomPoses",
    "Task",
    "explicit",
    "load_explicit",
]
