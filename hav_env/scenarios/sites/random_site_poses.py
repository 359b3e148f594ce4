"""This module defines random fleets at random poses on a site, clear of obstacles."""

import math
from typing import NamedTuple

from hav_env.compiled import kernel
from hav_env.maths.random_numbers import uniform
from hav_env.maths.rectangles import rectangle_gap
from hav_env.models.checks import check_relations
from hav_env.models.quantities import Attempts, Gap, Goals, Havs, Widening, WorldAttempts
from hav_env.places.site import BOUNDARY, Site, is_inside
from hav_env.scenarios.fleets import Fleets, RandomFleet, draw_fleet, scenario_key
from hav_env.scenarios.sites.field import keep_starts, put_at_start
from hav_env.scenarios.sites.witness import PlacedWalls, begin_way, drive_witness
from hav_env.world.arrays import HEADING, X, Y, put_straight
from hav_env.world.chain import ends_behind, front_axle
from hav_env.world.collision import reach, squared_distance
from hav_env.world.obstacles.collisions import gap_to_segment
from hav_env.world.place.segments import place_site, segment_of
from hav_env.world.rectangle_bodies import body_of


class RandomSitePoses(NamedTuple):
    """Random HAVs at random poses among the obstacles of a site, inside its boundary.

    At starts and goals HAVs are straight. All bodies keep a distance from all segments, and from
    the other HAVs of the same phase: all starts, all first goals, and so on. Footprint circles may
    overlap. Trucks are inside the boundary and outside polygons. Without a boundary, poses lie in
    the box round all segments.

    With ``free_ways`` each HAV alone can reach its goals: its bodies touch nothing along its
    shortest Dubins paths. Paths of different HAVs may cross.
    """

    site: Site
    """Walls, kerbs and bounds."""
    num_havs: Havs = 1
    """Number of HAVs."""
    num_goals: Goals = 2
    """Number of consecutive goals of each HAV."""
    fleet: Fleets = RandomFleet()
    """Trucks and trailers."""
    margin: Gap = 0.5
    """Least distance of bodies from segments and from the bodies of other HAVs [m]."""
    free_ways: bool = False
    """Whether each HAV alone can drive to its goals without a detour round obstacles."""
    widening: Widening = 1.1
    """Radius of the turns of these paths over the least steady radius of a HAV."""
    pose_attempts: Attempts = 1_000
    """Attempts to place one HAV before the world is drawn again, with another fleet."""
    world_attempts: WorldAttempts = 50
    """Attempts to draw a world before the draw fails."""

    @property
    def max_trailers(self) -> int:
        """The fleet's."""
        return self.fleet.max_trailers

    @property
    def articulation_max(self) -> float:
        """The fleet's [rad]."""
        return self.fleet.articulation_max

    @property
    def num_segments(self) -> int:
        """Number S of segments of the site."""
        return self.site.num_segments


@check_relations.register
def _(scenario: RandomSitePoses) -> None:
    check_relations(scenario.site)
    if scenario.site.num_segments == 0:
        raise ValueError("scenario site has no segments, but must have at least one")


def populate_random_site_poses(scenario, world, lane):
    """Draw one world; draw worlds without space for a pose again, a bounded number of times."""
    place_site(world.place, scenario.site, lane)
    key, box = scenario_key(world, lane), _box_of(scenario.site)
    draw = 0
    for _ in range(scenario.world_attempts):
        draw = draw_fleet(scenario.fleet, world.fleet, lane, key, draw)
        # phase -1 means the starts, which are drawn into the rows of the first goals
        for phase in range(-1, scenario.num_goals):
            draw = _place_phase(scenario, world, phase, box, lane, key, draw)
            if draw < 0:
                break
            if phase < 0:
                keep_starts(scenario, world, lane)
        # the tests of single goals began straight, but HAVs are straight at their starts only
        if draw >= 0 and (not scenario.free_ways or _drive_all_ways(scenario, world, lane)):
            for agent in range(scenario.num_havs):
                put_at_start(world, agent, lane)
            return True
        draw = abs(draw)
    return False


