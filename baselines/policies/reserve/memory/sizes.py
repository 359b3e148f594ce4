"""This module states the sizes of the memory of a HAV under Reserve."""

MAX_TRAILERS = 10  # of a HAV
MAX_UNITS = MAX_TRAILERS + 1  # of a HAV: the truck and its trailers
LINK_CORNERS = 5  # of what a link sweeps in a step: both ends before and after, and one ahead
MAX_SEGMENTS = 10  # arcs and straights of a path: 7 of a sequence and 3 of the word behind it
TURN_RADII = 8  # radii of arcs that a HAV tries when it is alone
ENDINGS = 4 * TURN_RADII  # radii of the last arc, and sides of the first and the last one
TRIALS = 2 * TURN_RADII  # paths that a lone HAV predicts side by side: an arc to each side
SHORTLIST_SIZE = 48  # candidates that are sorted at a time
TIGHT_PATHS = 8  # tight candidates that a HAV among others tries, the shortest ones
LONGLIST_SIZE = SHORTLIST_SIZE + TIGHT_PATHS  # candidates of which a HAV among others takes one
SLOT_COUNT = 24  # others that a HAV takes into account at a time, the nearest ones
MAX_KNOWN = 128  # others whose numbers a HAV remembers
WAYPOINTS = 24  # random poses through which a candidate may lead
