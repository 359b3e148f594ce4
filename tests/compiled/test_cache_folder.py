"""The folder of the compile cache: only this user may write to it."""

import os
import pathlib

import pytest

from hav_env.compiled import cache_folder as homes
from hav_env.compiled.cache_folder import find_home


@pytest.fixture(autouse=True)
def forgotten():
    """Look for the folder anew in every test."""
    find_home.cache_clear()
    yield
    find_home.cache_clear()


@pytest.fixture
def temporary(tmp_path, monkeypatch):
    """Return the folder for temporary files, in which all users may write."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    folder.chmod(0o1777)
    monkeypatch.setattr(homes.tempfile, "gettempdir", lambda: str(folder))
    return folder


def own(temporary):
    return temporary / f"hav_env-{os.getuid()}"


posix = pytest.mark.skipif(not hasattr(os, "getuid"), reason="Windows has no user ids")


def test_the_folder_is_made_for_this_user_alone(tmp_path, monkeypatch, caplog):
    monkeypatch.setattr(pathlib.Path, "home", lambda: tmp_path)
    before = os.umask(0)
    try:
        assert find_home("") == tmp_path / ".cache/hav_env"
        assert find_home(str(tmp_path / "a/b")) == tmp_path / "a/b"
    finally:
        os.umask(before)
    for path in ("a", "a/b", ".cache", ".cache/hav_env"):
        assert (tmp_path / path).stat().st_mode & 0o777 == 0o700
    assert not caplog.records


@posix
@pytest.mark.parametrize("mode", [0o777, 0o770, 0o720, 0o702, 0o1777])
@pytest.mark.parametrize("where", ["folder", "folder/above"])
def test_a_folder_that_others_can_write_to_is_refused(where, mode, tmp_path, temporary, caplog):
    folder = tmp_path / "folder/above"
    folder.mkdir(parents=True, mode=0o700)
    (tmp_path / where).chmod(mode)
    found = find_home(str(folder))
    if mode == 0o1777 and where == "folder":  # sticky: others cannot replace what is below
        assert found == folder
    else:
        assert found == own(temporary)
        assert len(caplog.records) == 1
        assert f"{tmp_path / where} can be written to by other users" in caplog.text
        assert not list(folder.iterdir())


@posix
def test_a_folder_of_another_user_is_refused(tmp_path, temporary, monkeypatch, caplog):
    (tmp_path / "theirs").mkdir(mode=0o700)
    stranger = os.getuid() + 1
    monkeypatch.setattr(os, "getuid", lambda: stranger)
    (temporary / f"hav_env-{stranger}").mkdir(mode=0o700)  # made before by another user
    assert find_home(str(tmp_path / "theirs")) is None
    assert len(caplog.records) == 1
    assert "belongs to user" in caplog.text
    assert "compiles in every process anew" in caplog.text


@posix
@pytest.mark.parametrize("how", ["open", "readable", "link", "file"])
def test_a_planted_folder_for_temporary_files_is_refused(how, tmp_path, temporary, caplog):
    if how == "link":
        (tmp_path / "elsewhere").mkdir(mode=0o700)
        own(temporary).symlink_to(tmp_path / "elsewhere")
    elif how == "file":
        own(temporary).write_text("mine")
    else:
        own(temporary).mkdir()
        own(temporary).chmod(0o777 if how == "open" else 0o755)
    (tmp_path / "file").write_text("no folder")
    assert find_home(str(tmp_path / "file")) is None
    assert len(caplog.records) == 1


def test_no_home_and_no_entry_for_this_user(temporary, monkeypatch, caplog):
    def fail():
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(pathlib.Path, "home", fail)
    assert find_home("") == own(temporary)
    assert find_home("~nobody-of-this-name/cache") == own(temporary)
    assert len(caplog.records) == 2


def test_nothing_can_be_written_to(tmp_path, monkeypatch, caplog):
    def fail():
        raise FileNotFoundError("No usable temporary directory found")

    (tmp_path / "file").write_text("no folder")
    monkeypatch.setattr(homes.tempfile, "gettempdir", fail)
    assert find_home(str(tmp_path / "file/below")) is None
    assert find_home(str(tmp_path / "file/below")) is None
    assert len(caplog.records) == 1
    assert "No usable temporary directory" in caplog.text


def test_a_system_without_user_ids(tmp_path, temporary, monkeypatch):
    monkeypatch.delattr(os, "getuid", raising=False)
    assert find_home(str(tmp_path / "cache")) == tmp_path / "cache"
    (tmp_path / "file").write_text("no folder")
    assert find_home(str(tmp_path / "file")) == temporary / "hav_env-cache"
