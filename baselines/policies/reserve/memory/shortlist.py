"""This module keeps a list of the shortest candidates, sorted by length."""

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import sizes
from hav_env.compiled import kernel


@kernel
def insert(rows, count, total, number):
    """Insert a candidate into the list. A full list drops its longest one.

    Args:
        rows: The HAV's memory.
        count: Number of candidates in the list.
        total: Length of the candidate [m].
        number: Number of the candidate.

    Returns:
        The number of candidates in the list afterwards.
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
