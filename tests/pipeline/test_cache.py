"""Tests of cached results on disk."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hypothesis import given
from hypothesis import strategies as st

from kg.facts import Description, DescriptionKind, Location, Phrase
from kg.pipeline import cache

if TYPE_CHECKING:
    from pathlib import Path

    import pytest

LOOKUPS = st.dictionaries(st.lists(st.text(), min_size=2).map(tuple), st.text())


@given(content=st.binary(), lookups=LOOKUPS)
def test_round_trip(
    tmp_path_factory: pytest.TempPathFactory, content: bytes, lookups: dict[tuple[str, ...], str]
) -> None:
    """A stored result reads back unchanged, triples and look-ups separately."""
    folder = tmp_path_factory.mktemp("cache")
    name = cache.store(folder, cache.pack(content, lookups))
    assert cache.exists(folder, name)
    assert cache.triples(folder, name) == content
    assert cache.lookups(folder, name) == lookups


@given(text=st.text(), words=st.lists(st.text()).map(tuple))
def test_descriptions_come_back(tmp_path_factory: pytest.TempPathFactory, text: str, words: tuple[str, ...]) -> None:
    """Annotated descriptions read back equal; without a result there are none."""
    folder = tmp_path_factory.mktemp("cache")
    place = Location("README.md", 3)
    found = (Description(text, DescriptionKind.README, place, words=words, phrases=(Phrase("laser", "device"),)),)
    name = cache.store(folder, cache.pack(b"", {}, texts=found))
    assert cache.descriptions(folder, name) == found
    assert cache.descriptions(folder, "0" * 32) == ()


def test_damaged_and_missing(tmp_path: Path) -> None:
    """A missing or damaged result is None, and storing it again repairs it."""
    packed = cache.pack(b"x", {})
    name = cache.store(tmp_path, packed)
    path = next(tmp_path.iterdir())
    path.write_bytes(path.read_bytes()[:-1])
    assert cache.triples(tmp_path, name) is None
    assert cache.lookups(tmp_path, name) is None
    assert cache.store(tmp_path, packed) == name
    assert cache.triples(tmp_path, name) == b"x"
    assert cache.triples(tmp_path, "0" * 32) is None


def test_keep_only(tmp_path: Path) -> None:
    """Other results and partial files are deleted; other files remain."""
    kept, gone = (cache.store(tmp_path, cache.pack(content, {})) for content in (b"a", b"b"))
    (tmp_path / "x.z.7.tmp").touch()
    (tmp_path / "state.json").touch()
    cache.keep_only(tmp_path, [kept])
    assert cache.exists(tmp_path, kept)
    assert not cache.exists(tmp_path, gone)
    assert {path.suffix for path in tmp_path.iterdir()} == {".z", ".json"}