@kernel
def _box_of(site):
    """Return least and greatest x, least and greatest y [m] of the boundary, if there is one."""
    bounded = False
    for kind in site.kind:
        bounded = bounded or kind == BOUNDARY
    left, right, low, high = math.inf, -math.inf, math.inf, -math.inf
    for s in range(site.segment.shape[0]):
        if not bounded or site.kind[site.outline[s]] == BOUNDARY:
            ax, ay, bx, by = site.segment[s]
            left, right = min(left, ax, bx), max(right, ax, bx)
            low, high = min(low, ay, by), max(high, ay, by)
    return left, right, low, high


@kernel
def _place_phase(scenario, world, phase, box, lane, key, draw):
    """Draw the goals of a phase, or starts (-1); return the next draw, negative without space.

    Afterwards all HAVs are straight at their goals.
    """
    (left, right, low, high), row = box, max(phase, 0)
    for agent in range(scenario.num_havs):
        free = False
        for _ in range(scenario.pose_attempts):
            x = left + (right - left) * uniform(*key, draw)
            y = low + (high - low) * uniform(*key, draw + 1)
            heading = 2.0 * math.pi * uniform(*key, draw + 2)
            draw += 3
            if not is_inside(scenario.site, x, y):
                continue
            put_straight(world.state, agent, lane, x, y, heading)
            if not _is_clear(scenario, world, agent, lane):
                continue
            world.goals[agent, row, X, lane] = x
            world.goals[agent, row, Y, lane] = y
            world.goals[agent, row, HEADING, lane] = heading
            free = True
            if phase >= 0 and scenario.free_ways:
                free = _is_way_free(scenario, world, agent, phase, lane)
                put_straight(world.state, agent, lane, x, y, heading)
            if free:
                break
        if not free:
            return -draw
    return draw


@kernel
def _is_way_free(scenario, world, agent, phase, lane):
    """Return whether a HAV that starts straight at the previous pose can drive to a goal."""
    if phase == 0:
        put_at_start(world, agent, lane)
    else:
        x, y, heading = world.goals[agent, phase - 1, :, lane]
        put_straight(world.state, agent, lane, x, y, heading)
    _begin_way(scenario, world, agent, lane)
    return _drive_way(scenario, world, agent, phase, lane)


@kernel
def _drive_all_ways(scenario, world, lane):
    """Return whether all HAVs, each alone, can drive from their starts to all goals."""
    for agent in range(scenario.num_havs):
        put_at_start(world, agent, lane)
        _begin_way(scenario, world, agent, lane)
        for phase in range(scenario.num_goals):
            if not _drive_way(scenario, world, agent, phase, lane):
                return False
    return True


@kernel
def _begin_way(scenario, world, agent, lane):
    begin_way(world, agent, lane)
    for number in range(scenario.site.segment.shape[0]):
        world.place.due[world.first + lane, agent, number] = 0.0


@kernel
def _drive_way(scenario, world, agent, phase, lane):
    """Drive a HAV from its pose to a goal; return whether it touches no segment."""
    walls, goal = PlacedWalls(scenario.site.segment.shape[0]), world.goals[agent, phase, :, lane]
    return drive_witness(walls, world, agent, lane, goal, scenario.widening, scenario.margin)


@kernel
def _is_clear(scenario, world, agent, lane):
    """Return whether a HAV keeps its distance from all segments and from earlier HAVs."""
    for number in range(scenario.site.segment.shape[0]):
        segment = segment_of(world.place, number, lane)
        if gap_to_segment(world, agent, segment, lane) <= scenario.margin:
            return False
    for other in range(agent):
        if _too_near(world, agent, other, scenario.margin, lane):
            return False
    return True


@kernel
def _too_near(world, agent, other, margin, lane):
    """Return whether bodies of two HAVs may be nearer than a distance [m]; True in doubt."""
    far = reach(world.fleet, agent, lane) + reach(world.fleet, other, lane) + margin
    if squared_distance(world, agent, other, lane) > far * far:
        return False
    bodies = world.fleet.bodies
    x, y = front_axle(world, agent, lane)
    for unit in range(world.fleet.num_trailers[agent, lane] + 1):
        own = body_of(bodies, world, agent, unit, lane, x, y)
        to_x, to_y = front_axle(world, other, lane)
        for to in range(world.fleet.num_trailers[other, lane] + 1):
            body = body_of(bodies, world, other, to, lane, to_x, to_y)
            if rectangle_gap(own, body) <= margin:
                return True
            _, _, to_x, to_y = ends_behind(world, other, to, lane, to_x, to_y)
        _, _, x, y = ends_behind(world, agent, unit, lane, x, y)
    return False
