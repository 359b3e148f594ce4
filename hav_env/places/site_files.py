"""This module reads sites in JSON; ``site.schema.json`` is their schema."""

import functools
import importlib.resources
import json
from typing import Any

from hav_env.models.annotations import show
from hav_env.models.json_schema import check_document
from hav_env.places.outlines import read_chain, read_circle, read_ring
from hav_env.places.site import BOUNDARY, LINE, POLYGON, Outline

SITE_ENTRIES = ("boundary", "obstacles")
_FORMS = ("polygon", "line", "circle")


@functools.cache
def site_schema() -> dict[str, Any]:
    """Return the JSON Schema of a site."""
    package = importlib.resources.files("hav_env.places")
    return json.loads((package / "site.schema.json").read_text(encoding="utf-8"))


def read_outlines(data: Any, name: str = "site") -> list[Outline]:
    """Return the outlines of a site in JSON.

    Args:
        data: parsed JSON.
        name: name of the site, for messages.

    Raises:
        TypeError, ValueError: if an entry is wrong; the message names its value and the rule.
    """
    check_document(site_schema(), data, name)
    found: list[Outline] = []
    if "boundary" in data:
        found.append((BOUNDARY, [read_ring(f"{name}.boundary", data["boundary"])]))
    for k, obstacle in enumerate(data.get("obstacles", ())):
        found.append(_read_obstacle(f"{name}.obstacles[{k}]", obstacle))
    return found


def _read_obstacle(name: str, obstacle: dict[str, Any]) -> Outline:
    forms = [form for form in _FORMS if form in obstacle]
    if len(forms) != 1:
        told = f"{name} is {show(obstacle)}, but must have one of: {', '.join(_FORMS)}"
        raise ValueError(told)
    (form,) = forms
    if "holes" in obstacle and form != "polygon":
        raise ValueError(f"{name} has holes, but only a polygon may have them")
    value = obstacle[form]
    if form == "line":
        return LINE, [read_chain(f"{name}.line", value)]
    if form == "circle":
        return POLYGON, [read_circle(f"{name}.circle", value)]
    rings = [read_ring(f"{name}.polygon", value)]
    for k, hole in enumerate(obstacle.get("holes", ())):
        rings.append(read_ring(f"{name}.holes[{k}]", hole))
    return POLYGON, rings
