"""This module defines AASHTO's design vehicles of North America: semi-trailer, doubles, triple."""

import math

from hav_env.vehicles.combinations.combination import Combination
from hav_env.vehicles.combinations.limits import jackknife_angle, loaded_truck
from hav_env.vehicles.combinations.sources import Quantity, Trailer, Truck, assumed, cited, combine

# the metric table calls WB-67, WB-67D, WB-100T and WB-109D WB-20, WB-20D, WB-30T and WB-33D
_METRIC = cited(
    "AASHTO Green Book, metric design vehicle dimensions (scribd.com/document/641225099)"
)
_GREEN_BOOK = cited("AASHTO Green Book 2018, Table 2-4a (swash17.github.io/FreightCurriculum)")
_HALF = _METRIC(1.3, "half of 2.6 m")
_ANGLE = jackknife_angle(68.5, "from memory of the Green Book's turning templates")
_KINGPIN = assumed(0.91, "3 ft from a trailer's front to its kingpin, from memory of its figures")
_TRACTOR_REAR = assumed(0.6, "frame behind the last axle")
_ON_AXLE = _METRIC(0.0, "WB2 begins where WB1 ends")
_LOCK_TO_LOCK = "28.4 degrees to either side in 6 s, as a data sheet of WB-19 has it (WB-62)"
_STEERING_RATE = assumed(math.radians(2 * 28.4 / 6.0), _LOCK_TO_LOCK)

WB_67 = combine(
    "wb-67",
    "AASHTO: tractor and 53 ft semi-trailer",
    Truck(
        length=_GREEN_BOOK(6.01, "73.5 ft less overhangs of 4.0 and 4.5 ft and WB2"),
        half_width=_HALF,
        front=_GREEN_BOOK(1.22, "4.0 ft"),
        rear=_TRACTOR_REAR,
    ),
    (
        Trailer(
            length=_METRIC(13.8, "WB2 of WB-20, its greatest"),
            hitch=_ON_AXLE,
            half_width=_HALF,
            front=_KINGPIN,
            rear=_GREEN_BOOK(1.37, "4.5 ft"),
            articulation_max=_ANGLE,
        ),
    ),
    **loaded_truck(
        steering_max=assumed(math.radians(28.4), _LOCK_TO_LOCK), steering_rate=_STEERING_RATE
    ),
)


def _trailers_on_dollies(
    trailers: tuple[Quantity, ...], s: Quantity, t: Quantity, rear: Quantity
) -> tuple[Trailer, ...]:
    """Return semi-trailers, all but the first of them on converter dollies.

    Args:
        trailers: wheelbases, WB2 and so on.
        s: distance from an axle to the hitch behind it.
        t: distance from that hitch to the dolly's axle.
        rear: overhang of the last trailer; the others are assumed to have the same.
    """
    alike = assumed(rear.value, "that of the last trailer")
    dolly = Trailer(
        length=t,
        hitch=s,
        half_width=_HALF,
        front=assumed(0.0, "its rectangle holds the drawbar"),
        rear=assumed(0.6, "one axle"),
        articulation_max=_ANGLE,
    )
    units: list[Trailer] = []
    for place, length in enumerate(trailers, start=1):
        overhang = rear if place == len(trailers) else alike
        units += [dolly] if units else []
        units.append(Trailer(length, _ON_AXLE, _HALF, _KINGPIN, overhang, _ANGLE))
    return tuple(units)


def _double(name: str, title: str, trailers: tuple[Quantity, ...], degrees: float) -> Combination:
    """Return a double or triple of 28 ft trailers."""
    return combine(
        name,
        title,
        Truck(length=_METRIC(3.4, "WB1"), half_width=_HALF, front=_METRIC(0.7), rear=_TRACTOR_REAR),
        _trailers_on_dollies(trailers, _METRIC(0.9, "S"), _METRIC(2.1, "T"), _METRIC(0.9)),
        **loaded_truck(
            steering_max=assumed(math.radians(degrees), "from memory of its turning template"),
            steering_rate=_STEERING_RATE,
        ),
    )


WB_67D = _double(
    "wb-67d", "AASHTO: double of 28 ft trailers", (_METRIC(7.0, "WB2"), _METRIC(7.0, "WB3")), 17.7
)
WB_100T = _double(
    "wb-100t",
    "AASHTO: triple of 28 ft trailers",
    (_METRIC(6.9, "WB2"), _METRIC(7.0, "WB3"), _METRIC(7.0, "WB4")),
    16.3,
)
WB_109D = combine(
    "wb-109d",
    "AASHTO: turnpike double of 48 ft trailers",
    Truck(length=_METRIC(4.4, "WB1"), half_width=_HALF, front=_METRIC(0.7), rear=_TRACTOR_REAR),
    _trailers_on_dollies(
        (_METRIC(12.2, "WB2"), _METRIC(12.2, "WB2; WB3 = 13.6 reaches to the rear end")),
        _METRIC(0.8, "S"),
        _METRIC(3.1, "T"),
        _METRIC(1.4, "WB3 less WB2; the sum is then 34.8 m, the overall length"),
    ),
    **loaded_truck(
        steering_max=cited("NCHRP problem statement (rns.trb.org, 42537)")(
            math.radians(13.0), "13 degrees for WB-109D"
        ),
        steering_rate=_STEERING_RATE,
    ),
)
