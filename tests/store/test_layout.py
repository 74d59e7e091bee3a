"""Tests of finding a store and of its pointer."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

from kg.errors import StoreError
from kg.store.layout import create, find

if TYPE_CHECKING:
    from pathlib import Path


def test_found_upwards(tmp_path: Path) -> None:
    """The store of a folder above is found."""
    layout = create(tmp_path / ".kg")
    below = tmp_path / "src" / "package"
    below.mkdir(parents=True)
    assert find(below) == layout


def test_missing_store_names_the_folders_searched(tmp_path: Path) -> None:
    """When there is no store the folders searched are named."""
    with pytest.raises(StoreError) as caught:
        find(tmp_path)
    assert caught.value.code == "KG301"
    assert str(tmp_path) in caught.value.message
    assert str(tmp_path.parent) in caught.value.message


def test_store_of_another_layout(tmp_path: Path) -> None:
    """A store written with another layout is refused by name."""
    layout = create(tmp_path / ".kg")
    layout.pointer.write_text(json.dumps({"layout": 99, "generation": 1}))
    with pytest.raises(StoreError) as caught:
        layout.current()
    assert caught.value.code == "KG305"


@pytest.mark.parametrize("content", ["", "{", "[]", '{"layout": 1}', '{"layout": 1, "generation": "x"}'])
def test_damaged_pointer(tmp_path: Path, content: str) -> None:
    """A pointer that says nothing is a damaged store."""
    layout = create(tmp_path / ".kg")
    layout.pointer.write_text(content)
    with pytest.raises(StoreError) as caught:
        layout.current()
    assert caught.value.code == "KG303"


def test_version_control_leaves_the_store_out(tmp_path: Path) -> None:
    """The folder ignores itself."""
    assert (create(tmp_path / ".kg").root / ".gitignore").read_text() == "*\n"
