"""This module finds models by name: built-in names, entry points, files and ``module:Class``.

Every kind of model has a registry of its own, and ``find_model`` asks all of them. A package of
your own registers names in its pyproject.toml, where the group is the registry's::

    [project.entry-points."hav_env.policies"]
    my_policy = "my_package.my_module:MyPolicy"
    ".suffix" = "my_package.my_module:read_file"
"""

import importlib
import importlib.metadata
import os
import pathlib
from collections.abc import Callable, Mapping
from typing import Any

from hav_env.models.annotations import show, with_article

REGISTRIES: dict[str, "Registry"] = {}
"""Of each kind of model: "policy", "scenario", "vehicle", "reward"."""


class Registry:
    """The names of one kind of model.

    Attributes:
        kind: of model, as errors call it.
        group: of the entry points that add names; an entry point whose name begins with a dot reads
            files with that suffix.
    """

    def __init__(
        self,
        kind: str,
        group: str,
        is_registered: Callable[[Any], bool],
        remedy: str,
        built_in: Mapping[str, Any] | None = None,
        readers: Mapping[str, Callable[[Any], Any]] | None = None,
    ) -> None:
        """Begin a registry, under which ``find_model`` finds models of this kind.

        Args:
            kind: kind of model, as errors call it.
            group: group of the entry points that add names.
            is_registered: tells whether a class has a kernel.
            remedy: advice to the user about a class that has none, for the message.
            built_in: models or classes of models, by name.
            readers: functions that read a model from a file, by the file's suffix.
        """
        self.kind, self.group = kind, group
        self._is_registered, self._remedy = is_registered, remedy
        self._built_in, self._readers = dict(built_in or {}), dict(readers or {})
        REGISTRIES[kind] = self

    def names(self) -> list[str]:
        """Return all names, those of other packages among them."""
        return [*self._built_in, *(name for name in self._entries() if name[0] != ".")]

    def known(self) -> str:
        """Return what ``find`` takes, for messages and help."""
        suffixes = [*self._readers, *(name for name in self._entries() if name[0] == ".")]
        return ", ".join([*self.names(), *(f"FILE{suffix}" for suffix in suffixes), "module:Class"])

    def find(self, name: str | os.PathLike[str]) -> Any:
        """Return a model, or a class of models whose parameters have yet to be chosen.

        Args:
            name: a name, ``module:Class``, or the path of a file; a ``PathLike`` is always a file.

        Raises:
            TypeError: when ``name`` is neither text nor a path.
            ValueError: when there is no such model, or it cannot be loaded.
        """
        if not isinstance(name, str | os.PathLike):
            told = f"{self.kind} is {show(name)}, but must be a name or the path of a file"
            raise TypeError(told)
        if isinstance(name, str) and name in self._built_in:
            return self._built_in[name]
        entries = self._entries()
        if isinstance(name, str) and name in entries and name[:1] != ".":
            return self._load(name, entries[name].load)
        reader = self._reader_of(name, entries)
        if reader is not None:
            if not _is_file(name):
                raise ValueError(f"there is no {self.kind} file {show(os.fspath(name), str)}")
            return reader(name)
        module, _, attribute = os.fspath(name).partition(":")
        if isinstance(name, str) and module and attribute:
            return self._load(name, lambda: getattr(importlib.import_module(module), attribute))
        raise ValueError(f"unknown {self.kind} {show(name)}; known: {self.known()}")

    def make(self, model: Any, **parameters: Any) -> Any:
        """Return a model with these parameters; the others are its defaults.

        Args:
            model: a model, or a name as ``find`` takes it.
            parameters: fields of the model.

        Raises:
            TypeError: when the model has no such parameter, or one without a default is missing.
            ValueError: when there is no such model.
        """
        found = self.find(model) if isinstance(model, str | os.PathLike) else model
        made: Any = found if isinstance(found, type) else type(found)
        unknown = sorted(set(parameters) - set(getattr(made, "_fields", parameters)))
        if unknown:
            told = f"{self.kind} {made.__name__} has no parameter {unknown[0]!r}"
            raise TypeError(f"{told}; its parameters: {', '.join(made._fields) or 'none'}")
        if not isinstance(found, type):
            return found._replace(**parameters) if parameters else found
        try:
            return found(**parameters)
        except TypeError as error:
            raise TypeError(f"{self.kind} {made.__name__} cannot be made: {error}") from None

    def _entries(self) -> dict[str, importlib.metadata.EntryPoint]:
        return {entry.name: entry for entry in importlib.metadata.entry_points(group=self.group)}

    def _reader_of(self, name: Any, entries: Mapping[str, Any]) -> Callable[[Any], Any] | None:
        """Return what reads the file of a name; None where the name is not that of a file."""
        suffix = pathlib.PurePath(name).suffix.lower()
        if suffix in self._readers:
            return self._readers[suffix]
        if suffix in entries:
            return entries[suffix].load()
        if isinstance(name, str):
            return None
        return next(iter(self._readers.values()), None)  # a path without a suffix

    def _load(self, name: str, load: Callable[[], Any]) -> Any:
        """Return what code outside this package offers under a name."""
        try:
            found = load()
        except (ImportError, AttributeError) as error:
            raise ValueError(f"cannot load {self.kind} {name!r}: {error}") from None
        except Exception as error:  # the module may raise anything, and "..x" is no name of one
            raise ValueError(f"cannot load {self.kind} {name!r}: {error!r}") from error
        if not self._is_registered(found if isinstance(found, type) else type(found)):
            article = with_article(self.kind)
            raise ValueError(f"{name!r} is not {article}: {self._remedy}")
        return found


def find_model(kind: str, name: str | os.PathLike[str]) -> Any:
    """Return the model, or the class of models, that has a name.

    Args:
        kind: "policy", "scenario", "vehicle" or "reward".
        name: of the model, ``module:Class``, or the path of a file.

    Raises:
        TypeError: when ``name`` is neither text nor a path.
        ValueError: when there is no such kind or model, or the model cannot be loaded.
    """
    if kind not in REGISTRIES:
        raise ValueError(f"kind is {kind!r}, but must be {' or '.join(map(repr, REGISTRIES))}")
    return REGISTRIES[kind].find(name)


def _is_file(path: str | os.PathLike[str]) -> bool:
    try:
        return pathlib.Path(path).is_file()
    except OSError:  # a name that is too long
        return False
