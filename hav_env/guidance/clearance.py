"""This module says how much room a vehicle needs beside the path of its truck's rear axle."""

from hav_env.vehicles.steady_circles import Floats, swept_ring


def clearance_of(
    radius: float,
    lengths: Floats,
    offsets: Floats,
    half_widths: Floats,
    fronts: Floats,
    rears: Floats,
) -> float:
    """Return how far bodies reach from the path of the rear axle, on a steady circle [m].

    It is half the width, and the off-tracking of the trailers to the inside or the swing of the
    front to the outside, the larger one. On the least circle that a chain can follow, its last axle
    stands on the centre: lattices need a wider one.

    Args:
        radius: of the truck's rear axle [m].
        lengths: (K,) of the units [m].
        offsets: (K,) how far behind the axle ahead each unit is hitched [m].
        half_widths: (K,) of the bodies [m].
        fronts: (K,) how far each body reaches ahead of its front axle or hitch [m].
        rears: (K,) how far each body reaches behind its axle [m].

    Raises:
        ValueError: when the chain cannot follow on that circle for good.
    """
    ring = swept_ring(radius, lengths, offsets, half_widths, fronts, rears)
    return max(radius - ring.inner, ring.outer - radius)
