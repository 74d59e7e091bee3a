"""Tests of arrays in a temporary file."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from kg.rules.engine import terms
from kg.rules.engine.facts import Facts, Packed, Shelf
from kg.rules.engine.pages import SMALL_BYTES, Pages
from kg.rules.engine.terms import Dictionary

if TYPE_CHECKING:
    from pathlib import Path

LARGE = SMALL_BYTES // 8


def numbers(first: int) -> np.ndarray:
    """Return an array large enough for the file."""
    return np.arange(first, first + LARGE)


def test_an_array_is_the_same_in_the_file(tmp_path: Path) -> None:
    """The stored array is equal, and read-only."""
    kept = Pages(tmp_path).store(numbers(5))
    assert np.array_equal(kept, numbers(5))
    assert not kept.flags.writeable


def test_an_array_stays_when_its_pages_are_released(tmp_path: Path) -> None:
    """Released pages are read again."""
    pages = Pages(tmp_path)
    kept = pages.store(numbers(5))
    pages.release()
    assert np.array_equal(kept, numbers(5))


def test_packed_sets_stay_the_same_in_the_file(tmp_path: Path) -> None:
    """Small sets that are moved together keep their predicates and pairs, and take no memory of their own."""
    shelf = Shelf(Pages(tmp_path))
    sets = [{1: np.arange(one), 2 + one: np.arange(5)} for one in range(1, 9)]
    packed = [shelf.add(Packed.of(columns.items())) for columns in sets]
    shelf.move()
    for columns, moved in zip(sets, packed, strict=True):
        assert {predicate: keys.tolist() for predicate, keys in moved} == {
            predicate: keys.tolist() for predicate, keys in columns.items()
        }
        assert not moved.words.flags.owndata


def test_a_view_keeps_its_place(tmp_path: Path) -> None:
    """The space of an array is reused only when it has no views left."""
    pages = Pages(tmp_path)
    view = pages.store(numbers(0))[10:]
    others = [pages.store(numbers(7 * one)) for one in range(1, 20)]
    assert np.array_equal(view, numbers(0)[10:])
    assert all(np.array_equal(kept, numbers(7 * one)) for one, kept in enumerate(others, 1))


def test_a_place_is_used_again(tmp_path: Path) -> None:
    """Space of freed arrays is reused."""
    pages = Pages(tmp_path)
    first = pages.store(numbers(1)).__array_interface__["data"]
    assert pages.store(numbers(2)).__array_interface__["data"] == first


def test_a_small_array_stays_in_memory(tmp_path: Path) -> None:
    """It is returned as it is."""
    small = np.arange(3)
    assert Pages(tmp_path).store(small) is small


def test_the_file_has_no_name(tmp_path: Path) -> None:
    """It disappears however the process exits."""
    pages = Pages(tmp_path)
    kept = pages.store(numbers(1))
    assert not list(tmp_path.iterdir())
    assert kept.size == LARGE


def test_parts_are_joined(tmp_path: Path) -> None:
    """Several arrays become one."""
    joined = Pages(tmp_path).join([np.arange(3), np.arange(0), np.arange(4)])
    assert joined.tolist() == [0, 1, 2, 0, 1, 2, 3]


def test_facts_put_large_columns_there(tmp_path: Path) -> None:
    """Both orders of a large column are in the file."""
    facts = Facts(pages=Pages(tmp_path))
    facts.replace(1, numbers(1 << 32))
    assert not facts.keys(1).flags.writeable
    assert not facts.by_object(1).flags.writeable


@pytest.fixture
def few_in_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    """A dictionary that holds ten terms in memory."""
    monkeypatch.setattr(terms, "_RECENT", 10)


@pytest.mark.usefixtures("few_in_memory")
def test_a_dictionary_with_pages_gives_the_same_identifiers(tmp_path: Path) -> None:
    """Identifiers do not depend on storage in the file or in memory, or on batch size."""
    plain, paged = Dictionary(), Dictionary(pages=Pages(tmp_path))
    generator = np.random.default_rng(3)
    for size in (5, 40, 3, 100, 1, 60):
        batch = [b"<urn:%d>" % one for one in generator.integers(0, 150, size)]
        assert paged.intern_all(batch).tolist() == plain.intern_all(batch).tolist()
        assert paged.intern(b"<urn:x%d>" % size) == plain.intern(b"<urn:x%d>" % size)
    everything = np.arange(len(plain))
    assert len(paged) == len(plain)
    assert paged.spellings(everything) == plain.spellings(everything)
    assert [paged.find(one) for one in plain.spellings(everything[1:])] == everything[1:].tolist()
    assert paged.find(b"<urn:unknown>") is None


@pytest.mark.usefixtures("few_in_memory")
def test_terms_of_one_checksum_are_told_apart(tmp_path: Path) -> None:
    """Two terms with equal CRC-32 are distinct."""
    paged = Dictionary(pages=Pages(tmp_path))
    first, second = paged.intern_all([b"<urn:plumless>", b"<urn:buckeroo>"]).tolist()
    paged.intern_all([b"<urn:%d>" % number for number in range(50)])
    paged.intern_all([b"<urn:last>"])
    assert paged.intern_all([b"<urn:buckeroo>", b"<urn:plumless>"]).tolist() == [second, first]
