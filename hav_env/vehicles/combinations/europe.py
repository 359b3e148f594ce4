"""This module defines trucks of Europe: semi-trailers, truck and trailer, EuroCombi, A-double."""

from hav_env.vehicles.combinations.limits import (
    APOLLO,
    COMMONROAD,
    DRAWBAR_ANGLE,
    RIGHT_ANGLE,
    loaded_truck,
)
from hav_env.vehicles.combinations.sources import Trailer, Truck, assumed, cited, combine

_EU = cited("Directive 96/53/EC, as transportxxl.eu states it")
_EMS = cited("European Modular System, as logistiikanmaailma.fi states it")
_NORDIC = cited("OpenPBS, NordicCombination.mo")
_ADOUBLE = cited("OpenPBS, Adouble6x4.mo")
_HALF = _EU(1.275, "half of 2.55 m, the greatest width")

SEMI_TRAILER = combine(
    "eu-semi-trailer",
    "EU tractor and semi-trailer",
    Truck(
        length=COMMONROAD(3.6, "a + b"),
        half_width=COMMONROAD(1.275, "half of w = 2.55"),
        front=COMMONROAD(0.9, "l_total = 16.5 less a + b = 3.6 and l_hitch = 12.0"),
        rear=COMMONROAD(0.6, "l = 5.1 less a + b = 3.6 and 0.9 in front"),
    ),
    (
        Trailer(
            length=COMMONROAD(8.1, "trailer l_wb"),
            hitch=COMMONROAD(0.0, "its model is on-axle"),
            half_width=COMMONROAD(1.275, "half of trailer w = 2.55"),
            front=COMMONROAD(1.6, "trailer l = 13.6 less l_hitch = 12.0"),
            rear=COMMONROAD(3.9, "l_hitch = 12.0 less l_wb = 8.1"),
            articulation_max=RIGHT_ANGLE,
        ),
    ),
    **loaded_truck(steering_max=COMMONROAD(0.55), steering_rate=COMMONROAD(0.7103)),
)

LONG_SEMI_TRAILER = combine(
    "apollo-semi-trailer",
    "Tractor and semi-trailer of the Apollo planner",
    Truck(
        length=APOLLO(4.5, "wheel_base"),
        half_width=APOLLO(1.275, "half of width = 2.55"),
        front=APOLLO(1.5, "front_overhang"),
        rear=APOLLO(0.81, "rear_overhang"),
    ),
    (
        Trailer(
            length=APOLLO(9.73, "wheel_base"),
            hitch=APOLLO(-0.3, "head_base_to_hinge, ahead of the axle"),
            half_width=APOLLO(1.265, "half of width = 2.53"),
            front=APOLLO(0.87, "front_overhang"),
            rear=APOLLO(3.4, "rear_overhang"),
            articulation_max=RIGHT_ANGLE,
        ),
    ),
    **loaded_truck(
        steering_max=APOLLO(0.468, "max_steer_angle"),
        steering_rate=APOLLO(0.523, "max_steer_angle_rate"),
        acceleration=APOLLO(2.0, "max_acceleration"),
        braking=APOLLO(5.0, "max_deceleration"),
    ),
)

TRUCK_AND_TRAILER = combine(
    "eu-truck-trailer",
    "EU truck and centre-axle trailer",
    Truck(
        length=assumed(5.5, "to the middle of two rear axles"),
        half_width=_HALF,
        front=assumed(1.4, "usual for a cab over the engine"),
        rear=_EU(3.275, "18.75 less 16.40 m is the cab, half of 15.65 m the box; less the above"),
    ),
    (
        Trailer(
            length=assumed(6.2, "to axles in the middle of the box; 3 m between axles are kept"),
            hitch=assumed(1.9, "coupled deep under the box, to bring the boxes together"),
            half_width=_HALF,
            front=assumed(0.0, "its rectangle holds the drawbar"),
            rear=_EU(3.75, "what is left of 18.75 m"),
            articulation_max=DRAWBAR_ANGLE,
        ),
    ),
    **loaded_truck(),
)

EUROCOMBI = combine(
    "eurocombi",
    "EuroCombi: truck, dolly, semi-trailer",
    Truck(
        length=_NORDIC(5.5, "to the middle of the axles at 4.8 and 6.2"),
        half_width=_HALF,
        front=_NORDIC(1.0, "FOH"),
        rear=_NORDIC(2.7, "ROH = -8.2"),
    ),
    (
        Trailer(
            length=_NORDIC(4.55, "A = 3.9 to the middle of axles 1.3 apart"),
            hitch=_NORDIC(2.5, "B = -8.0"),
            half_width=_HALF,
            front=assumed(0.0, "its rectangle holds the drawbar"),
            rear=_NORDIC(1.05, "ROH = -1.7"),
            articulation_max=DRAWBAR_ANGLE,
        ),
        Trailer(
            length=_NORDIC(7.7, "A = 6.4 to the middle of axles 2.6 apart"),
            hitch=_NORDIC(0.0, "B = -0.65 of the dolly"),
            half_width=_HALF,
            front=assumed(1.6, "that of the 13.6 m trailer of CommonRoad; OpenPBS has 1.1"),
            rear=_EMS(4.0, "what is left of 25.25 m; OpenPBS has 2.3"),
            articulation_max=RIGHT_ANGLE,
        ),
    ),
    **loaded_truck(),
)

_LONG_TRAILER_FRONT = assumed(1.6, "that of the 13.6 m trailer of CommonRoad; OpenPBS has 0.75")
_LONG_TRAILER_REAR = _EU(4.3, "12.0 m behind the kingpin less 7.7; OpenPBS has 1.7")

A_DOUBLE = combine(
    "a-double",
    "Swedish A-double: two semi-trailers and a dolly",
    Truck(
        length=_ADOUBLE(3.685, "to the middle of the axles at 3.0 and 4.37"),
        half_width=_HALF,
        front=_ADOUBLE(0.5, "FOH"),
        rear=_ADOUBLE(1.115, "ROH = -4.8"),
    ),
    (
        Trailer(
            length=_ADOUBLE(7.7, "A = 6.4 to the middle of axles 2.6 apart"),
            hitch=_ADOUBLE(-0.285, "B = -3.4 of the tractor"),
            half_width=_HALF,
            front=_LONG_TRAILER_FRONT,
            rear=_LONG_TRAILER_REAR,
            articulation_max=RIGHT_ANGLE,
        ),
        Trailer(
            length=_ADOUBLE(4.55, "A = 3.9 to the middle of axles 1.3 apart"),
            hitch=_ADOUBLE(2.7, "B = -4.0 of the semi-trailer"),
            half_width=_HALF,
            front=assumed(0.0, "its rectangle holds the drawbar"),
            rear=_ADOUBLE(0.9, "ROH = -1.55"),
            articulation_max=DRAWBAR_ANGLE,
        ),
        Trailer(
            length=_ADOUBLE(7.7, "A = 6.4 to the middle of axles 2.6 apart"),
            hitch=_ADOUBLE(0.0, "B = -0.65 of the dolly"),
            half_width=_HALF,
            front=_LONG_TRAILER_FRONT,
            rear=_LONG_TRAILER_REAR,
            articulation_max=RIGHT_ANGLE,
        ),
    ),
    **loaded_truck(),
)
