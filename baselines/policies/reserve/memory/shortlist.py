"""This module keeps a list of the shortest candidates, sorted by length."""

from baselines.policies.reserve.memory import rows as m
from hav_env.compiled import kernel


@kernel
def insert(rows, count, total, number, size):
    """Insert a candidate into the list. A full list drops its longest one.

    Args:
        rows: The HAV's memory.
        count: Number of candidates in the list.
        total: Length of the candidate [m].
        number: Number of the candidate.
        size: Most candidates in the list, at most ``sizes.LONGLIST_SIZE``.

    Returns:
        The number of candidates in the list afterwards.
    """
    place = count
    if count == size:
        if total >= rows[m.LISTED_LENGTHS + size - 1]:
            return count
        place, count = size - 1, size - 1
    while place > 0 and rows[m.LISTED_LENGTHS + place - 1] > total:
        rows[m.LISTED_LENGTHS + place] = rows[m.LISTED_LENGTHS + place - 1]
        rows[m.LISTED_NUMBERS + place] = rows[m.LISTED_NUMBERS + place - 1]
        place -= 1
    rows[m.LISTED_LENGTHS + place], rows[m.LISTED_NUMBERS + place] = total, number
    return count + 1
