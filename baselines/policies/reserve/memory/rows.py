"""This module names the rows of the memory of a HAV under Reserve.

The first rows are the broadcast. Other HAVs read them through
``hav_env.policies.interface.heard``. The next rows are the HAV's own: its path, its reserved
outline, and its senses. The last rows are scratch for the making of a plan.

A comment gives the unit in square brackets and the range. A *flag* is 0.0 or 1.0. A *count* is a
whole number from 0.0. Modules import this one as ``m`` and write ``rows[m.DRIVEN]``.
"""

from baselines.policies.reserve.memory.sizes import (
    ENDINGS,
    LINK_CORNERS,
    LONGLIST_SIZE,
    MAX_KNOWN,
    MAX_SEGMENTS,
    MAX_UNITS,
    SLOT_COUNT,
    TRIALS,
    TURN_RADII,
)
from hav_env.maths.kdop import SIDES


class _Counter:
    """Counts rows."""

    def __init__(self, first: int) -> None:
        """Begin with the row ``first``."""
        self.rows = first

    def next(self, count: int = 1) -> int:
        """Return the first of the next ``count`` rows."""
        self.rows += count
        return self.rows - count


_counter = _Counter(0)
_next = _counter.next

# The broadcast. A frame is x [m], y [m], cosine and sine of its heading, seen from the truck.
STAMP = _next()  # 1 + the step of the last broadcast, or 0.0 before the first one
MODE = _next()  # state of the HAV: STANDING, RESERVED or ARRIVED
FRAME_BEFORE = _next(4)  # frame of the outline before the step of STAMP
FRAME_AFTER = _next(4)  # frame of the outline after the step of STAMP
OUTLINE_RADIUS = _next()  # distance of the outline's farthest corner from its frame [m], >= 0
OUTLINE = _next(SIDES)  # extents of the reserved outline in its frame [m]
BROADCAST = _counter.rows  # number of rows of the broadcast

# The layout of a path, in rows from its first one.
NUM_SEGMENTS = 0  # count of segments, at most MAX_SEGMENTS
CURVATURES = 1  # curvature of each segment [1/m], positive to the left
LENGTHS = 1 + MAX_SEGMENTS  # length of each segment [m], > 0
_PATH_ROWS = 1 + 2 * MAX_SEGMENTS

# The path of the HAV.
CURRENT_PATH = _next(_PATH_ROWS)  # path that the HAV follows, from where it was planned
TRIAL_PATH = _next(_PATH_ROWS)  # path that is being tested
DRIVEN = _next()  # distance driven along the current path [m]
PLANNED_GOAL_HEADING = _next()  # goal's heading relative to the truck's at the last plan [rad]
PLANNED_GOALS_LEFT = _next()  # count of goals left when the HAV set out for this one
PAUSE = _next()  # steps until a lone HAV plans again

# The reservation: the path up to PART_END, then a circle or the stop at the goal.
PART_END = _next()  # end of the reserved part, as a distance along the path [m]
CIRCLE_SIDE = _next()  # side of the reserved circle: 1.0 left, -1.0 right, 0.0 none
CIRCLE_SHIFT = _next()  # straight distance from PART_END to the reserved circle [m], >= 0
PURPOSE = _next()  # purpose of the path: GOAL_PATH, PLACE_PATH or CIRCLE_PATH
HELD = _next()  # flag: the outline is disjoint from every outline that the HAV senses
KNOWN = _next()  # hash of the numbers and states of the neighbours near by
PREFERRED_SIDE = _next()  # side of the circle that is tried first: 1.0 left, -1.0 right
BLOCKED = _next()  # count of steps in a row that the HAV has stood with an outline reserved
FAILED = _next()  # count of failed plans since the last path to the goal
TRIES = _next()  # count of attempts to begin moving
ADOPTED = _next()  # count of paths to the goal that the HAV has set out on
EXPLORED = _next()  # number of the next sequence of pieces to try, below SEQUENCES
PLANNED_MARGIN = _next()  # margin to others with which the path was planned [m]
NUM_NEAR = _next()  # count of neighbours near by, when they were last noted
NEAR_NUMBERS = _next(MAX_KNOWN)  # numbers of those neighbours
DOOMED = _next()  # flag: a stationary HAV blocks the path ahead
REFRESH = _next()  # distance along the path at which the rest is reserved anew [m]

