"""This module finds models by name: built-in names, entry points, files and ``module:Class``.

Every kind of model has a registry of its own; ``hav_env.find_model`` reads all of them. Parameters
may stand behind a name: ``reserve:patience=5``, ``mine:TurnToGoal:gain=2``. A package of your own
registers names in its pyproject.toml, where the group is the registry's::

    [project.entry-points."hav_env.policies"]
    my_policy = "my_package.my_module:MyPolicy"
    ".suffix" = "my_package.my_module:read_file"
"""

import contextlib
import functools
import importlib
import importlib.metadata
import os
import pathlib
import re
import sys
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from hav_env.models.annotations import show, with_article
from hav_env.models.checks import check_fields
from hav_env.models.parameters_in_names import read_parameters, split_parameters
from hav_env.models.text import suggest

REGISTRIES: dict[str, "Registry"] = {}
"""Registries by kind of model: "policy", "scenario", "vehicle", "reward"."""
USES = {
    "policy": "hav-env evaluate NAME",
    "scenario": "--scenario NAME",
    "vehicle": "--vehicle NAME",
    "combination": "--fleet NAME --vehicle realistic",
    "guidance": "--guidance NAME",
    "reward": "--reward NAME",
}
"""Use of a name on the command line, by kind of model."""
_NOUNS = {"combination": "vehicle of the catalogue"}


