"""This module names models with those parameters that differ from the defaults."""

from collections.abc import Iterator
from typing import Any

from hav_env.models.annotations import is_model, show, values_of


def name_with_changes(name: str, model: Any, usual: Any) -> str:
    """Return a name, followed by the parameters in which a model differs from the usual one."""
    changes = ", ".join(changes_of(model, usual))
    return f"{name} ({changes})" if changes else name


def changes_of(model: Any, usual: Any, prefix: str = "") -> Iterator[str]:
    """Yield ``field=value`` for each parameter in which a model differs from the usual one.

    Args:
        model: A NamedTuple or dataclass; its parts may be models too.
        usual: The model to compare with.
        prefix: Prefix of the names of the fields.
    """
    if model is usual:
        return
    if type(model) is not type(usual):
        yield f"{prefix.rstrip('.')}={type(model).__name__}"
        usual = type(model)()
    for field, value in values_of(model).items():
        other = values_of(usual)[field]
        if is_model(value) and is_model(other):
            yield from changes_of(value, other, f"{prefix}{field}.")
        elif value is not other and show(value) != show(other):
            yield f"{prefix}{field}={show(value, str)}"
