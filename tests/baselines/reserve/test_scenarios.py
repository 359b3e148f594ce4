"""Reserve in scenes that look like a deadlock: all HAVs arrive, and none touches another."""

import math

import pytest

from hav_env import explicit, find_scenario
from tests.support.audit import drive
from tests.support.budgets import budget

EAST, NORTH, WEST = 0.0, math.pi / 2, math.pi
SMALL, LONG = [4.0, 5.0, 5.0], [4.0, 8.0, 8.0, 8.0]


def parked(*poses, lengths=(4.0, 8.0)):
    """Return HAVs whose goals are their start positions, as (lengths, start, goals)."""
    return [(lengths, pose, [pose]) for pose in poses]


def scene(havs):
    """Return a scenario of (lengths, start, goals)."""
    lengths, start, goals = zip(*havs, strict=True)
    return explicit(lengths, start, goals)


NOSE_TO_NOSE = scene(
    [
        (SMALL, (0.0, 0.0, EAST), [(60.0, 0.0, EAST), (0.0, 0.0, WEST)]),
        (SMALL, (30.0, 0.0, WEST), [(-30.0, 0.0, WEST), (30.0, 0.0, EAST)]),
    ]
)
LONG_NOSE_TO_NOSE = scene(
    [
        (LONG, (0.0, 0.0, EAST), [(90.0, 0.0, EAST)]),
        (LONG, (50.0, 0.0, WEST), [(-40.0, 0.0, WEST)]),
    ]
)
CORRIDOR = scene(
    [
        (SMALL, (-40.0, 0.0, EAST), [(140.0, 0.0, EAST)]),
        (SMALL, (140.0, 0.0, WEST), [(-40.0, 0.0, WEST)]),
        *parked(*((20.0 * k, side, EAST) for k in range(6) for side in (-10.0, 10.0))),
    ]
)
BEHIND_ONE_PARKED = scene(
    [
        (SMALL, (0.0, 0.0, EAST), [(64.0, 0.0, EAST)]),
        *parked((38.0, 4.0, NORTH), lengths=(4.0, 8.0, 8.0)),
    ]
)
CLOSE_BEHIND_ONE_PARKED = scene(
    [
        (SMALL, (0.0, 0.0, EAST), [(52.0, 0.0, EAST)]),
        *parked((47.0, 18.1, NORTH), lengths=(4.0, 8.0)),
        *parked((39.5, -1.0, EAST), lengths=(4.0, 2.0)),
    ]
)
COLUMNS = scene(
    [
        *((SMALL, (-back, 0.0, EAST), [(160.0 - back, 0.0, EAST)]) for back in (40, 64, 88)),
        *((SMALL, (0.0, -back, NORTH), [(0.0, 160.0 - back, NORTH)]) for back in (40, 64, 88)),
    ]
)
SCENES = {
    "nose to nose": NOSE_TO_NOSE,
    "nose to nose, long": LONG_NOSE_TO_NOSE,
    "corridor": CORRIDOR,
    "behind one that is parked": BEHIND_ONE_PARKED,
    "close behind one that is parked": CLOSE_BEHIND_ONE_PARKED,
    "crossing columns": COLUMNS,
    "crossing-8": find_scenario("crossing-8"),
}


@pytest.mark.parametrize("name", SCENES)
def test_everybody_arrives(name):
    seen = drive(SCENES[name], 3, range(budget(3, 1)), budget(10_000, 2))
    seen.approve()
    assert budget(seen.worlds.state.waiting.all(), True)
