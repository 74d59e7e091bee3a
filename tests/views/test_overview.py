"""The view of the start page."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.query.core import run
from kg.query.result import Solutions
from kg.query.stored import find
from kg.views.listing import UNCOUNTED, listing
from kg.views.lists import LISTS
from kg.views.overview import QUESTIONS, overview

if TYPE_CHECKING:
    import pytest

    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot


def test_sources_have_their_state(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Each source has its name, the time of reading, and the numbers of found and unresolved entities."""
    (source,) = overview(snapshot, settings)["sources"]
    assert source["name"] == "local/examples"
    assert source["read"].startswith("20")
    assert (source["packages"], source["nodes"]) == (5, 11)
    assert 0 < source["unresolved"] < source["interfaces"]


def test_counts_and_snapshot(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Counts equal those of the lists, and include the sources and launch configurations."""
    found = overview(snapshot, settings)
    assert found["snapshot"] == snapshot.identity
    assert (found["counts"]["nodes"], found["counts"]["packages"], found["systems"]) == (11, 5, 4)
    lists = {of: listing(snapshot, settings, of=of)["all"] for of in LISTS if of not in UNCOUNTED}
    messages = listing(snapshot, settings, of="types", kind="message")["total"]
    assert found["counts"] == {**lists, "message types": messages}
    (source,) = found["sources"]
    assert (source["nodes"], source["packages"], found["systems"]) == (
        lists["nodes"], lists["packages"], lists["systems"],
    )  # fmt: skip


def test_a_large_store_is_not_counted_while_somebody_waits(
    snapshot: EmbeddedSnapshot, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A large store has the counts computed before; without them there are none."""
    monkeypatch.setattr("kg.views.overview._SOON", 0)
    kept: dict[str, int] = {}
    monkeypatch.setattr("kg.views.answers._cached", lambda *_: kept)
    assert overview(snapshot, settings)["counts"] == {}
    kept["nodes"] = 11
    assert overview(snapshot, settings)["counts"] == {"nodes": 11}


def test_each_question_has_an_answer_here(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Each of the eight questions, with its example values, has a result."""
    found = overview(snapshot, settings)["questions"]
    assert [one["query"] for one in found] == list(QUESTIONS)
    for one in found:
        query = find(one["query"])
        values = {parameter["name"]: parameter["example"] for parameter in one["parameters"][:1]}
        result = run(snapshot, query.text, parameters=query.bind(values))
        assert isinstance(result, Solutions)
        assert result.rows, one["question"]
