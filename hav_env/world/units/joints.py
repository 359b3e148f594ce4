"""This module derives quantities from the hitches of trailers: chains, limits, least radii.

The type of ``fleet.joints`` selects each function, see ``hav_env.world.units.parts``. The lines of
a HAV follow one another from front to rear. The truck's begins at its front axle, a trailer's at
its hitch. A line ends at the axle of its unit, or at the unit's own hitch if that is behind the
axle.
"""

from hav_env.compiled import generic
from hav_env.maths.elementary import sincos
from hav_env.maths.hitched_circle import add_joint
from hav_env.world.units.parts import Hitches, OnAxles


@generic
def hitch_on_axles(joints, agent, lane, limit):
    """Hitch all trailers of a HAV on the axles ahead, and give every joint the same limit [rad]."""


@generic
def hitch_trailer(joints, agent, unit, lane, offset, limit):
    """Set the distance from a unit's axle back to its trailer's hitch [m], and the unit's limit.

    The limit is that of the unit's articulation [rad]; the truck has none.
    """


@generic
def hitch_offset(joints, agent, unit, lane):
    """Return the distance from a unit's axle back to its trailer's hitch [m]."""


@generic
def joint_limit(joints, usual, agent, joint, lane):
    """Return the limit of an articulation [rad], given that of the HAV; joint 1 is the first."""


@generic
def unit_spans(joints, fleet, agent, unit, lane):
    """Return two lengths from the front end of a unit backwards [m], 0 beyond the HAV's last one.

    Returns:
        The first is the length of its line; the second is the distance to the front end of the unit
        behind.
    """


@generic
def least_squared_radius(joints, fleet, agent, lane):
    """Return the square of R_min [m^2], the radius of the truck's front axle, eq. (17).

    With off-axle hitches it is that of the tightest circle on which no articulation exceeds its
    limit.
    """


@hitch_on_axles.register(OnAxles)
def _have_no_hitches(joints, agent, lane, limit):
    pass


@hitch_on_axles.register(Hitches)
def _set_hitches(joints, agent, lane, limit):
    for unit in range(joints.offset.shape[1]):
        joints.offset[agent, unit, lane] = 0.0
        joints.limit[agent, unit, lane] = limit


@hitch_trailer.register(OnAxles)
def _keep_on_axle(joints, agent, unit, lane, offset, limit):
    pass


@hitch_trailer.register(Hitches)
def _set_hitch(joints, agent, unit, lane, offset, limit):
    joints.offset[agent, unit, lane] = offset
    joints.limit[agent, unit, lane] = limit


@hitch_offset.register(OnAxles)
def _no_offset(joints, agent, unit, lane):
    return 0.0


@hitch_offset.register(Hitches)
def _offset_of(joints, agent, unit, lane):
    return joints.offset[agent, unit, lane]


@joint_limit.register(OnAxles)
def _usual_limit(joints, usual, agent, joint, lane):
    return usual


@joint_limit.register(Hitches)
def _limit_of(joints, usual, agent, joint, lane):
    return joints.limit[agent, joint, lane]


@unit_spans.register(OnAxles)
def _span_to_axle(joints, fleet, agent, unit, lane):
    present = unit <= fleet.num_trailers[agent, lane]
    length = fleet.length[agent, unit, lane] if present else 0.0
    return length, length


@unit_spans.register(Hitches)
def _span_to_hitch(joints, fleet, agent, unit, lane):
    present = unit <= fleet.num_trailers[agent, lane]
    length = fleet.length[agent, unit, lane] if present else 0.0
    offset = joints.offset[agent, unit, lane] if present else 0.0
    return length + max(offset, 0.0), length + offset


@least_squared_radius.register(OnAxles)
def _sum_of_squares(joints, fleet, agent, lane):
    truck = fleet.length[agent, 0, lane]
    squares = truck * truck
    for unit in range(1, fleet.num_trailers[agent, lane] + 1):
        length = fleet.length[agent, unit, lane]
        squares += length * length
    return squares


@least_squared_radius.register(Hitches)
def _largest_sum_of_squares(joints, fleet, agent, lane):
    truck = fleet.length[agent, 0, lane]
    least = lost = truck * truck
    for unit in range(1, fleet.num_trailers[agent, lane] + 1):
        length, offset = fleet.length[agent, unit, lane], joints.offset[agent, unit - 1, lane]
        _, cosine = sincos(joints.limit[agent, unit, lane])
        least, lost = add_joint(least, lost, length, offset, cosine)
    return least
