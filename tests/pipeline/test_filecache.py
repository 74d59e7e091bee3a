"""Tests of texts cached between processes until a file of an installation changes."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from kg import resources
from kg.pipeline import filecache, plan, reasoning
from kg.settings import load


class Made:
    """Returns another text on each call."""

    def __init__(self) -> None:
        self.times = 0

    def __call__(self) -> str:
        """Return the next text."""
        self.times += 1
        return f"text {self.times}"


@pytest.fixture
def settled(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make all files count as changed long ago."""
    monkeypatch.setattr(filecache, "_SETTLED", -1)


@pytest.mark.usefixtures("settled")
def test_a_text_is_made_once_for_the_same_files(tmp_path: Path) -> None:
    """The second call returns it from the file."""
    (tmp_path / "file").write_text("content")
    made = Made()
    found = [
        filecache.cached_text(tmp_path / "kept", tuple(filecache.states(tmp_path / "file")), "", made) for _ in range(3)
    ]
    assert (found, made.times) == (["text 1"] * 3, 1)


@pytest.mark.usefixtures("settled")
@pytest.mark.parametrize("edit", ["content", "rename", "remove", "add", "same size and time", "other question"])
def test_whatever_changes_below_a_folder_is_noticed(tmp_path: Path, edit: str) -> None:
    """Changes of contents, names, and edits that preserve size and time are detected."""
    folder, made = tmp_path / "folder", Made()
    (folder / "inner").mkdir(parents=True)
    path = folder / "inner" / "file"
    path.write_text("content")
    filecache.cached_text(tmp_path / "kept", tuple(filecache.states(folder)), "", made)
    status = path.stat()
    match edit:
        case "content":
            path.write_text("more content")
        case "rename":
            path.rename(folder / "other")
        case "remove":
            path.unlink()
        case "add":
            (folder / "another").write_text("")
        case "same size and time":
            while path.stat().st_ctime_ns == status.st_ctime_ns:
                path.write_text("tnetnoc")
                os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))
    what = "other" if edit == "other question" else ""
    assert filecache.cached_text(tmp_path / "kept", tuple(filecache.states(folder)), what, made) == "text 2"


def test_what_changed_a_moment_ago_is_not_kept(tmp_path: Path) -> None:
    """A second change within the same tick of the file system's clock would have the same time."""
    (tmp_path / "file").write_text("content")
    made = Made()
    found = [
        filecache.cached_text(tmp_path / "kept", tuple(filecache.states(tmp_path / "file")), "", made) for _ in range(2)
    ]
    assert found == ["text 1", "text 2"]


@pytest.mark.usefixtures("settled")
def test_a_damaged_file_is_made_anew(tmp_path: Path) -> None:
    """A damaged file is never taken for a cached text."""
    (tmp_path / "kept").write_bytes(b"\xff\xfe nonsense")
    assert filecache.cached_text(tmp_path / "kept", (), "", Made()) == "text 1"
    assert filecache.cached_text(tmp_path / "kept", (), "", Made()) == "text 1"


def test_installing_a_package_changes_the_states(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its parent folder gets another time; missing folders do not count."""
    monkeypatch.setattr(sys, "path", [str(tmp_path), "/no/such/folder"])
    before = list(filecache.installations())
    while list(filecache.installations()) == before:
        (tmp_path / "package").mkdir()
        (tmp_path / "package").rmdir()
    assert [Path(state.path) for state in before] == [tmp_path]


@pytest.mark.usefixtures("settled")
def test_kept_digests_are_those_that_are_computed(tmp_path: Path) -> None:
    """The first call caches them, the second reads them."""
    settings = load({}, environment={})
    computed = plan.version(settings), reasoning.digest(settings)
    for _ in range(2):
        assert (plan.version(settings, tmp_path), reasoning.digest(settings, tmp_path)) == computed


@pytest.mark.usefixtures("settled")
def test_an_edited_rule_has_another_digest_for_the_next_process(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The next process shares only the cache."""
    (tmp_path / "rules" / "family").mkdir(parents=True)
    rule = tmp_path / "rules" / "family" / "rule.rq"
    rule.write_text("CONSTRUCT { ?a ?b ?c } WHERE { ?c ?b ?a }")
    monkeypatch.setattr(resources, "folder", tmp_path.joinpath)
    settings = load({}, environment={})
    before = reasoning.digest(settings, tmp_path / "cache")
    rule.write_text("CONSTRUCT { ?c ?b ?a } WHERE { ?a ?b ?c }  # other")
    assert reasoning.digest(settings, tmp_path / "cache") != before
