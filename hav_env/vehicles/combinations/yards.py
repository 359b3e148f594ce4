"""This module defines trains of yards, aprons, halls and farms: tractors with many trailers."""

import math
from collections.abc import Callable

from hav_env.vehicles.combinations.limits import (
    DRAWBAR_ANGLE,
    RIGHT_ANGLE,
    jackknife_angle,
    loaded_truck,
)
from hav_env.vehicles.combinations.sources import Quantity, Trailer, Truck, assumed, cited, combine

_OTTAWA = cited("Kalmar Ottawa 4x2 (Wikipedia, Terminal tractor)")
_METRIC = cited(
    "AASHTO Green Book, metric design vehicle dimensions (scribd.com/document/641225099)"
)
_DRAWBARS = cited("tractor with drawbar trailers (github.com/nontanan-linux/tracter_trailer)")

TERMINAL_TRACTOR = combine(
    "terminal-tractor",
    "Terminal tractor and 33 ft semi-trailer",
    Truck(
        length=_OTTAWA(2.95, "116 in"),
        half_width=assumed(1.25, "half of 2.5 m"),
        front=assumed(1.4, "a cab ahead of the front axle"),
        rear=assumed(0.8, "frame behind the axle"),
    ),
    (
        Trailer(
            length=_METRIC(8.4, "WB2 of WB-12, that is WB-40"),
            hitch=assumed(-0.2, "a fifth wheel a little ahead of the axle"),
            half_width=_METRIC(1.2, "half of 2.4 m"),
            front=assumed(0.91, "3 ft from a trailer's front to its kingpin"),
            rear=_METRIC(0.8, "rear overhang of WB-12"),
            articulation_max=RIGHT_ANGLE,
        ),
    ),
    **loaded_truck(
        steering_max=assumed(math.radians(42.0), "built for tight yards"),
    ),
)

_BAGGAGE_HALF = _DRAWBARS(0.75, "half of W = 1.5")


def _dolly_pair(offset: float, symbol: str) -> tuple[Trailer, Trailer]:
    """Return a dolly of an airport: a drawbar that turns its front axle, and its body."""
    drawbar = Trailer(
        length=_DRAWBARS(1.0, "L1"),
        hitch=_DRAWBARS(offset, symbol),
        half_width=assumed(0.1, "a bar"),
        front=assumed(0.0, "it begins at its hitch"),
        rear=assumed(0.2, "a wheel"),
        articulation_max=jackknife_angle(80.0, "a turntable; the source stops at 30 degrees"),
    )
    body = Trailer(
        length=_DRAWBARS(1.2, "L2"),
        hitch=_DRAWBARS(0.0, "the turntable is above the front axle"),
        half_width=_BAGGAGE_HALF,
        front=assumed(0.6, "its platform reaches beyond the front axle"),
        rear=assumed(0.5, "to the next hitch"),
        articulation_max=jackknife_angle(80.0, "a turntable; the source stops at 30 degrees"),
    )
    return drawbar, body


BAGGAGE_TRAIN = combine(
    "baggage-train",
    "Baggage tractor and five dollies",
    Truck(
        length=_DRAWBARS(2.0, "L0"),
        half_width=_BAGGAGE_HALF,
        front=assumed(0.5, "a bumper"),
        rear=assumed(0.55, "to its hitch"),
    ),
    _dolly_pair(0.55, "d_h") + 4 * _dolly_pair(0.5, "d_h2"),
    **loaded_truck(
        speed_max=_DRAWBARS(5.0, "velocity limit"),
        steering_max=_DRAWBARS(math.radians(30.0), "steering limit of 30 degrees"),
    ),
)


def _cart(offset: float) -> Trailer:
    """Return a cart with one rigid axle."""
    return Trailer(
        length=assumed(1.35, "a drawbar to an axle below the middle of two pallets"),
        hitch=assumed(offset, "a hitch at the rear end of the unit ahead"),
        half_width=assumed(0.45, "a lane of a hall"),
        front=assumed(0.0, "its rectangle holds the drawbar"),
        rear=assumed(0.8, "half of a platform of 1.6 m"),
        articulation_max=DRAWBAR_ANGLE,
    )


TUGGER_TRAIN = combine(
    "tugger-train",
    "Tow tractor and four carts",
    Truck(
        length=assumed(1.1, "a stand-on tow tractor"),
        half_width=assumed(0.4, "a stand-on tow tractor"),
        front=assumed(0.4, "a stand-on tow tractor"),
        rear=assumed(0.4, "a stand-on tow tractor"),
    ),
    (_cart(0.45), *(3 * (_cart(0.95),))),
    **loaded_truck(
        speed_max=assumed(3.0, "fast walking in a hall"),
        steering_max=assumed(math.radians(75.0), "one steered wheel, as logipedia describes it"),
    ),
)

_WAGON_HALF = _METRIC(1.2, "half of 2.4 m, the least width of TR")


def _wagon(offset: float, written: Callable[[float], Quantity]) -> tuple[Trailer, Trailer]:
    """Return a full trailer of a farm: a drawbar that turns its front axle, and its body."""
    drawbar = Trailer(
        length=_METRIC(2.0, "T of TR"),
        hitch=written(offset),
        half_width=assumed(0.15, "a bar"),
        front=assumed(0.0, "it begins at its hitch"),
        rear=assumed(0.4, "a wheel"),
        articulation_max=DRAWBAR_ANGLE,
    )
    body = Trailer(
        length=_METRIC(2.7, "WB2 of TR"),
        hitch=assumed(0.0, "the turntable is above the front axle"),
        half_width=_WAGON_HALF,
        front=assumed(0.9, "as behind"),
        rear=assumed(0.9, "5.6 m in all less T and WB2, from memory of a footnote"),
        articulation_max=DRAWBAR_ANGLE,
    )
    return drawbar, body


FARM_TRAIN = combine(
    "farm-train",
    "Farm tractor and two full trailers",
    Truck(
        length=_METRIC(3.1, "WB1 of TR"),
        half_width=_WAGON_HALF,
        front=_METRIC(0.9, "4.9 m in all less WB1 and the hitch"),
        rear=_METRIC(0.9, "S of TR, to the hitch"),
    ),
    _wagon(0.9, lambda offset: _METRIC(offset, "S of TR"))
    + _wagon(0.9, lambda offset: assumed(offset, "a hitch at the rear end of the wagon")),
    **loaded_truck(),
)
