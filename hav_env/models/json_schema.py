"""This module checks JSON by a JSON Schema, and names the place of a mistake."""

import functools
import json
from collections.abc import Callable
from typing import Any

from hav_env.models.annotations import show

_BOUNDS = {
    "minimum": "at least",
    "maximum": "at most",
    "exclusiveMinimum": "above",
    "exclusiveMaximum": "below",
}
_SIZES = {"minItems": "at least", "maxItems": "at most"}


def check_document(schema: dict[str, Any], value: Any, place: str) -> None:
    """Check a value of a JSON file. NaN, which Python reads from JSON, passes all bounds.

    Args:
        schema: the schema, as read from its own file.
        value: value to check; missing entries get their defaults.
        place: name of the value, for the message.

    Raises:
        ValueError: if an entry is wrong; the message names its value and the rule.
    """
    validate, mistake = _compiled(json.dumps(schema))
    try:
        validate(value)
    except mistake as error:
        raise ValueError(_explain(error, place)) from None


@functools.cache
def _compiled(schema: str) -> tuple[Callable[[Any], Any], type[Exception]]:
    """Return the validator of a document, and the error that it raises."""
    import fastjsonschema  # noqa: PLC0415  # only files need it

    return fastjsonschema.compile(json.loads(schema)), fastjsonschema.JsonSchemaValueException


def _explain(error: Any, place: str) -> str:
    """Return the mistake in the words of all other checks."""
    place, value = place + error.name.removeprefix("data"), error.value
    allowed = error.rule_definition
    if error.rule in _BOUNDS:
        return f"{place} is {show(value, str)}, but must be {_BOUNDS[error.rule]} {allowed}"
    if error.rule in _SIZES:
        return f"{place} has {len(value)} entries, but must have {_SIZES[error.rule]} {allowed}"
    if error.rule == "type":
        article = "an" if allowed[0] in "aeiou" else "a"
        return f"{place} is {show(value)}, but must be {article} {allowed}"
    if error.rule == "required":
        missing = [name for name in allowed if name not in value]
        return f"{place} has no entry {show(missing[0])}, but must have one"
    if error.rule == "additionalProperties":
        known = error.definition["properties"]
        unknown = [name for name in value if name not in known]
        return f"{place} has the unknown entry {show(unknown[0])}; known: {', '.join(known)}"
    return f"{place}{error.message.removeprefix(error.name)}"
