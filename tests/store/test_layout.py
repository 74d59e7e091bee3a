"""Tests of finding a store and of its pointer."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING

import pytest

from kg.errors import StoreError
from kg.store.layout import Layout, create, find, write_atomically

if TYPE_CHECKING:
    from pathlib import Path


def test_found_upwards(tmp_path: Path) -> None:
    """The store of a folder above is found."""
    layout = create(tmp_path / ".kg")
    below = tmp_path / "src" / "package"
    below.mkdir(parents=True)
    assert find(below) == layout


def test_missing_store_names_the_folder_where_the_search_began(tmp_path: Path) -> None:
    """The error about a missing store names the folder, not each of those above it."""
    with pytest.raises(StoreError) as caught:
        find(tmp_path)
    assert caught.value.code == "KG301"
    assert caught.value.message == f"no .kg folder in {tmp_path} or the folders above it"


def test_store_of_another_layout(tmp_path: Path) -> None:
    """A store with another layout version is refused."""
    layout = create(tmp_path / ".kg")
    layout.pointer.write_text(json.dumps({"layout": 99, "generation": 1}))
    with pytest.raises(StoreError) as caught:
        layout.current()
    assert caught.value.code == "KG305"


@pytest.mark.parametrize("content", ["", "{", "[]", '{"layout": 1}', '{"layout": 1, "generation": "x"}'])
def test_damaged_pointer(tmp_path: Path, content: str) -> None:
    """A malformed pointer is a damaged store."""
    layout = create(tmp_path / ".kg")
    layout.pointer.write_text(content)
    with pytest.raises(StoreError) as caught:
        layout.current()
    assert caught.value.code == "KG303"


def test_version_control_leaves_the_store_out(tmp_path: Path) -> None:
    """The folder contains an ignore file for itself."""
    assert (create(tmp_path / ".kg").root / ".gitignore").read_text() == "*\n"


def test_what_is_in_force_is_there_or_gone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A generation replaced and deleted during the look-up does not count as lost data."""
    layout = create(tmp_path / ".kg")
    assert layout.in_force() is None
    layout.generation(1).mkdir()
    layout.switch(1)
    current = Layout.current
    looks: list[int | None] = []

    def replaced_meanwhile(asked: Layout) -> int | None:
        looks.append(current(asked))
        if len(looks) == 1:
            layout.generation(1).rename(layout.generation(2))
            layout.switch(2)
        return looks[-1]

    monkeypatch.setattr(Layout, "current", replaced_meanwhile)
    assert layout.in_force() == 2
    assert looks == [1, 2]
    layout.generation(2).rmdir()
    assert layout.in_force() is None


def test_two_that_write_a_file_at_once_both_write_it_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two threads that write a file at once do not interfere; one of the two contents remains."""
    file = tmp_path / "file"
    found: list[bytes] = []

    def meanwhile(_: int) -> None:
        monkeypatch.undo()
        write_atomically(file, b"the other one")
        found.append(file.read_bytes())

    monkeypatch.setattr(os, "fsync", meanwhile)
    write_atomically(file, b"one")
    assert [*found, file.read_bytes()] == [b"the other one", b"one"]
    assert list(tmp_path.iterdir()) == [file]
