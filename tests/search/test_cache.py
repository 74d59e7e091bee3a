from __future__ import annotations

from threading import Event, Thread
from time import sleep
from typing import TYPE_CHECKING, Final

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from search.store import CONTENT

from kg.search import cache
from kg.search.index import build
from kg.search.searching import Search, hit_object

if TYPE_CHECKING:
    from pathlib import Path

    import pytest

NEED: Final = "merge the scans of two lasers into one"
INDEX: Final = build(CONTENT)


def test_an_index_read_back_answers_alike(tmp_path: Path) -> None:
    """The cached index gives the same hits with the same reasons."""
    cache.save(tmp_path, "7", INDEX)
    found = cache.load(tmp_path, "7")
    assert found is not None
    assert np.array_equal(found.text.values, INDEX.text.values)
    expected = [hit_object(hit) for hit in Search(INDEX).find(NEED).hits]
    assert [hit_object(hit) for hit in Search(found).find(NEED).hits] == expected


def test_the_index_of_another_generation_is_removed(tmp_path: Path) -> None:
    """Only the index written last remains."""
    cache.save(tmp_path, "7", INDEX)
    cache.save(tmp_path, "8", INDEX)
    assert cache.load(tmp_path, "7") is None
    assert [path.name for path in (tmp_path / "search").iterdir()] == ["8"]


@given(st.data())
@settings(max_examples=40)
def test_a_damaged_index_is_no_index(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    """Changed or missing bytes are detected; the index is built again."""
    folder = tmp_path_factory.mktemp("cache")
    cache.save(folder, "1", INDEX)
    file = folder / "search" / "1"
    content = bytearray(file.read_bytes())
    place = data.draw(st.integers(0, len(content) - 1))
    if data.draw(st.booleans()):
        content[place] ^= data.draw(st.integers(1, 255))
    else:
        del content[place:]
    file.write_bytes(content)
    assert cache.load(folder, "1") is None


def test_an_index_of_other_code_or_data_is_no_index(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Terms depend on the lexicon, and scores on the code, so an index is only valid for both."""
    cache.save(tmp_path, "1", INDEX)
    monkeypatch.setattr(cache, "_version", lambda: 1)
    assert cache.load(tmp_path, "1") is None


def test_one_builds_while_others_wait(tmp_path: Path) -> None:
    """A process that needs the index waits while another builds it."""
    order: list[str] = []
    began = Event()

    def first() -> None:
        with cache.alone(tmp_path):
            began.set()
            sleep(0.1)
            order.append("first")

    thread = Thread(target=first)
    thread.start()
    began.wait()
    with cache.alone(tmp_path):
        order.append("second")
    thread.join()
    assert order == ["first", "second"]
