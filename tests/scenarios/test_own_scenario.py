"""A scenario from outside the package passes the same checks as those inside."""

from typing import Annotated, NamedTuple

import pytest

from hav_env.models.annotations import Range
from hav_env.scenarios import RandomFleet, check_scenario, populate


class Placed(NamedTuple):
    """A scenario from outside the package."""

    num_havs: int = 1
    num_goals: int = 1
    trailers: Annotated[int, Range(1, 5)] = 1
    articulation_max: float = 1.5
    fleet: RandomFleet = RandomFleet()

    @property
    def max_trailers(self):
        """Return the number that a test has set."""
        return self.trailers


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({}, None),
        ({"num_havs": 2.0}, "scenario num_havs is 2.0"),
        ({"num_havs": 10**6}, "scenario num_havs is 1000000"),
        ({"num_goals": 0}, "scenario num_goals is 0"),
        ({"trailers": 6}, "scenario trailers is 6, but must be at least 1 and at most 5"),
        ({"articulation_max": 7.0}, "scenario articulation_max is 7.0"),
    ],
)
def test_a_scenario_from_outside_is_checked_too(changes, message, monkeypatch):
    monkeypatch.setitem(populate.table, Placed, lambda scenario, world, lane: True)
    if message is None:
        return check_scenario(Placed())
    with pytest.raises(ValueError, match=message):
        check_scenario(Placed()._replace(**changes))


def test_what_lacks_what_arrays_are_shaped_by_is_no_scenario(monkeypatch):
    class Shapeless(NamedTuple):
        num_havs: int = 1

    monkeypatch.setitem(populate.table, Shapeless, lambda scenario, world, lane: True)
    with pytest.raises(TypeError, match="scenario num_goals is None"):
        check_scenario(Shapeless())


def test_a_scenario_without_a_fleet_is_refused(monkeypatch):
    class Secret(NamedTuple):
        num_havs: int = 2
        num_goals: int = 1
        max_trailers: int = 2
        articulation_max: float = 1.5

    monkeypatch.setitem(populate.table, Secret, lambda scenario, world, lane: True)
    with pytest.raises(TypeError, match="but must have a fleet: its HAVs' limits"):
        check_scenario(Secret())
