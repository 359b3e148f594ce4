"""This module defines a vehicle of the catalogue: units, limits, origins of all numbers."""

from typing import NamedTuple

from hav_env.models.quantities import (
    AboveZero,
    Articulation,
    Distance,
    Length,
    Offset,
    Speed,
    Steering,
)


class Unit(NamedTuple):
    """One rigid part of a vehicle: the truck, a semi-trailer, a dolly, a drawbar, a body."""

    length: Length
    """Wheelbase of the truck; of a trailer, from its hitch to the middle of its axles [m]."""
    hitch: Offset
    """Distance of this unit's hitch behind the axle of the unit ahead [m]. Above 0 it is a drawbar,
    below 0 a fifth wheel ahead of the axle, 0 the paper's hitch. The truck's is 0."""
    half_width: Distance
    """Half the width of the body, a rectangle [m]."""
    front: Distance
    """Reach of the body ahead of the truck's front axle, or of the trailer's hitch [m]. The
    body of a drawbar or a dolly begins at its hitch: 0."""
    rear: Distance
    """Reach of the body behind its axle [m]."""
    articulation_max: Articulation
    """Greatest angle to the unit ahead [rad]; the truck's is the greatest of its trailers'."""


class Origin(NamedTuple):
    """The origin of a number."""

    field: str
    """Name of the number, such as ``units[1].length`` or ``speed_max``."""
    source: str
    """Source; empty if the number is an assumption."""
    note: str
    """Derivation of the number from its source, or the reason for the assumption."""

    @property
    def assumed(self) -> bool:
        """Whether the number has no source."""
        return not self.source


class Combination(NamedTuple):
    """A real vehicle: a truck and its trailers."""

    name: str
    """Name in the catalogue."""
    title: str
    """Name for readers."""
    units: tuple[Unit, ...]
    """Units from front to rear, the truck first: 2 to 11."""
    speed_max: Speed
    """Working speed [m/s]. Trucks are faster on roads. The model of wheels without slip holds up to
    about 5 m/s."""
    steering_max: Steering
    """Greatest steering angle of a wheel in the middle of the front axle [rad]."""
    steering_rate: AboveZero
    """Greatest change of the steering angle [rad/s]."""
    acceleration: AboveZero
    """Greatest acceleration [m/s^2]."""
    braking: AboveZero
    """Greatest deceleration [m/s^2]."""
    lateral: AboveZero
    """Greatest sideways acceleration of the truck [m/s^2]."""
    origins: tuple[Origin, ...]
    """Origin of each number, in the order of the fields."""

    @property
    def lengths(self) -> tuple[float, ...]:
        """Lengths of all units [m]."""
        return tuple(unit.length for unit in self.units)

    @property
    def offsets(self) -> tuple[float, ...]:
        """Hitch offsets of all units [m]."""
        return tuple(unit.hitch for unit in self.units)

    @property
    def limits(self) -> tuple[float, ...]:
        """Greatest articulations of all units [rad]."""
        return tuple(unit.articulation_max for unit in self.units)

    @property
    def bodies(self) -> tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...]]:
        """Half widths, fronts and rears of all units [m]."""
        half_widths, fronts, rears = zip(*(unit[2:5] for unit in self.units), strict=True)
        return half_widths, fronts, rears

    @property
    def straight_ends(self) -> tuple[tuple[float, float], ...]:
        """Front end and axle of each unit of the straight vehicle [m], from the truck's rear axle.

        The front end is the truck's front axle, or the trailer's hitch.
        """
        ends: list[tuple[float, float]] = []
        for unit in self.units:
            front_end = ends[-1][1] - unit.hitch if ends else unit.length
            ends.append((front_end, front_end - unit.length))
        return tuple(ends)

    @property
    def overall_length(self) -> float:
        """Length of the straight vehicle, from its foremost to its rearmost point [m]."""
        ends = self.straight_ends
        foremost = max(end + unit.front for unit, (end, _) in zip(self.units, ends, strict=True))
        rearmost = min(axle - unit.rear for unit, (_, axle) in zip(self.units, ends, strict=True))
        return foremost - rearmost

    @property
    def assumed(self) -> frozenset[str]:
        """Names of the numbers that have no source."""
        return frozenset(origin.field for origin in self.origins if origin.assumed)
