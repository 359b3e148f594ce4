"""This module computes the least circle of a chain of trailers, joint by joint, on floats.

A trailer of length l is hitched ``offset`` c behind the axle of the unit ahead. c > 0 is a drawbar
coupling, c = 0 the paper's hitch on the axle, c < 0 a fifth wheel ahead of the axle. On a steady
circle r_j^2 = r_{j-1}^2 + c_j^2 - l_j^2, where r_j is the radius of axle j. ``add_joint`` processes
the joints from front to rear; ``hav_env.vehicles.steady_circles`` does so for whole chains.
"""

from hav_env.compiled import kernel


@kernel
def needed_squared(length, offset, cos_limit):
    """Return the least squared radius [m^2] of the axle ahead for one joint on a steady circle.

    It is (c^2 + l^2 + 2 c l cos b) / sin^2 b - c^2 if the limit b binds. Otherwise it is l^2 - c^2,
    where the trailer's axle is at the centre. It binds for b < 90 degrees + asin(c / l). With c = 0
    and b >= 90 degrees this is l * l to the bit.

    Args:
        length: Length l from the hitch to the trailer's axle [m].
        offset: Offset c of the hitch behind the axle ahead [m].
        cos_limit: Cosine of the largest articulation b of the joint.
    """
    binds = offset + length * cos_limit > 0.0
    hitch_apart = offset * offset + length * length + 2.0 * offset * length * cos_limit
    sine_squared = 1.0 - cos_limit * cos_limit  # 1 for the cosine of pi / 2, which is above 0
    bent = hitch_apart / (sine_squared if binds else 1.0) - offset * offset
    return bent if binds else length * length - offset * offset


@kernel
def add_joint(least_squared, lost_squared, length, offset, cos_limit):
    """Return ``least_squared`` and ``lost_squared`` with one more trailer behind.

    Both begin at 0 for the circle of the truck's rear axle. For the circle of its front axle, the
    paper's reference, they begin at the truck's length squared. On-axle chains without limits below
    90 degrees end at l_0^2 + l_1^2 + ..., added in this order, the square of the paper's R_min, eq.
    (rmin).

    Args:
        least_squared: Least squared radius [m^2] of the joints so far.
        lost_squared: Sum of l^2 - c^2 [m^2] over the trailers so far; it may decrease.
        length: Length of the trailer [m].
        offset: Distance of the hitch behind the axle ahead [m].
        cos_limit: Cosine of the joint's largest articulation.
    """
    needed = lost_squared + needed_squared(length, offset, cos_limit)
    lost = lost_squared + (length * length - offset * offset)
    return max(least_squared, needed), lost
