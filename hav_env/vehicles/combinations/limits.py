"""This module defines common limits of the catalogue: steering, speed, acceleration."""

import math

from hav_env.vehicles.combinations.sources import Quantity, assumed, cited

COMMONROAD = cited(
    "CommonRoad vehicle 4 (package commonroad-vehicle-models 3.0.2, parameters_vehicle4.yaml)"
)
APOLLO = cited("Apollo planner, tractor_param and trailer_param of a truck, in public code")

USUAL_STEERING = assumed(
    math.radians(40.0), "the wheel in the middle when the inner one is at some 45 degrees"
)
USUAL_STEERING_RATE = assumed(0.5, "near the 0.523 rad/s of Apollo's truck")


def jackknife_angle(degrees: float, reason: str) -> Quantity:
    """Return an articulation limit [rad] without a source, and the reason for it."""
    return assumed(math.radians(degrees), reason)


RIGHT_ANGLE = jackknife_angle(90.0, "the paper's jackknife; no limit of the coupling was found")
DRAWBAR_ANGLE = jackknife_angle(80.0, "a drawbar or a turntable meets the frame before 90 degrees")


def loaded_truck(**known: Quantity) -> dict[str, Quantity]:
    """Return the limits of a loaded truck in a yard.

    Args:
        known: limits with better sources; they replace the assumptions.
    """
    return {
        "speed_max": assumed(5.0, "usual in yards; there the model of rolling wheels holds"),
        "steering_max": USUAL_STEERING,
        "steering_rate": USUAL_STEERING_RATE,
        "acceleration": assumed(1.0, "loaded: half of the 2.0 m/s^2 of Apollo's truck"),
        "braking": assumed(2.0, "gentle: Apollo's truck brakes at up to 5.0 m/s^2"),
        "lateral": assumed(2.0, "0.2 g; thresholds of rollover begin at 0.35 g"),
    } | known