# The proposals of another policy, for which Reserve is the backup.
PROPOSED_GOALS_LEFT = _next()  # count of goals left when proposals for this one began
LISTENS_FROM = _next()  # step from which the HAV considers proposals
LISTENS_UNTIL = _next()  # step from which it leaves the way to this goal to Reserve
REFUSED = _next()  # count of refused proposals on the way to this goal

# The HAV's sensing of itself.
OWN_NUMBER = _next()  # number of the HAV, from 0.0
OWN_TRAILERS = _next()  # count of trailers, at most MAX_TRAILERS
OWN_LENGTHS = _next(MAX_UNITS)  # length of each unit, the truck first [m]
OWN_JOINTS = _next(2 * MAX_UNITS)  # cosine and sine of each articulation, the first one first
OWN_REACH = _next()  # radius round the truck's rear axle that holds the whole HAV [m]
OWN_FOOTPRINT = _next()  # sum of the trailers' lengths and a share of the truck's [m]
OWN_STEP = _next()  # distance of a step [m], > 0, or 0.0 before the HAV has sensed itself
OWN_STEERING_TANGENT = _next()  # tangent of the maximum steering angle, > 0
OWN_LEAST_COSINE = _next()  # cosine of the largest allowed articulation
OWN_FOLD_TURN = _next()  # least change of an articulation that may fold a joint through [rad]
OWN_TRUCK_RADIUS = _next()  # radius of the truck's tightest circle, l^0 / tan(phi^max) [m]
OWN_TRAILER_RADIUS = _next()  # least radius on which the trailers can follow without end [m]
OWN_CIRCLE_RADIUS = _next()  # radius of the circle that the HAV can drive on without end [m]
OWN_TIGHT = _next()  # flag: among others, the HAV may turn more tightly than its circle
OWN_SAG = _next()  # largest distance of an axle from its straight way within a step [m]
OWN_STRIDE = _next()  # largest distance that a point of the chain moves in a step [m]
OWN_REAR_RADIUS = _next()  # radius of the truck's rear axle round the circle's centre [m]
OWN_FRONT_RADIUS = _next()  # radius of the truck's front axle round the circle's centre [m]
OWN_GOAL = _next(5)  # goal: forward [m], left [m], relative heading [rad], its cosine and sine
OWN_GOALS_LEFT = _next()  # count of goals left
OWN_RANDOM_KEY = _next(3)  # seed, episode and step of the random numbers
GATHERED = _next()  # flag: the HAV has written the slots in this step
COVERED_RADIUS = _next()  # radius round the rear axle that no HAV without a slot enters [m]
NEWCOMERS = _next()  # count of others without a slot that have come near since the last note

# Scratch of a prediction.
PREDICTED_CHAIN = _next(2 * MAX_UNITS)  # cosine and sine of each unit's heading
AXLES = _next(2 * (MAX_UNITS + 1))  # x and y of each axle, the front one first [m]
PREVIOUS_AXLES = _next(2 * (MAX_UNITS + 1))  # the same a step before [m]
SWEPT_CORNERS = _next(2 * LINK_CORNERS)  # corners of a set that holds a link during a step [m]
SAVED_CHAIN = _next(2 * MAX_UNITS)  # copy of PREDICTED_CHAIN
SAVED_AXLES = _next(2 * (MAX_UNITS + 1))  # copy of AXLES [m]

# Scratch: arcs of tight paths. The turns from a straight chain are measured once: they stay.
RADII = _next(TURN_RADII)  # radii that the HAV tries, the truck's tightest first [m]
FIRST_TURNS_LEFT = _next(TURN_RADII)  # longest arc to the left from here [rad]
FIRST_TURNS_RIGHT = _next(TURN_RADII)  # longest arc to the right from here [rad]
LAST_TURNS = _next(TURN_RADII)  # longest arc that a straight chain begins [rad]
ENDING_RADII = _next(ENDINGS)  # radius of the last arc, for each ending of a candidate [m]
ENDING_FIRST_SIDES = _next(ENDINGS)  # side of the first arc, 1.0 left, -1.0 right
ENDING_LAST_SIDES = _next(ENDINGS)  # side of the last arc, the same
ENDING_LONGEST = _next(ENDINGS)  # length up to which a chain can follow the last arc [m]
TOTAL_LENGTHS = _next(ENDINGS)  # lengths of the candidates that were measured last [m]

