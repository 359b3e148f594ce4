"""The pages of scenarios and vehicles are what their command writes, and show every name."""

import re
import sys

import pytest

from tests.support.paths import ROOT

CATALOGUE = ROOT / "docs/catalogue"


@pytest.fixture(scope="module")
def make_pages():
    pytest.importorskip("matplotlib")
    sys.path.insert(0, str(ROOT / "docs"))  # where both scripts are
    try:
        import make_pages

        yield make_pages
    finally:
        sys.path.remove(str(ROOT / "docs"))


def test_the_pages_are_those_of_the_command(make_pages):
    written = {
        str(path.relative_to(CATALOGUE)): path.read_text() for path in CATALOGUE.rglob("*.md")
    }
    assert written == make_pages.pages()


def test_the_pictures_are_there(make_pages):
    for path, text in make_pages.pages().items():
        for picture in re.findall(r"!\[[^\]]*\]\(([^)]*)\)", text):
            assert (CATALOGUE / path).parent.joinpath(picture).resolve().is_file()


def test_every_policy_has_a_score_or_a_reason(make_pages):
    from hav_env.policies.names import POLICIES
    from hav_env.scenarios.presets import SCENARIOS

    shipped = {name for name in POLICIES.names() if not name.startswith(".")}
    for name in SCENARIOS:
        text = (CATALOGUE / f"scenarios/{name}.md").read_text()
        assert shipped <= set(re.findall(r"^[|-] `(\w+)`", text, re.MULTILINE))


def test_every_public_name_is_on_a_page_of_the_api():
    import hav_env

    pages = "".join(path.read_text() for path in (ROOT / "docs/api").glob("*.md"))
    shown = set(re.findall(r"^::: hav_env\.(?:world\.)?(\w+)$", pages, re.MULTILINE))
    assert set(hav_env.__all__) <= shown