class Registry:
    """The names of one kind of model.

    Attributes:
        kind: kind of model, as errors name it.
        group: group of the entry points that add names; an entry point whose name begins with a dot
            reads files with that suffix.
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
        """Create a registry, which ``find_model`` searches for models of this kind.

        Args:
            kind: kind of model, as errors name it.
            group: group of the entry points that add names.
            is_registered: function that returns whether a class has a kernel.
            remedy: advice to the user about a class without a kernel, for the message.
            built_in: models or classes of models, by name.
            readers: functions that read a model from a file, by the file's suffix.
        """
        self.kind, self.group = kind, group
        self._is_registered, self._remedy = is_registered, remedy
        self._built_in, self._readers = dict(built_in or {}), dict(readers or {})
        REGISTRIES[kind] = self

    def names(self) -> list[str]:
        """Return all names, those of other packages included."""
        return [*self._built_in, *(name for name in self._entries() if name[0] != ".")]

    def known(self) -> str:
        """Return a description of the arguments of ``find``, for messages and help."""
        files = [f"FILE{suffix}" for suffix in self._suffixes()]
        return ", ".join([*self.names(), *files, "module:Class"])

    def find(self, name: str | os.PathLike[str]) -> Any:
        """Return a model, or a class of models without parameters yet.

        Args:
            name: a name, ``module:Class``, or the path of a file; a ``PathLike`` is always a file.
                With parameters behind it, ``reserve:patience=5``, it is a model.

        Raises:
            TypeError: if ``name`` is neither text nor a path, or the model has no such parameter.
            ValueError: if there is no such model, or Python cannot load it, or a parameter is
                invalid.
        """
        if not isinstance(name, str | os.PathLike):
            told = f"{self.kind} is {show(name)}, but must be a name or the path of a file"
            raise TypeError(told)
        plain, texts = split_parameters(name) if isinstance(name, str) else (name, {})
        if texts:
            found = self.find(plain)
            model_class = found if isinstance(found, type) else type(found)
            model = self.make(found, **read_parameters(model_class, texts))
            check_fields(self.kind, model)
            return model
        if isinstance(name, str) and name in self._built_in:
            return self._built_in[name]
        entries = self._entries()
        if isinstance(name, str) and name in entries and name[:1] != ".":
            return self._load(name, entries[name].load)
        reader = self._reader_of(name, entries)
        if reader is not None:
            if not _is_file(name):
                told = f"there is no {self.kind} file {show(os.fspath(name), str)}"
                raise ValueError(told + self._nearest(os.fspath(name)))
            return reader(name)
        module, _, attribute = os.fspath(name).partition(":")
        if module.endswith(".py"):
            dotted = ".".join(pathlib.PurePath(module).with_suffix("").parts)
            models = [model for stem, model in _models_here() if stem == dotted]
            right = f"{dotted}:{attribute or next(iter(models), 'Class')}"
            rule = f"must be module:Class (did you mean {right!r}?)"
            raise ValueError(f"{self.kind} is {show(name)}, but {rule}")
        if isinstance(name, str) and module and attribute:
            return self._load(name, lambda: self._import(module, attribute))
        other = self._kind_of(os.fspath(name))
        if other:
            nouns = [_NOUNS.get(kind, kind) for kind in (other, self.kind)]
            there, wanted = map(with_article, nouns)
            told = f"{show(name)} is {there}, but must be {wanted}"
            raise ValueError(f"{told}: write {USES[other].replace('NAME', os.fspath(name))}")
        near = self._nearest(os.fspath(name))
        raise ValueError(f"unknown {self.kind} {show(name)}{near}; known: {self.known()}")

    def make(self, model: Any, **parameters: Any) -> Any:
        """Return a model with these parameters; the others are its defaults.

        Args:
            model: a model, or a name as ``find`` takes it.
            parameters: fields of the model.

        Raises:
            TypeError: if the model has no such parameter, or one without a default is missing.
            ValueError: if there is no such model.
        """
        found = self.find(model) if isinstance(model, str | os.PathLike) else model
        made: Any = found if isinstance(found, type) else type(found)
        unknown = sorted(set(parameters) - set(getattr(made, "_fields", parameters)))
        if unknown:
            near = suggest(unknown[0], made._fields)
            told = f"{self.kind} {made.__name__} has no parameter {unknown[0]!r}{near}"
            raise TypeError(f"{told}; its parameters: {', '.join(made._fields) or 'none'}")
        if not isinstance(found, type):
            return found._replace(**parameters) if parameters else found
        try:
            return found(**parameters)
        except TypeError as error:
            raise TypeError(f"{self.kind} {made.__name__} cannot be made: {error}") from None

    def _suffixes(self) -> list[str]:
        """Return the suffixes of the files that this registry reads."""
        return [*self._readers, *(name for name in self._entries() if name[0] == ".")]

    def _kind_of(self, name: str) -> str:
        """Return another kind of model that has a name, or files with its suffix; "" if none."""
        suffix = pathlib.PurePath(name).suffix.lower()
        for kind in USES:
            known = REGISTRIES.get(kind)
            if known is None or known is self:
                continue
            if name in known.names() or (suffix in known._suffixes() and _is_file(name)):
                return kind
        return ""

    def _nearest(self, text: str) -> str:
        """Return a suggestion in place of a wrong name: a file in that folder, a name or a file."""
        path = pathlib.Path(text)
        inside = _files_in(path, self._suffixes()) if text else []
        if inside:
            return f" (did you mean {inside[0]!r}?)"
        for module, model in _models_here():
            if text in (module, model) or text.casefold() == model.casefold():
                return f" (did you mean '{module}:{model}'?)"
        files = {pathlib.Path(file).stem: file for file in _files_in(path.parent, self._suffixes())}
        return suggest(text, self.names()) or suggest(path.stem, files, files.__getitem__)

    def _import(self, module: str, attribute: str) -> Any:
        """Return an attribute of a module.

        Raises:
            ImportError, AttributeError: if there is none; the message has the nearest name.
        """
        try:
            found = importlib.import_module(module)
        except ModuleNotFoundError as error:
            if error.name != module:
                raise
            stems = [path.stem for path in pathlib.Path().glob("*.py")]
            near = suggest(module, stems, lambda stem: f"{stem}:{attribute}")
            if module in self.names():
                near = f"; a parameter of {module!r} is written {module}:{attribute}=VALUE"
            raise ImportError(f"there is no module {module!r}{near}") from None
        if not hasattr(found, attribute):
            models = [
                name
                for name, value in vars(found).items()
                if isinstance(value, type) and self._is_registered(value)
            ]
            near = suggest(attribute, models, lambda model: f"{module}:{model}")
            raise AttributeError(f"module {module!r} has no {attribute!r}{near}")
        return getattr(found, attribute)

    def _entries(self) -> dict[str, importlib.metadata.EntryPoint]:
        found = _all_entries(importlib.metadata.entry_points, tuple(sys.path))
        return {entry.name: entry for entry in found.select(group=self.group)}

    def _reader_of(self, name: Any, entries: Mapping[str, Any]) -> Callable[[Any], Any] | None:
        """Return the reader of a file by its name; None if the name is not that of a file."""
        suffix = pathlib.PurePath(name).suffix.lower()
        if suffix in self._readers:
            return self._readers[suffix]
        if suffix in entries:
            return entries[suffix].load()
        if isinstance(name, str):
            return None
        return next(iter(self._readers.values()), None)  # a path without a suffix

    def _load(self, name: str, load: Callable[[], Any]) -> Any:
        """Return the object of other packages with a name."""
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


@functools.lru_cache(1)
def _all_entries(
    read: Callable[[], importlib.metadata.EntryPoints], path: tuple[str, ...]
) -> importlib.metadata.EntryPoints:
    """Return the entry points of all packages on a search path; reading them takes its time."""
    return read()


def _files_in(folder: pathlib.Path, suffixes: list[str]) -> list[str]:
    """Return the paths of the files in a folder that have one of the suffixes, as text."""
    try:
        return sorted(str(path) for path in folder.iterdir() if path.suffix in suffixes)
    except (OSError, ValueError):  # no folder, or no path
        return []


def _models_here() -> Iterator[tuple[str, str]]:
    """Yield the module and the name of each NamedTuple in the files of the current folder."""
    for file in _files_in(pathlib.Path(), [".py"]):
        with contextlib.suppress(OSError):
            text = pathlib.Path(file).read_text("utf-8", "replace")
            for model in re.findall(r"^class (\w+)\((?:typing\.)?NamedTuple\)", text, re.MULTILINE):
                yield pathlib.PurePath(file).stem, model


def _is_file(path: str | os.PathLike[str]) -> bool:
    try:
        return pathlib.Path(path).is_file()
    except OSError:  # a name that is too long
        return False
