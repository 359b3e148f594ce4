"""Ray on this machine, for tests."""

import contextlib
import os

# read when Ray is loaded: no token in the home directory, no report of its use
os.environ["RAY_AUTH_MODE"] = "disabled"
os.environ["RAY_USAGE_STATS_ENABLED"] = "0"

import ray
from ray.tune.trainable import trainable


@contextlib.contextmanager
def ray_here(storage, cores: int = 1):
    """Run Ray with so many cores, and keep its results out of the home directory."""
    usual, trainable.DEFAULT_STORAGE_PATH = trainable.DEFAULT_STORAGE_PATH, str(storage)
    ray.init(num_cpus=cores, include_dashboard=False, log_to_driver=False)
    try:
        yield ray
    finally:
        ray.shutdown()
        trainable.DEFAULT_STORAGE_PATH = usual
