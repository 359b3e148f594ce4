"""This module defines trucks of Australia: a B-double and an A-triple road train."""

from hav_env.vehicles.combinations.limits import DRAWBAR_ANGLE, RIGHT_ANGLE, loaded_truck
from hav_env.vehicles.combinations.sources import Quantity, Trailer, Truck, assumed, cited, combine

_NHVR = cited("NHVR, dimension requirements: length (nhvr.gov.au)")
_HALF = cited("NHVR, National Heavy Vehicle Inspection Manual, section 16")(
    1.25, "half of 2.5 m, the greatest width"
)
_FRONT_OVERHANG = _NHVR(1.4, "within an arc of 1.9 m round the kingpin")

B_DOUBLE = combine(
    "b-double",
    "Australian B-double",
    Truck(
        length=assumed(4.6, "to the middle of two rear axles"),
        half_width=_HALF,
        front=_NHVR(1.3, "26 m less 20.6 m behind the first kingpin, and the above"),
        rear=assumed(1.1, "frame behind two axles"),
    ),
    (
        Trailer(
            length=assumed(8.7, "no more than the 9.5 m of NHVR; 20.6 m in all are kept"),
            hitch=assumed(-0.5, "a fifth wheel ahead of two axles"),
            half_width=_HALF,
            front=_FRONT_OVERHANG,
            rear=assumed(1.6, "frame behind three axles, below the next trailer"),
            articulation_max=RIGHT_ANGLE,
        ),
        Trailer(
            length=assumed(8.3, "no more than the 9.5 m of NHVR; 20.6 m in all are kept"),
            hitch=assumed(-0.4, "a fifth wheel above three axles, a little ahead"),
            half_width=_HALF,
            front=_FRONT_OVERHANG,
            rear=_NHVR(4.0, "12.3 m behind the kingpin less the above"),
            articulation_max=RIGHT_ANGLE,
        ),
    ),
    **loaded_truck(),
)

_TRAILER = assumed(8.9, "no more than the 9.5 m of NHVR; 53.5 m in all are kept")
_REAR_OVERHANG = _NHVR(3.4, "12.3 m behind the kingpin less the above")
_DOLLY = Trailer(
    length=assumed(4.9, "a drawbar of 4.3 m to the middle of two axles"),
    hitch=assumed(3.1, "a coupling at the rear end of the trailer, 3.4 m behind the axles"),
    half_width=_HALF,
    front=assumed(0.0, "its rectangle holds the drawbar"),
    rear=assumed(0.9, "two axles"),
    articulation_max=DRAWBAR_ANGLE,
)


def _semi_trailer(hitch: Quantity) -> Trailer:
    return Trailer(_TRAILER, hitch, _HALF, _FRONT_OVERHANG, _REAR_OVERHANG, RIGHT_ANGLE)


_ON_DOLLY = _semi_trailer(assumed(0.0, "a turntable above the middle of the dolly's axles"))

A_TRIPLE = combine(
    "a-triple",
    "Australian A-triple road train",
    Truck(
        length=assumed(5.5, "a conventional cab, to the middle of two rear axles"),
        half_width=_HALF,
        front=assumed(1.4, "with a bull bar"),
        rear=assumed(1.1, "frame behind two axles"),
    ),
    (
        _semi_trailer(assumed(-0.5, "a fifth wheel ahead of two axles")),
        *(_DOLLY, _ON_DOLLY),
        *(_DOLLY, _ON_DOLLY),
    ),
    **loaded_truck(),
)
