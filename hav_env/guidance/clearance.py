"""This module computes the clearance of a vehicle beside the path of its truck's rear axle."""

from hav_env.vehicles.steady_circles import Floats, swept_ring


def clearance_of(
    radius: float,
    lengths: Floats,
    offsets: Floats,
    half_widths: Floats,
    fronts: Floats,
    rears: Floats,
) -> float:
    """Return the largest distance of bodies from the path of the rear axle, on a steady circle [m].

    It is half the width plus the larger of two distances: the off-tracking of the trailers to the
    inside, and the swing of the front to the outside. On the least circle that a chain can follow,
    its last axle stands on the centre: lattices need a wider circle.

    Args:
        radius: Radius of the circle of the truck's rear axle [m].
        lengths: (K,) Lengths of the units [m].
        offsets: (K,) Hitch offset of each unit [m].
        half_widths: (K,) Half the width of each body [m].
        fronts: (K,) Overhang of each body ahead of its front axle or hitch [m].
        rears: (K,) Overhang of each body behind its axle [m].

    Raises:
        ValueError: If the chain cannot follow on that circle for good.
    """
    ring = swept_ring(radius, lengths, offsets, half_widths, fronts, rears)
    return max(radius - ring.inner, ring.outer - radius)
