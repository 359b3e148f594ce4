"""The limits of the HAVs of a scenario: its fleet states them, or the scenario itself."""

from typing import Any

from hav_env.scenarios import RandomFleet


def limits_of(scenario: Any) -> Any:
    """Return the model that states the limits of all HAVs of a scenario.

    A scenario that draws its HAVs has a field that holds a ``RandomFleet``. Any other scenario
    states ``speed_max``, ``steering_max`` and ``footprint_truck_share`` itself.
    """
    return next((value for value in scenario if isinstance(value, RandomFleet)), scenario)
