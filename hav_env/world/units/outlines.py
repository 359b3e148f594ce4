"""This module sets the bodies of units: rectangles as long as the units, with width and overhangs.

The type of ``fleet.bodies`` selects each function, see ``hav_env.world.units.parts``.
"""

from hav_env.compiled import generic, kernel
from hav_env.maths.elementary import sqrt
from hav_env.world.units.joints import hitch_offset
from hav_env.world.units.parts import FRONT, HALF_WIDTH, REAR, Lines, Outlines


@generic
def shape_as_usual(bodies, agent, lane):
    """Give all units of a HAV the bodies that the model states, before a fleet replaces them."""


@generic
def shape_unit(bodies, agent, unit, lane, half_width, front, rear):
    """Give a unit a body: half its width, and its overhangs in front and behind [m]."""


@generic
def find_reach(bodies, fleet, agent, lane):
    """Find the radius [m] round the truck's rear axle that holds a HAV in every posture."""


@shape_as_usual.register(Lines)
def _have_no_shape(bodies, agent, lane):
    pass


@shape_as_usual.register(Outlines)
def _set_shape(bodies, agent, lane):
    usual = bodies.usual
    for unit in range(bodies.shape.shape[1]):
        shape_unit(bodies, agent, unit, lane, 0.5 * usual.width, usual.front, usual.rear)


@shape_unit.register(Lines)
def _keep_no_shape(bodies, agent, unit, lane, half_width, front, rear):
    pass


@shape_unit.register(Outlines)
def _shape_one(bodies, agent, unit, lane, half_width, front, rear):
    bodies.shape[agent, unit, HALF_WIDTH, lane] = half_width
    bodies.shape[agent, unit, FRONT, lane] = front
    bodies.shape[agent, unit, REAR, lane] = rear


@find_reach.register(Lines)
def _keep_no_reach(bodies, fleet, agent, lane):
    pass


@find_reach.register(Outlines)
def _measure_reach(bodies, fleet, agent, lane):
    """Sum the largest distances of each hitch, and add the farthest corner from there.

    The truck's front end is its wheelbase ahead of its rear axle, the origin of all distances.
    """
    shape, most, hitch = bodies.shape, 0.0, 0.0
    for unit in range(fleet.num_trailers[agent, lane] + 1):
        length = fleet.length[agent, unit, lane]
        ahead, behind = shape[agent, unit, FRONT, lane], shape[agent, unit, REAR, lane]
        if unit == 0:
            ahead += length
            hitch = abs(hitch_offset(fleet.joints, agent, 0, lane))
            along = max(ahead, behind)
            most = _diagonal(along, shape[agent, 0, HALF_WIDTH, lane])
        else:
            along = max(ahead, length + behind)
            corner = _diagonal(along, shape[agent, unit, HALF_WIDTH, lane])
            most = max(most, hitch + corner)
            hitch += abs(length + hitch_offset(fleet.joints, agent, unit, lane))
    bodies.reach[agent, lane] = most


@kernel
def _diagonal(along, across):
    return sqrt(along * along + across * across)
