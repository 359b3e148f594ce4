"""What a HAV under the policy Reserve remembers: the rows of its memory, by name.

The first rows are its broadcast: what other HAVs may read, through
``hav_env.policies.interface.heard``. The others are its own: what it is committed to, and scratch
in which plans are worked out.
"""

from hav_env.maths.kdop import SIDES

MOST_TRAILERS = 10
MOST_UNITS = MOST_TRAILERS + 1
MOST_SEGMENTS = 10  # of a path: arcs and straights
RADII = 8  # of tight turns that are tried
SHORTLIST = 48  # candidates that are looked at before the next ones are looked for
SLOTS = 24  # others that a plan takes into account: the nearest
MOST_KNOWN = 128  # others whose numbers are remembered
WAYPOINTS = 24  # poses by way of which a path may lead


class _Counter:
    """Counts rows."""

    def __init__(self) -> None:
        self.rows = 0

    def next(self, count: int = 1) -> int:
        """Return the first of the next ``count`` rows."""
        self.rows += count
        return self.rows - count


_counter = _Counter()
_next = _counter.next

# The broadcast.
STAMP = _next()  # 1 + the step in which it was written; 0: never
MODE = _next()  # STANDING, RESERVED or ARRIVED
BEFORE = _next(4)  # frame of the outline, seen from the truck before the step of STAMP
AFTER = _next(4)  # the same after that step: x [m], y [m], cosine, sine of its heading
RADIUS = _next()  # round the frame's origin, which holds the outline [m]
OUTLINE = _next(SIDES)  # of all that the HAV may occupy until it reserves anew [m]
BROADCAST = _counter.rows
STANDING, RESERVED, ARRIVED = 0.0, 1.0, 2.0

# A path: how many segments, curvature [1/m] and length [m] of each.
SEGMENTS, CURVATURES, LENGTHS = 0, 1, 1 + MOST_SEGMENTS
_PATH_ROWS = 1 + 2 * MOST_SEGMENTS
PATH = _next(_PATH_ROWS)  # the path under way, from where it was planned
TRIAL = _next(_PATH_ROWS)  # one that is being tried
DRIVEN = _next()  # how much of the path is done [m]
GOAL_HEADING = _next()  # of the goal in the truck's frame when the path was planned [rad]
GOALS_LEFT = _next()  # when the path was planned
PAUSE = _next()  # steps until the next plan is made

# What is reserved: the path up to a distance, and what may follow for ever.
END = _next()  # [m] along the path
SIDE = _next()  # of the circle that may follow, 1.0 left, -1.0 right; 0.0: stop at the goal
SHIFT = _next()  # straight on before the circle [m]
PURPOSE = _next()  # of the path: GOAL, PLACE or CIRCLE
HELD = _next()  # 1.0 when what is reserved is disjoint from all that is sensed
KNOWN = _next()  # a number that changes with who of those in sensing range stands
PREFERRED = _next()  # side
BLOCKED = _next()  # steps without moving
FAILED = _next()  # plans that were not found
TRIES = _next()  # to begin moving
ADOPTED = _next()  # paths to the goal that were taken
EXPLORED = _next()  # sequences that were tried as a last resort
MARGIN = _next()  # with which the path was planned [m]
COMPANY = _next()  # how many others are near
COMPANIONS = _next(MOST_KNOWN)  # their numbers
DOOMED = _next()  # 1.0 when somebody stands in the way farther on
REFRESH = _next()  # [m] of the path from which on the rest is reserved anew
GOAL, PLACE, CIRCLE = 0.0, 1.0, 2.0

# What the HAV senses of itself.
OWN_NUMBER = _next()
OWN_TRAILERS = _next()  # how many
OWN_LENGTHS = _next(MOST_UNITS)  # [m]
OWN_JOINTS = _next(2 * MOST_UNITS)  # cosine and sine of every articulation, from the first on
OWN_REACH = _next()  # round the truck's rear axle, which holds the whole HAV [m]
OWN_FOOTPRINT = _next()  # [m]
OWN_STEP = _next()  # what it drives in a step [m]; 0.0 until it has sensed itself
OWN_STEEPEST = _next()  # tangent of the maximum steering angle
OWN_BOUND = _next()  # cosine of the largest articulation that is allowed
OWN_WINDOW = _next()  # change of an articulation that may fold a joint through [rad]
OWN_TIGHTEST = _next()  # radius of the truck's tightest circle, l^0 / tan(phi^max) [m]
OWN_HITCH = _next()  # least radius on which trailers can follow for good [m]
OWN_CIRCLE = _next()  # radius of the circle that can be driven on for ever [m]
OWN_SAG = _next()  # how far an axle leaves the way from step to step, at most [m]
OWN_STRIDE = _next()  # how far a point of the chain moves in a step, at most [m]
OWN_REAR = _next()  # radii on which rear and front axle of the truck drive round its centre [m]
OWN_FRONT = _next()
OWN_GOAL = _next(5)  # the goal under way: forward, left [m], heading [rad], its cosine and sine
OWN_GOALS_LEFT = _next()
OWN_DICE = _next(3)  # seed, episode and step
GATHERED = _next()  # 1.0 when the others were gathered in this step
CLEAR = _next()  # round the truck's rear axle, within which nobody reaches who is in no slot [m]
STRANGERS = _next()  # others in no slot who were not near when that was last noted

# Scratch: a chain that is predicted (cosine, sine of each unit), its axles (x, y), where they were
# a step before, and the corners of what a link sweeps in that step.
CHAIN = _next(2 * MOST_UNITS)
AXLES = _next(2 * (MOST_UNITS + 1))
WERE = _next(2 * (MOST_UNITS + 1))
SWEPT = _next(2 * 5)
KEPT_CHAIN = _next(2 * MOST_UNITS)
KEPT_AXLES = _next(2 * (MOST_UNITS + 1))
# Scratch of the tight turns: how far [rad] an arc of each radius may turn, first and last.
FIRST_LEFT = _next(RADII)
FIRST_RIGHT = _next(RADII)
LAST = _next(RADII)
# Scratch: the shortest candidates, their lengths [m] and numbers.
LENGTH_OF = _next(SHORTLIST)
NUMBER_OF = _next(SHORTLIST)
# Scratch: outlines.
TRY = _next(SIDES)  # of what is to be reserved
BODY = _next(SIDES)  # of the chain alone
TURNED = _next(SIDES)  # an own outline in another HAV's frame
# Scratch: the others near by, a slot each: what it is, where its frame is, its outline there and in
# the own frame, how many axles.
NUM_SLOTS = _next()
NUM_RESTLESS = _next()  # of them who are not at their goals
CLOSE = (
    5  # in the slot of one that stands, which has no outline of its own: whether to look closely
)
KIND, FRAME, RAW, SEEN, NUM_AXLES = 0, 1, 5, 5 + SIDES, 5 + 2 * SIDES
NUMBER = NUM_AXLES + 1  # of that HAV
DOUBT = NUM_AXLES + 2  # how far off it may be sensed [m]
SAG, STRIDE = NUM_AXLES + 3, NUM_AXLES + 4  # of one that stands, if it should set off [m]
SLOT_AXLES = NUM_AXLES + 5
SLOT_ROWS = SLOT_AXLES + 2 * (MOST_UNITS + 1)
SLOT = _next(SLOTS * SLOT_ROWS)

ROWS = _counter.rows
