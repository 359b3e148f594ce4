"""This module reads parameters behind the name of a model: ``reserve:patience=5,margin=0.5``."""

import ast
import re
from typing import Any

from hav_env.models.annotations import kinds_of, split_range

_NAME_AND_PARAMETERS = re.compile(r"(.+?):([^\W\d][\w-]*=.*)", re.DOTALL)


def split_parameters(text: str) -> tuple[str, dict[str, str]]:
    """Return a name, and the texts of the parameters behind it; none in most names.

    Raises:
        ValueError: If a part of the parameters is not FIELD=VALUE.
    """
    found = _NAME_AND_PARAMETERS.fullmatch(text)
    if found is None:
        return text, {}
    parameters: dict[str, str] = {}
    for part in found[2].split(","):
        field, equals, value = part.partition("=")
        if not equals or not field.strip():
            raise ValueError(f"{text!r} holds {part!r}, but must hold FIELD=VALUE,FIELD=VALUE")
        parameters[field.strip().replace("-", "_")] = value.strip()
    return found[1], parameters


def read_parameters(model_class: type, texts: dict[str, str]) -> dict[str, Any]:
    """Return the values of parameters as their fields hold them; words stay text."""
    kinds = kinds_of(model_class)
    return {field: _read(text, kinds.get(field, Any)) for field, text in texts.items()}


def _read(text: str, kind: Any) -> Any:
    known = text.capitalize() if text.lower() in ("true", "false", "none") else text
    try:
        value = ast.literal_eval(known)
    except (ValueError, SyntaxError, MemoryError, RecursionError):
        return text
    whole = isinstance(value, int) and not isinstance(value, bool)
    return float(value) if whole and split_range(kind)[0] is float else value
