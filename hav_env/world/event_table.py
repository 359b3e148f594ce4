"""This module declares the events that can happen to a HAV: jackknifes, collisions and others.

Tables, reports, figures, drawings and the replay page iterate over ``EVENTS``. A new event is one
entry here, one row of ``Record.first``, and the rule that records it.
"""

from typing import NamedTuple

from hav_env.compiled import generic, kernel
from hav_env.world.arrays import ACTUAL, JACKKNIFE, NEVER, OBSTACLE, POTENTIAL, WHEN
from hav_env.world.place.segments import Obstacles, Plane


class Event(NamedTuple):
    """An event whose first occurrence in an episode is recorded."""

    name: str
    """Name of its column in the table, and of its entry in the report."""
    row: int
    """Row of ``Record.first``."""
    stem: str
    """Beginning of the names of the columns for step and place."""
    place: str
    """Meaning of WHERE: the "joint" of the HAV, the "partner" in a collision, the "segment"."""
    label: str
    """Name of its figure."""
    state: str
    """Adjective for a HAV to which it has happened."""
    happens: str
    """Verb for a HAV to which it happens now."""
    sign: str
    """Character that marks it in lists."""
    color: str
    """Key of its colour in drawings: "alert" or "warning"."""
    company: bool
    """Whether it needs another HAV."""
    harm: bool
    """Whether a HAV to which it has happened has failed."""
    obstacles: bool = False
    """Whether it needs obstacles: worlds without obstacles have no row for it."""


EVENTS = (
    Event(
        name="jackknifed",
        row=JACKKNIFE,
        stem="jackknife",
        place="joint",
        label="jackknifed",
        state="jackknifed",
        happens="jackknifes",
        sign="∠",
        color="alert",
        company=False,
        harm=True,
    ),
    Event(
        name="potential_collision",
        row=POTENTIAL,
        stem="potential_collision",
        place="partner",
        label="potential collision",
        state="circles met",
        happens="potential collision",
        sign="○",
        color="warning",
        company=True,
        harm=False,
    ),
    Event(
        name="actual_collision",
        row=ACTUAL,
        stem="actual_collision",
        place="partner",
        label="actual collision",
        state="collided",
        happens="actual collision",
        sign="✕",
        color="alert",
        company=True,
        harm=True,
    ),
    Event(
        name="obstacle_collision",
        row=OBSTACLE,
        stem="obstacle_collision",
        place="segment",
        label="obstacle collision",
        state="hit an obstacle",
        happens="obstacle collision",
        sign="▲",
        color="alert",
        company=False,
        harm=True,
        obstacles=True,
    ),
)
HARM = tuple(event for event in EVENTS if event.harm)
_HARM_ROWS = tuple(event.row for event in HARM if not event.obstacles)


def happened(first, event: Event):
    """Return to which HAVs an event has happened, from ``Record.first`` (N, E, 2, ...)."""
    return first[:, event.row, WHEN] != NEVER


def events_in(first) -> tuple[Event, ...]:
    """Return the events that can happen in worlds, given their ``Record.first``, in its order."""
    return EVENTS[: first.shape[1]]


@kernel
def unharmed(world, agent, lane):
    """Return whether no event that means failure has happened to a HAV."""
    first, harmed = world.record.first, False
    for row in _HARM_ROWS:
        harmed = harmed | (first[agent, row, WHEN, lane] != NEVER)
    return not (harmed | (obstacle_hit_at(world.place, world, agent, lane) != NEVER))


@generic
def obstacle_hit_at(place, world, agent, lane):
    """Return the step in which a HAV first collided with an obstacle, or NEVER."""


@obstacle_hit_at.register(Plane)
def _never_hit(place, world, agent, lane):
    return NEVER


@obstacle_hit_at.register(Obstacles)
def _hit_at(place, world, agent, lane):
    return world.record.first[agent, OBSTACLE, WHEN, lane]
