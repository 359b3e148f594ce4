"""This module defines vehicles of the catalogue, each number with a source or a reason.

``cited`` and ``assumed`` return a ``Quantity``, and ``combine`` builds a vehicle from them.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

from hav_env.models.checks import check_fields
from hav_env.vehicles.combinations.combination import Combination, Origin, Unit
from hav_env.vehicles.steady_circles import check_damped


class Quantity(NamedTuple):
    """A number with its source, or with the reason for an assumption."""

    value: float
    source: str
    note: str


class Truck(NamedTuple):
    """The numbers of a truck; see ``Unit``."""

    length: Quantity
    half_width: Quantity
    front: Quantity
    rear: Quantity


class Trailer(NamedTuple):
    """The numbers of a trailer; see ``Unit``."""

    length: Quantity
    hitch: Quantity
    half_width: Quantity
    front: Quantity
    rear: Quantity
    articulation_max: Quantity


def cited(source: str) -> Callable[..., Quantity]:
    """Return a function that cites numbers from a source.

    It takes the number and, if the source does not state it, its derivation.
    """

    def write(value: float, derived: str = "") -> Quantity:
        return Quantity(value, source, derived)

    return write


def assumed(value: float, reason: str) -> Quantity:
    """Return a number without a source, and the reason for it."""
    return Quantity(value, "", reason)


def combine(
    name: str, title: str, truck: Truck, trailers: tuple[Trailer, ...], **limits: Quantity
) -> Combination:
    """Return a vehicle, with the origins of its numbers.

    Args:
        name: name in the catalogue.
        title: name for readers.
        truck: numbers of the truck.
        trailers: numbers of the trailers, from front to rear.
        limits: limits of ``Combination``, from ``speed_max`` on.

    Raises:
        ValueError: if a number is out of its range, or a hitch amplifies swings.
    """
    widest = max(trailer.articulation_max.value for trailer in trailers)
    values = {field: found.value for field, found in truck._asdict().items()}
    units = [Unit(**values, hitch=0.0, articulation_max=widest)]
    units += [Unit(*(found.value for found in trailer)) for trailer in trailers]
    known: list[Truck | Trailer] = [truck, *trailers]
    quantities = {
        f"units[{place}].{field}": found
        for place, numbers in enumerate(known)
        for field, found in numbers._asdict().items()
    } | limits
    origins = tuple(Origin(field, *found[1:]) for field, found in quantities.items())
    most: dict[str, Any] = {field: found.value for field, found in limits.items()}
    combination = Combination(name, title, tuple(units), origins=origins, **most)
    for place, unit in enumerate(units):
        check_fields(f"{name} units[{place}]", unit)
    check_fields(name, combination)
    check_damped(combination.lengths, combination.offsets)
    return combination
