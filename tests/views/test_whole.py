from __future__ import annotations

from typing import TYPE_CHECKING, Final

import pytest

from kg.query.core import run
from kg.query.result import Solutions
from kg.query.stored import find
from kg.rules import selecting
from kg.views import whole

if TYPE_CHECKING:
    from kg.store.snapshot import EmbeddedSnapshot

QUERIES: Final = {
    name: find(name).text for name in ("degree", "who-talks-to-whom", "completeness/entities-by-kind")
} | {"a typed one": "SELECT DISTINCT ?p (COUNT(DISTINCT ?o) AS ?n) { ?s ?p ?o } GROUP BY ?p ORDER BY ?p"}


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Use columns for stores of any size."""
    monkeypatch.setattr(whole, "_BYTES", 0)
    monkeypatch.setattr(selecting, "_MANY", 1)


@pytest.mark.usefixtures("small")
@pytest.mark.parametrize("name", sorted(QUERIES))
def test_columns_answer_as_the_store_does(snapshot: EmbeddedSnapshot, name: str) -> None:
    """Variables, rows and their order equal those of the store."""
    found, expected = whole.answer(snapshot, QUERIES[name]), run(snapshot, QUERIES[name])
    assert found is not None
    assert isinstance(expected, Solutions)
    assert (found.variables, found.rows, found.snapshot) == (expected.variables, expected.rows, expected.snapshot)
    assert found.rows


@pytest.mark.usefixtures("small")
def test_rows_are_capped(snapshot: EmbeddedSnapshot) -> None:
    """The row limit is reported if it truncated the result."""
    text = QUERIES["a typed one"]
    cut, every = whole.answer(snapshot, text, limit=2), whole.answer(snapshot, text, limit=1000)
    assert cut is not None
    assert every is not None
    assert (len(cut), cut.limit, cut.rows) == (2, 2, every.rows[:2])
    assert every.limit is None


def test_small_stores_are_asked_themselves(snapshot: EmbeddedSnapshot, monkeypatch: pytest.MonkeyPatch) -> None:
    """For a small store, loading columns would take longer than the query."""
    monkeypatch.setattr(whole, "_BYTES", 1 << 40)
    monkeypatch.setattr(selecting, "_MANY", 1)
    assert whole.answer(snapshot, QUERIES["degree"]) is None


@pytest.mark.usefixtures("small")
@pytest.mark.parametrize("text", ["ASK { ?s ?p ?o }", "SELECT ?s { ?s ?p ?o }", "SELECT DISTINCT nonsense"])
def test_what_columns_cannot_answer_is_left_to_the_store(snapshot: EmbeddedSnapshot, text: str) -> None:
    """Errors are left to the store."""
    assert whole.answer(snapshot, text) is None
