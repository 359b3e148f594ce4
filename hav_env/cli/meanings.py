"""This module reads the meanings of entry points from docstrings without importing their code.

An import of a policy or a command loads the compiler, which takes a second. So this module finds
the source file, parses it, and returns the first sentence of the docstring.
"""

import ast
import importlib.machinery
import importlib.metadata
import importlib.util
import pathlib
import re

from hav_env.models.text import one_line

_MOST_STEPS = 4  # of ``from x import name``, from one module to the next


def meaning_of(entry: importlib.metadata.EntryPoint) -> str:
    """Return the first sentence of the docstring of an entry point, without its full stop.

    The docstring is that of the class, of the function, or of the annotation ``name: Class``. The
    meaning is empty without a docstring or a source file.
    """
    module, name = entry.module, entry.attr
    for _ in range(_MOST_STEPS):
        tree = _parse(module)
        if tree is None:
            return ""
        text, module = _look_up(tree, name)
        if not module:
            return _first_sentence(text)
    return ""


def _parse(module: str) -> ast.Module | None:
    """Return the syntax tree of a module, None if its source cannot be read."""
    try:
        top, *rest = module.split(".")
        spec = importlib.util.find_spec(top)
        for k in range(len(rest)):
            places = spec.submodule_search_locations if spec else None
            found = ".".join([top, *rest[: k + 1]])
            spec = importlib.machinery.PathFinder.find_spec(found, list(places or []))
        return ast.parse(pathlib.Path(spec.origin).read_text("utf-8")) if spec else None  # type: ignore[arg-type]
    except (ImportError, OSError, SyntaxError, TypeError, ValueError):
        return None


def _look_up(tree: ast.Module, name: str) -> tuple[str, str]:
    """Return the docstring of a name, or the module from which it is imported."""
    described = ast.ClassDef | ast.FunctionDef
    for place, node in enumerate(tree.body):
        if isinstance(node, described) and node.name == name:
            return ast.get_docstring(node) or "", ""
        if isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            names = [alias.asname or alias.name for alias in node.names]
            if name in names:
                return "", node.module
        if isinstance(node, ast.AnnAssign) and getattr(node.target, "id", "") == name:
            after = tree.body[place + 1] if place + 1 < len(tree.body) else None
            value = getattr(after, "value", None)
            return value.value if isinstance(value, ast.Constant) else "", ""  # type: ignore[return-value]
    return "", ""


def _first_sentence(text: str) -> str:
    paragraph = one_line(text.strip().split("\n\n")[0])
    return re.split(r"\.(?=\s|$)", paragraph, maxsplit=1)[0]
