from __future__ import annotations

import stat
from typing import TYPE_CHECKING

import pytest

from kg.shell.state import Entry, State, state_folder

if TYPE_CHECKING:
    from pathlib import Path


def entry(text: str, when: float = 1.0) -> Entry:
    """Return a history entry of a query."""
    return Entry(text, when, "/store", 3, 0.5, "ok")


def test_buffers_belong_to_a_store(tmp_path: Path) -> None:
    """Each store has its own buffers, in order."""
    State(tmp_path, "one").keep_buffers(["ASK {}", "SELECT *"])
    assert State(tmp_path, "one").buffers() == ["ASK {}", "SELECT *"]
    assert State(tmp_path, "two").buffers() == []


def test_the_history_has_each_query_once_the_newest_first(tmp_path: Path) -> None:
    """A repeated query moves to the front; other shells append to the same history."""
    for text in ("a", "b", "a"):
        State(tmp_path, "one").remember(entry(text))
    assert [one.text for one in State(tmp_path, "two").history()] == ["a", "b"]


def test_files_are_for_their_owner_alone(tmp_path: Path) -> None:
    """Other users cannot read the queries."""
    folder = tmp_path / "state" / "shell"
    state = State(folder, "one")
    state.keep_buffers(["a"])
    state.remember(entry("a"))
    state.keep_choice("theme", "nord")
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    assert {stat.S_IMODE(path.stat().st_mode) for path in folder.iterdir()} == {0o600}
    assert state.choice("theme", "x") == "nord"


@pytest.mark.parametrize("content", ["", "{", "[1, null]", '{"theme": 3}', "\x00"])
def test_damaged_files_count_as_nothing(tmp_path: Path, content: str) -> None:
    """A damaged file does not prevent the shell from working."""
    state = State(tmp_path, "one")
    state.keep_buffers(["a"])
    for path in [*tmp_path.iterdir(), tmp_path / "history.jsonl", tmp_path / "choices.json"]:
        path.write_text(content)
    assert state.buffers() == []
    assert state.history() == []
    assert state.choice("theme", "x") == "x"


def test_what_cannot_be_kept_is_told(tmp_path: Path) -> None:
    """If the folder is not writable the reason is told once, and nothing is raised."""
    (tmp_path / "file").write_text("")
    state = State(tmp_path / "file" / "shell", "one")
    told: list[str] = []
    state.tell = told.append
    state.keep_buffers(["a"])
    state.remember(entry("a"))
    assert len(told) == 1
    assert "file" in told[0]


def test_the_history_is_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a long history the newest entries remain."""
    monkeypatch.setattr("kg.shell.state._KEPT", 5)
    state = State(tmp_path, "one")
    for number in range(30):
        state.remember(entry(str(number)))
    found = [one.text for one in state.history()]
    assert found[0] == "29"
    assert len(found) <= 11


def test_the_folder_follows_the_environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """XDG_STATE_HOME gives the folder; a relative one is ignored."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    assert state_folder() == tmp_path / "kg" / "shell"
    monkeypatch.setenv("XDG_STATE_HOME", "relative")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert state_folder() == tmp_path / ".local" / "state" / "kg" / "shell"
