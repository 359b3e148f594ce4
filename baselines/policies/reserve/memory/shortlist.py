"""The shortest candidates, sorted by length."""

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import sizes
from hav_env.compiled import kernel


@kernel
def insert(rows, count, total, number):
    """Insert a candidate of some length [m] into the list; the longest falls out of a full one.

    Returns:
        How many there are then.
    """
    place = count
    if count == sizes.SHORTLIST_SIZE:
        if total >= rows[m.LISTED_LENGTHS + sizes.SHORTLIST_SIZE - 1]:
            return count
        place, count = sizes.SHORTLIST_SIZE - 1, sizes.SHORTLIST_SIZE - 1
    while place > 0 and rows[m.LISTED_LENGTHS + place - 1] > total:
        rows[m.LISTED_LENGTHS + place] = rows[m.LISTED_LENGTHS + place - 1]
        rows[m.LISTED_NUMBERS + place] = rows[m.LISTED_NUMBERS + place - 1]
        place -= 1
    rows[m.LISTED_LENGTHS + place], rows[m.LISTED_NUMBERS + place] = total, number
    return count + 1