# Scratch: the shortest candidates, sorted by length.
LISTED_LENGTHS = _next(LONGLIST_SIZE)  # length of each candidate [m]
LISTED_NUMBERS = _next(LONGLIST_SIZE)  # number of each candidate

# Scratch: outlines.
TRIAL_OUTLINE = _next(SIDES)  # extents of what is to be reserved [m]
BODY_OUTLINE = _next(SIDES)  # extents of what comes before the circle, or of the chain alone [m]
TURNED_OUTLINE = _next(SIDES)  # extents of an outline in another frame [m]

# Scratch: the nearest others, a slot each.
NUM_SLOTS = _next()  # count of slots in use, at most SLOT_COUNT
NUM_UNARRIVED = _next()  # count of others in slots that have not arrived at their goals

# The layout of a slot, in rows from its first one.
SLOT_KIND = 0  # state of the other HAV: STANDING or RESERVED
SLOT_FRAME = 1  # frame of its outline in the own frame: x [m], y [m], cosine, sine
SLOT_BROADCAST_OUTLINE = 5  # extents of its outline in its frame [m], if it has reserved that
SLOT_AXLES = 5  # x and y of each of its axles, if it stands [m]
_SLOT_PLACE = max(SIDES, 2 * (MAX_UNITS + 1))  # rows for either of both
SLOT_OUTLINE = 5 + _SLOT_PLACE  # extents of its outline in the own frame [m]
SLOT_NUM_AXLES = SLOT_OUTLINE + SIDES  # count of its axles if it stands
SLOT_NUMBER = SLOT_NUM_AXLES + 1  # its number
SLOT_ERROR = SLOT_NUM_AXLES + 2  # largest error of its sensed position [m], >= 0
SLOT_SAG = SLOT_NUM_AXLES + 3  # its largest sag if it stands and then begins to move [m]
SLOT_STRIDE = SLOT_NUM_AXLES + 4  # its largest stride if it stands and then begins to move [m]
SLOT_CLOSE = SLOT_NUM_AXLES + 5  # flag: it stands, and its chain is close
SLOT_ROWS = SLOT_NUM_AXLES + 6  # number of rows of a slot

FIRST_SLOT = _next(SLOT_COUNT * SLOT_ROWS)

ROWS = _counter.rows  # number of rows of the memory

# Scratch of a lone HAV, which has no slots: it lies in their rows.
_alone = _Counter(FIRST_SLOT).next

# Trials: predictions side by side, in one lane each.
TRIAL_TURN = _alone(TRIALS)  # turn of the unit ahead in this step, the truck's first [rad]
TRIAL_PULL = _alone(TRIALS)  # distance that the unit ahead moves in this step [m]
TRIAL_LEAST = _alone(TRIALS)  # least cosine of all articulations after this step
TRIAL_X = _alone(TRIALS)  # x of the truck's rear axle [m]
TRIAL_Y = _alone(TRIALS)  # y of the truck's rear axle [m]
TRIAL_HEADING = _alone(TRIALS)  # heading of the truck [rad]
TRIAL_DRIVEN = _alone(TRIALS)  # distance driven [m], from the goal on if the trial is beyond it
TRIAL_BEYOND = _alone(TRIALS)  # flag: the trial has hit the goal and goes straight on
TRIAL_RESULT = _alone(TRIALS)  # RUNNING, SURVIVED or DROPPED
TRIAL_PLACE = _alone(TRIALS)  # place of the candidate in the list
TRIAL_TOTAL = _alone(TRIALS)  # length of the candidate's path [m]
TRIAL_CURVATURES = _alone(3 * TRIALS)  # curvatures of its three segments [1/m]
TRIAL_LENGTHS = _alone(3 * TRIALS)  # lengths of its three segments [m], >= 0
TRIAL_CHAINS = _alone(2 * MAX_UNITS * TRIALS)  # cosine and sine of each unit's heading
