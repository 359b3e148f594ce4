"""This module lists the readings that a search tries: natural choices for each open question."""

import itertools
import math
from collections.abc import Iterator

from baselines.experiments.published import JACKKNIFE_FIGURE
from baselines.experiments.readings import TEXT, Reading, circles, vary
from hav_env.evaluation.figures import FOLDED_THROUGH

DEGREES = (30, 34, 36, 38, 40, 42, 45, 50, 55)
CLOSE_FACTORS = (1.0, 1.5, 2.0, 2.5, 3.0, 3.25, 3.5, 3.75, 4.0, 4.5, 5.0)
COUNTS = {
    "cut, moved": (0.0, False),
    "cut, redrawn": (0.0, True),
    "rounded, moved": (0.5, False),
    "rounded, redrawn": (0.5, True),
}
CIRCLES = {
    "axle, trailers": (0.0, 0.0),
    "axle, 1/2 truck": (0.0, 0.5),
    "axle, truck": (0.0, 1.0),
    "centre, 1/2 truck": (0.5, 0.5),
    "centre, truck": (0.5, 1.0),
    "front, truck": (1.0, 1.0),
}
RECORDS = (10, 100)  # steps between recorded poses, in addition to every step


def single_readings() -> Iterator[Reading]:
    """Yield the readings that differ for single HAVs."""
    for degrees, close, simultaneous, (counts, (offset, redraw)), jackknifed in itertools.product(
        DEGREES, CLOSE_FACTORS, (False, True), COUNTS.items(), (JACKKNIFE_FIGURE, FOLDED_THROUGH)
    ):
        yield vary(
            TEXT,
            f"{degrees} deg, close {close:g}, {'at once' if simultaneous else 'in order'},"
            f" {counts}, {jackknifed.name}",
            policy={"close_factor": close},
            fleet={
                "steering_max": math.radians(degrees),
                "trailer_offset": offset,
                "trailer_redraw": redraw,
            },
            vehicle={"simultaneous": simultaneous},
            jackknifed=jackknifed,
        )


def pair_readings(reading: Reading) -> Iterator[Reading]:
    """Yield the readings of pairs that are equal for single HAVs."""
    for next_goal, order, (place, circle), clipped, direction in itertools.product(
        ("together", "alone"),
        ("at_once", "in_turn"),
        CIRCLES.items(),
        (False, True),
        ("from axle", "from centre"),
    ):
        if direction == "from centre" and circle[0] == 0.0:
            continue  # the same point
        words = (next_goal, order, place, direction, "clipped" if clipped else "not clipped")
        fields = circles(*circle)
        evasion = {"evasion_clipped": clipped, "evasion_from_center": direction == "from centre"}
        yield vary(
            reading,
            "; ".join([reading.name, ", ".join(words)]),
            policy=fields["policy"] | evasion,
            task=fields["task"] | {"next_goal": next_goal, "order": order},
        )


def sparsely_recorded(reading: Reading) -> Iterator[Reading]:
    """Yield a reading with records at intervals of several steps."""
    for every in RECORDS:
        name = f"{reading.name}; every {every} steps"
        yield vary(reading, name, task={"record_every": every})


def name_of_single(reading: Reading) -> str:
    """Return the name of the single HAVs' reading from which a pair's reading is derived."""
    return reading.name.partition(";")[0]
