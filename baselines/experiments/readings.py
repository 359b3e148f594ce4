"""This module names readings of the paper: one choice for each question that its text leaves open.

A reading combines a policy, a fleet, rules and kinematics. ``text`` follows the paper to the
letter; the others depart from it where the published figures suggest it.
"""

import math
from typing import Any, NamedTuple

from baselines.experiments.published import JACKKNIFE_FIGURE
from baselines.policies.avoid_jack import AvoidJack
from hav_env.evaluation.figures import FOLDED_THROUGH, Figure
from hav_env.models.text import suggest
from hav_env.scenarios import RandomFleet
from hav_env.scenarios.presets import SCENARIOS
from hav_env.vehicles import OnAxle
from hav_env.world.task import Task


class Reading(NamedTuple):
    """One reading of the paper."""

    name: str
    told: str = ""
    """Departures from the text, in words."""
    policy: Any = AvoidJack()
    fleet: RandomFleet = RandomFleet()
    task: Task = Task()
    vehicle: Any = OnAxle()
    jackknifed: Figure = JACKKNIFE_FIGURE
    """Figure that counts as jackknifed."""


def vary(
    reading: Reading,
    name: str,
    told: str = "",
    *,
    policy: dict[str, Any] | None = None,
    fleet: dict[str, Any] | None = None,
    task: dict[str, Any] | None = None,
    vehicle: dict[str, Any] | None = None,
    jackknifed: Figure | None = None,
) -> Reading:
    """Return a reading with other parameters under another name.

    Args:
        reading: Reading to change.
        name: Name of the new reading.
        told: Departures from the text, in words.
        policy: Fields of the policy that differ.
        fleet: Fields of the fleet that differ.
        task: Fields of the task that differ.
        vehicle: Fields of the vehicle that differ.
        jackknifed: Figure that counts as jackknifed, if another one does.
    """
    return Reading(
        name,
        told,
        reading.policy._replace(**policy or {}),
        reading.fleet._replace(**fleet or {}),
        reading.task._replace(**task or {}),
        reading.vehicle._replace(**vehicle or {}),
        jackknifed or reading.jackknifed,
    )


def scenario_of_reading(reading: Reading, size: str) -> Any:
    """Return the paper's scenario "single" or "pair" with the fleet of a reading."""
    return SCENARIOS[f"paper-{size}"]._replace(fleet=reading.fleet)


def circles(center: float, truck_share: float) -> dict[str, dict[str, float]]:
    """Return the fields that move and widen the circles of evasion and potential collision.

    Area and placement keep the text's footprints: trailers alone, round the rear axle.

    Args:
        center: Position of the centre ahead of the rear axle, as a share of the truck's length.
        truck_share: Share of the truck's length in the radius, in addition to the trailers.
    """
    return {
        "policy": {"evasion_center": center, "evasion_truck_share": truck_share},
        "task": {"potential_center": center, "potential_truck_share": truck_share},
    }


TEXT = Reading("text", "the paper to the letter; steering and close fitted to single HAVs")
_TEXT_38 = vary(
    TEXT,
    "text-38",
    "the paper to the letter, 38 degrees, close within 3.75 truck lengths",
    policy={"close_factor": 3.75},
    fleet={"steering_max": math.radians(38.0)},
)
_FITTED = vary(
    _TEXT_38,
    "published",
    "fitted; against the text: next goals alone, circles round the trucks' centres that"
    " hold the whole HAV; HAVs in turn, 38 degrees, close 3.75",
    policy=circles(0.5, 0.5)["policy"],
    task={"next_goal": "alone", "order": "in_turn"} | circles(0.5, 0.5)["task"],
)

READINGS = {
    reading.name: reading
    for reading in (
        TEXT,
        _TEXT_38,
        _FITTED,
        vary(
            _FITTED,
            "published-waiting",
            "published, but HAVs wait for each other as in the text",
            task={"next_goal": "together"},
        ),
        vary(
            _FITTED,
            "published-at-once",
            "published, but all HAVs decide at once",
            task={"order": "at_once"},
        ),
        vary(
            TEXT,
            "folded",
            "fitted; against the text: jackknifed beyond 180 degrees, next goals alone, circles"
            " with the whole truck; 50 degrees, close 1, all derivatives at once",
            policy={"close_factor": 1.0} | circles(0.0, 1.0)["policy"],
            fleet={"steering_max": math.radians(50.0)},
            task={"next_goal": "alone"} | circles(0.0, 1.0)["task"],
            vehicle={"simultaneous": True},
            jackknifed=FOLDED_THROUGH,
        ),
    )
}


def find_reading(name: str) -> Reading:
    """Return a reading by its name.

    Raises:
        ValueError: If no reading has this name.
    """
    if name not in READINGS:
        near = suggest(name, READINGS)
        raise ValueError(f"reading is {name!r}, but must be one of {', '.join(READINGS)}{near}")
    return READINGS[name]
