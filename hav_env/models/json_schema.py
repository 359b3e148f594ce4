"""This module checks what a JSON file holds by a JSON Schema, and names the place of a mistake.

It knows the words of JSON Schema 2020-12 that the project's schemas use, and refuses others: type,
properties, required, additionalProperties, items, minItems, maxItems, minimum, maximum,
exclusiveMinimum, $ref to $defs of the same schema; $schema, title, description and default.
"""

from collections.abc import Callable
from typing import Any

from hav_env.models.annotations import is_number, show

_KINDS: dict[str, Callable[[Any], bool]] = {
    "object": lambda value: isinstance(value, dict),
    "array": lambda value: isinstance(value, list),
    "string": lambda value: isinstance(value, str),
    "number": is_number,
    "integer": lambda value: is_number(value) and float(value).is_integer(),
}
_BOUNDS: dict[str, tuple[str, Callable[[Any, Any], bool]]] = {
    "minimum": ("at least", lambda value, bound: value >= bound),
    "maximum": ("at most", lambda value, bound: value <= bound),
    "exclusiveMinimum": ("above", lambda value, bound: value > bound),
    "minItems": ("at least", lambda value, bound: len(value) >= bound),
    "maxItems": ("at most", lambda value, bound: len(value) <= bound),
}
_STRUCTURE = {"type", "properties", "required", "additionalProperties", "items", "$ref", "$defs"}
_REMARKS = {"$schema", "$id", "title", "description", "default"}


def check_document(schema: dict[str, Any], value: Any, place: str) -> None:
    """Check a value of a JSON file.

    Args:
        schema: the schema, as read from its own file.
        value: value to check.
        place: name of the value, for the message.

    Raises:
        ValueError: naming the place, its value and what is allowed.
        NotImplementedError: when the schema has a word that this module does not know.
    """
    _check(schema, schema, value, place)


def _check(root: dict[str, Any], schema: dict[str, Any], value: Any, place: str) -> None:
    unknown = set(schema) - _STRUCTURE - _REMARKS - set(_BOUNDS)
    if unknown:
        raise NotImplementedError(f"the schema of {place} has the unknown word {min(unknown)!r}")
    if "$ref" in schema:
        _check(root, root["$defs"][schema["$ref"].removeprefix("#/$defs/")], value, place)
        return
    kind = schema["type"]
    if not _KINDS[kind](value):
        article = "an" if kind[0] in "aeiou" else "a"
        raise ValueError(f"{place} is {show(value)}, but must be {article} {kind}")
    for word, (rule, holds) in _BOUNDS.items():
        if word in schema and not holds(value, schema[word]):
            found = f"has {len(value)} entries" if kind == "array" else f"is {show(value, str)}"
            must = "have" if kind == "array" else "be"
            raise ValueError(f"{place} {found}, but must {must} {rule} {schema[word]}")
    if kind == "object":
        _check_entries(root, schema, value, place)
    if kind == "array":
        for number, part in enumerate(value):
            _check(root, schema["items"], part, f"{place}[{number}]")


def _check_entries(root: dict[str, Any], schema: dict[str, Any], value: Any, place: str) -> None:
    known, others = schema.get("properties", {}), schema.get("additionalProperties", True)
    for name in schema.get("required", ()):
        if name not in value:
            raise ValueError(f"{place} has no entry {show(name)}, but must have one")
    for name, part in value.items():
        if name in known:
            _check(root, known[name], part, f"{place}.{name}")
        elif others is False:
            told = f"{place} has the unknown entry {show(name)}"
            raise ValueError(f"{told}; known: {', '.join(known)}")
        elif others is not True:
            _check(root, others, part, f"{place}.{name}")
