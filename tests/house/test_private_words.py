"""Pages, docstrings and comments use words of the field and of the glossary, no private ones."""

import ast
import io
import re
import tokenize

import pytest

from tests.support.paths import ROOT

FOLDERS = ["hav_env", "baselines", "train", "examples", "benchmarks", "tests"]
PAGES = sorted(
    path.relative_to(ROOT).as_posix()
    for folder in (ROOT, ROOT / "docs", ROOT / "benchmarks")
    for path in folder.glob("*.md")
)
PRIVATE_IN_PAGES = {  # pattern: the word to write instead
    r"\bfaces?\b": "interface, environment",
    r"\brooms?\b": "space",
    r"\bfor ever\b": "without end, permanently",
    r"\bin thought\b": "simulated, predicted",
    r"\btold\b": "reported, sent, passed",
    r"\bsaid\b": "explicit, stated",
    # a relative clause behind its noun is English: these clauses hide their noun
    r"\b[Ww]ho(ever|mever)\b": "a noun with a relative clause",
    r"(?:^|[.:;] |\b(?:of|with|by|from|to|as|and|that|only|on) )[Ww]hom?\b": "a noun before who",
}
# a colon follows the name of an argument
PRIVATE_IN_SOURCES = re.compile(
    r"\bfaces?\b|\brooms?\b|\bfor ever\b|\bin thought\b|\btold\b(?!:)|\bsaid\b"
    r"|\b(?:is|are|was|were|been|being) (?:asked|told|said|looked at)\b"
    r"|\bwho(?:ever)?\b|\b(?:some|any|every|no)body\b|(?:^|(?<=[.;:] ))[Ww]hat(?:ever)?\b(?!:)",
    re.IGNORECASE,
)


def prose_of(source):
    """Yield the line and the text of every docstring and comment of a module."""
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.Expr(value=ast.Constant(value=str(text))):
                yield node.lineno, " ".join(text.split())
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            yield token.start[0], token.string.lstrip("#: ")


def found_in(source):
    """Return the private words in the prose of a module, with their lines."""
    return [
        (line, m.group())
        for line, text in prose_of(source)
        for m in PRIVATE_IN_SOURCES.finditer(text)
    ]


@pytest.mark.parametrize("folder", FOLDERS)
def test_prose_has_no_private_words(folder):
    paths = {str(p.relative_to(ROOT)): p for p in sorted((ROOT / folder).rglob("*.py"))}
    found = {name: found_in(p.read_text()) for name, p in paths.items()}
    assert len(found) > 3
    assert not {name: words for name, words in found.items() if words}


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ('"""Return it.\n\nWhoever waits is asked."""\n', ["Whoever", "is asked"]),
        ("x = 1  # room for one\n", ["room"]),
        ("x: int = 1\n'''What is beyond.'''\n", ["What"]),
        ('x = "What is told"\nwho = x\n', []),
        ("# HAVs whose faces, rooms\n", ["faces", "rooms"]),
    ],
)
def test_private_words_are_found_in_prose_alone(source, words):
    assert [word for _, word in found_in(source)] == words


def prose(text):
    """Return a page without code, comments and the targets of links, a paragraph on each line."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
    text = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r"`[^`]*`", "`code`", text)
    text = re.sub(r"\]\([^)]*\)", "]", text)
    text = re.sub(r"^(?: {4}.*|\s*(?:[-*#>]+|\d+\.) )", "", text, flags=re.MULTILINE)
    blocks = re.split(r"\n\s*\n|(?<=\|)\n|(?<=\|) ", text)
    return "\n".join(" ".join(block.split()) for block in blocks)


def private_words(text):
    """Return each private word of a text with the words around it and those to write instead."""
    text = prose(text)
    return [
        f"{text[max(found.start() - 40, 0) : found.end() + 40]!r}: write {better}"
        for pattern, better in PRIVATE_IN_PAGES.items()
        for found in re.finditer(pattern, text, re.MULTILINE)
    ]


@pytest.mark.parametrize("page", PAGES)
def test_no_page_uses_a_private_word(page):
    assert not private_words((ROOT / page).read_text())


@pytest.mark.parametrize(
    "sentence",
    [
        "Every environment is a face of one process.",
        "A site without\nroom is refused.",
        "The backup is driven for\never.",
        "They drive it in thought.",
        "The page is told where axles are.",
        "- Nothing is said of others.",
        "Who waits is not asked.",
        "It changes with who stands.",
        "| word | For whoever trains. |",
    ],
)
def test_private_words_are_found(sentence):
    assert len(private_words(sentence)) == 1


@pytest.mark.parametrize(
    "sentence",
    [
        "For researchers who train agents.",
        "The surface of a mushroom.",
        "The example:\n\n```python\nroom = 1  # who is told\n```\n\nIt runs.",
        "The option `--room` of [a page](room.md).",
    ],
)
def test_words_of_the_field_pass(sentence):
    assert not private_words(sentence)
