"""The shortest candidates, sorted by length."""

from baselines.policies.reserve.memory.rows import LENGTH_OF, NUMBER_OF, SHORTLIST
from hav_env.compiled import kernel


@kernel
def insert(rows, count, total, number):
    """Insert a candidate of some length [m] into the list; the longest falls out of a full one.

    Returns:
        How many there are then.
    """
    place = count
    if count == SHORTLIST:
        if total >= rows[LENGTH_OF + SHORTLIST - 1]:
            return count
        place, count = SHORTLIST - 1, SHORTLIST - 1
    while place > 0 and rows[LENGTH_OF + place - 1] > total:
        rows[LENGTH_OF + place] = rows[LENGTH_OF + place - 1]
        rows[NUMBER_OF + place] = rows[NUMBER_OF + place - 1]
        place -= 1
    rows[LENGTH_OF + place], rows[NUMBER_OF + place] = total, number
    return count + 1
