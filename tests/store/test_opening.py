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


@pytest.mark.parametrize("left", [(), ("cache", "writer.lock")])
def test_an_empty_folder_becomes_a_store(tmp_path: Path, left: tuple[str, ...]) -> None:
    """A folder that is empty, or has what an interrupted first build left, can be written."""
    for name in left:
        (tmp_path / name).touch()
    with writable(settings.load({"store": tmp_path})) as store, store.write("test") as transaction:
        transaction.replace_graphs({})
    assert store.layout.current() == 1


def test_a_folder_of_other_files_is_left_alone(tmp_path: Path) -> None:
    """Nothing is written into a folder that another program or a user filled."""
    (tmp_path / "CURRENT").touch()
    with pytest.raises(StoreError, match="contains `CURRENT`") as raised, writable(settings.load({"store": tmp_path})):
        pass
    assert raised.value.code == "KG306"
    assert [entry.name for entry in tmp_path.iterdir()] == ["CURRENT"]
