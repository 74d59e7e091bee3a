from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from pyoxigraph import NamedNode

from kg import settings
from kg.errors import StoreError
from kg.store.opening import existing, reading, writable

if TYPE_CHECKING:
    from pathlib import Path


def test_a_store_is_made_where_there_is_none_and_stays_when_written(tmp_path: Path) -> None:
    """The named folder is created, and its content is found again."""
    given = settings.load({"store": tmp_path / "mine"})
    with writable(given) as store, store.write("test") as transaction:
        transaction.append(
            NamedNode("https://example.org/g"),
            b"<https://example.org/a> <https://example.org/p> <https://example.org/b> .\n",
        )
    with reading(given) as snapshot:
        assert snapshot.count() == 1
    assert existing(given).layout.root == tmp_path / "mine"


def test_a_new_store_into_which_nothing_came_is_removed(tmp_path: Path) -> None:
    """A failing command leaves no empty store."""
    given = settings.load({"store": tmp_path / "mine"})
    with pytest.raises(ZeroDivisionError), writable(given):
        raise ZeroDivisionError
    assert not (tmp_path / "mine").exists()


def test_a_folder_that_was_there_stays(tmp_path: Path) -> None:
    """Existing files of the user are never deleted, store or not."""
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "file").touch()
    with pytest.raises(ZeroDivisionError), writable(settings.load({"store": tmp_path / "mine"})):
        raise ZeroDivisionError
    assert (tmp_path / "mine" / "file").exists()


def test_a_file_is_no_store(tmp_path: Path) -> None:
    """A file in place of the folder is an error, and the file remains."""
    (tmp_path / "mine").write_text("mine")
    with (
        pytest.raises(StoreError, match="a store is a folder") as caught,
        writable(settings.load({"store": tmp_path / "mine"})),
    ):
        pass
    assert caught.value.code == "KG306"
    assert (tmp_path / "mine").read_text() == "mine"


def test_without_leave_to_create_a_missing_store_is_an_error(tmp_path: Path) -> None:
    """A build without sources needs a store: KG301."""
    with pytest.raises(StoreError) as caught, writable(settings.load({"store": tmp_path / "mine"}), create=False):
        pass
    assert caught.value.code == "KG301"
