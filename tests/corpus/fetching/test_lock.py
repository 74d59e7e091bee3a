"""Tests of lock files."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest
from corpus.repositories import git
from hypothesis import given
from hypothesis import strategies as st

from kg.corpus.fetching.lock import Entry, Lock, checkouts, read_lock, standing, write_lock
from kg.errors import SourceError

if TYPE_CHECKING:
    from pathlib import Path

TEXTS = st.text(max_size=20).map(lambda text: text.encode("utf-8", "replace").decode("utf-8"))
ENTRIES = st.lists(
    st.builds(
        Entry,
        name=TEXTS.filter(bool),
        url=TEXTS.filter(bool),
        moved=TEXTS,
        folder=TEXTS,
        branch=TEXTS,
        commit=st.sampled_from(["", "a" * 40, "0" * 64]),
        ros=st.sampled_from(["", "1", "2", "1 2"]),
        bytes=st.integers(0, 2**40),
        state=TEXTS,
        reason=TEXTS,
    ),
    max_size=4,
    unique_by=lambda entry: entry.name,
)


@given(ENTRIES)
def test_round_trip(tmp_path_factory: pytest.TempPathFactory, entries: list[Entry]) -> None:
    """A written file is parsed back, sorted by name, and written again it is the same text."""
    path = tmp_path_factory.mktemp("lock") / "corpus.lock.toml"
    written = write_lock(path, entries)
    assert read_lock(path) == written
    assert [one.name for one in written.entries] == sorted(entry.name for entry in entries)
    text = path.read_text("utf-8")
    write_lock(path, reversed(read_lock(path).entries))
    assert path.read_text("utf-8") == text
    assert [one.name for one in path.parent.iterdir()] == ["corpus.lock.toml"]


def test_a_change_of_one_changes_its_lines_only(tmp_path: Path) -> None:
    """Other entries keep their lines."""
    path = tmp_path / "corpus.lock.toml"
    entries = [Entry(f"h/a/{number}", "u") for number in range(5)]
    write_lock(path, entries)
    before = path.read_text().splitlines()
    write_lock(path, [replace(entry, state="gone") if entry.name == "h/a/2" else entry for entry in entries])
    after = path.read_text().splitlines()
    assert [(one, other) for one, other in zip(before, after, strict=True) if one != other] == [
        ('state = "fetched"', 'state = "gone"')
    ]


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("version = 1\nx = =", 2, "not TOML"),
        ("version = 2\n", None, "version is 2"),
        ("", None, "version is None"),
        ('version = 1\n[[repository]]\nname = "a"\n', 2, "no `url`"),
        ('version = 1\n\n[[repository]]\nname = "a"\nurl = "u"\nsize = 1\n', 3, "unknown key `size`"),
        ('version = 1\n[[repository]]\nname = "a"\nurl = "u"\nbytes = "1"\n', 2, "not of type int"),
        ('version = 1\n[[repository]]\nname = "a"\nurl = "u"\ncommit = "--x"\n', 2, "not a commit"),
        ("version = 1\nrepository = 1\n", None, "not a list"),
    ],
)
def test_malformed_lock(text: str, line: int | None, says: str, tmp_path: Path) -> None:
    """An error in a lock file is reported with its line."""
    path = tmp_path / "lock"
    path.write_text(text)
    with pytest.raises(SourceError, match=says) as caught:
        read_lock(path)
    assert caught.value.code == "KG132"
    assert caught.value.place is not None
    assert caught.value.place.line == line


def test_what_stands_there(tmp_path: Path) -> None:
    """Checkouts are classified: pinned, at another commit, changed, missing."""
    for name in ("same", "other", "changed"):
        (tmp_path / name).mkdir()
        git(tmp_path / name, "init", "--quiet")
        (tmp_path / name / "file").write_text("x")
        git(tmp_path / name, "add", ".")
        git(tmp_path / name, "commit", "--quiet", "-m", "x")
    commit = git(tmp_path / "same", "rev-parse", "HEAD")
    (tmp_path / "changed" / "file").write_text("y")
    entries = [Entry(name, "u", folder=name, commit=commit) for name in ("same", "changed", "absent")]
    lock = Lock(tmp_path / "lock", (*entries, Entry("other", "u", folder="other", commit="0" * 40)))
    found = standing(lock)
    assert [entry.name for entry in found.present] == ["same", "changed", "other"]
    assert [entry.name for entry in found.missing] == ["absent"]
    assert {entry.name: why for entry, why in found.drifted} == {
        "changed": "files were changed",
        "other": f"is at {commit[:12]}, not at 000000000000",
    }
    assert next(iter(checkouts(lock, found))) == str(tmp_path / "same")
    with pytest.raises(SourceError) as caught:
        checkouts(lock, replace(found, present=()))
    assert caught.value.code == "KG136"
