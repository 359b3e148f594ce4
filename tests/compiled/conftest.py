"""Fixtures: a process that believes it has many cores."""

import pytest

from hav_env.compiled import threads


@pytest.fixture
def eight_cores(monkeypatch):
    """Let crews have up to eight threads, however few cores there are."""
    monkeypatch.setattr(threads, "_cores", lambda: 8)
    monkeypatch.setattr(threads, "_crews", {})
