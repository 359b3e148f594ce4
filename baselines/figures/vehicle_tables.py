"""This module writes tables of the catalogue: turning behaviour, dimensions and sources."""

import math

from baselines.figures.right_angle_turn import (
    SPARE,
    off_tracking,
    swept_width,
    tail_swing,
    tightest_radius,
    usual_turn,
)
from hav_env.vehicles import COMBINATIONS, Combination, catalogue
from hav_env.vehicles.steady_circles import (
    least_radius,
    least_radius_of_any_steering,
    swept_ring,
)

_TURN_COLUMNS = (
    *("vehicle", "trailers", "length", "R steering", "R for good", "R with limits"),
    *("R any steering", "ring inside", "ring outside", "R turn", "off-tracking", "swept width"),
    *("tail swing", "assumed"),
)
_UNIT_FIELDS = ("length", "hitch", "half_width", "front", "rear", "articulation_max")
_UNIT_COLUMNS = ("unit", "length", "hitch", "width", "front", "rear", "articulation")
_STAR = "\\*"  # a single one would mean emphasis
_LIMITS = {  # field: name, unit, factor
    "speed_max": ("working speed", "m/s", 1.0),
    "steering_max": ("steering", "degrees", math.degrees(1.0)),
    "steering_rate": ("steering rate", "rad/s", 1.0),
    "acceleration": ("acceleration", "m/s^2", 1.0),
    "braking": ("braking", "m/s^2", 1.0),
    "lateral": ("lateral acceleration", "m/s^2", 1.0),
}
_INTRODUCTION = """\
# Dimensions of the vehicles of the catalogue

For users who want to check the source of a number of [the catalogue](vehicles.md). Lengths are in
metres, angles in degrees. A **star** marks an assumption: no source was found. Below each table are
the sources, with the names of the numbers there, and the reasons for assumptions. Programs find the
same in `catalogue(name).origins`, and the names of all numbers with a star in
`catalogue(name).assumed`:

```python
from hav_env.vehicles import catalogue

print(catalogue("wb-67").origins[0], sorted(catalogue("wb-67").assumed))
```

`python -m baselines.figures.catalogue` writes this page.
"""


def turn_table() -> str:
    """Return the turning behaviour of each vehicle of the catalogue, as a table in Markdown."""
    rows = [_TURN_COLUMNS, ("---",) + ("--:",) * (len(_TURN_COLUMNS) - 1)]
    rows += [_turn_row(catalogue(name)) for name in COMBINATIONS.names()]
    return _markdown(rows)


def dimension_page() -> str:
    """Return the page with the dimensions of all vehicles and their sources, in Markdown."""
    vehicles = [catalogue(name) for name in COMBINATIONS.names()]
    return "\n".join([_INTRODUCTION, *(_section(vehicle) for vehicle in vehicles)])


def _turn_row(vehicle: Combination) -> tuple[str, ...]:
    chain = vehicle.lengths, vehicle.offsets
    tightest = tightest_radius(vehicle)
    ring = swept_ring(SPARE * tightest, *chain, *vehicle.bodies)
    turn = usual_turn(vehicle)
    numbers = (
        vehicle.lengths[0] / math.tan(vehicle.steering_max),
        least_radius(*chain),
        least_radius(*chain, vehicle.limits),
        least_radius_of_any_steering(*chain, vehicle.limits),
        *ring,
        turn.radius,
        *(off_tracking(turn), swept_width(turn), tail_swing(turn)),
    )
    return (
        f"`{vehicle.name}`",
        str(len(vehicle.units) - 1),
        f"{vehicle.overall_length:.2f}",
        *(f"{number:.2f}" for number in numbers),
        f"{len(vehicle.assumed)} of {len(vehicle.origins)}",
    )


def _section(vehicle: Combination) -> str:
    """Return a heading, the table of the units, the limits, and the sources of a vehicle."""
    rows = [_UNIT_COLUMNS, ("---",) + ("--:",) * (len(_UNIT_COLUMNS) - 1)]
    for place, unit in enumerate(vehicle.units):
        cells = []
        for field in _UNIT_FIELDS:
            path = f"units[{place}].{field}"
            if place == 0 and field in ("hitch", "articulation_max"):
                cells.append("")
                continue
            value = getattr(unit, field) * {"half_width": 2.0}.get(field, 1.0)
            angle = field == "articulation_max"
            shown = f"{math.degrees(value):.3g}" if angle else f"{value:.4g}"
            cells.append(shown + _star(vehicle, path))
        rows.append(("truck" if place == 0 else str(place), *cells))
    most = ", ".join(
        f"{called} {getattr(vehicle, field) * factor:.3g} {unit}{_star(vehicle, field)}"
        for field, (called, unit, factor) in _LIMITS.items()
    )
    return (
        f"## {vehicle.title}\n\n`{vehicle.name}`\n\n{_markdown(rows)}\n"
        f"Limits: {most}.\n\n{_sources(vehicle)}"
    )


def _sources(vehicle: Combination) -> str:
    """Return each source of a vehicle, with its numbers; assumptions come last."""
    sources: dict[str, dict[str, list[str]]] = {}
    for origin in sorted(vehicle.origins, key=lambda origin: origin.assumed):
        notes = sources.setdefault(origin.source, {})
        notes.setdefault(origin.note, []).append(_called(origin.field))
    lines = []
    for source, notes in sources.items():
        facts = [
            f"{', '.join(names)}{f' ({note})' if note else ''}" for note, names in notes.items()
        ]
        lines.append(f"- {source or f'{_STAR} Assumed'}: {'; '.join(facts)}")
    return "\n".join(lines) + "\n"


def _called(path: str) -> str:
    """Return the name of a number on the page, such as ``length 1`` or ``braking``."""
    place, _, field = path.removeprefix("units[").partition("].")
    if not field:
        return _LIMITS[path][0]
    called = dict(zip(_UNIT_FIELDS, _UNIT_COLUMNS[1:], strict=True))[field]
    return f"{called} of {'the truck' if place == '0' else place}"


def _star(vehicle: Combination, path: str) -> str:
    return _STAR if path in vehicle.assumed else ""


def _markdown(rows: list[tuple[str, ...]]) -> str:
    return "".join(f"| {' | '.join(row)} |\n".replace("|  |", "| |") for row in rows)
