"""The view of the start page."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.query.core import run
from kg.query.result import Solutions
from kg.query.stored import find
from kg.views.overview import QUESTIONS, overview

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot


def test_sources_have_their_state(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Each source has its name, when it was read, and how much was found and is not known."""
    (source,) = overview(snapshot, settings)["sources"]
    assert source["name"] == "local/examples"
    assert source["read"].startswith("20")
    assert (source["packages"], source["nodes"]) == (5, 11)
    assert 0 < source["unresolved"] < source["interfaces"]


def test_counts_and_snapshot(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """What there is is counted by kind, launch configurations too."""
    found = overview(snapshot, settings)
    assert found["snapshot"] == snapshot.identity
    assert (found["counts"]["node"], found["counts"]["package"], found["systems"]) == (11, 5, 4)


def test_each_question_has_an_answer_here(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """There are eight questions; with the examples that are filled in each finds something."""
    found = overview(snapshot, settings)["questions"]
    assert [one["query"] for one in found] == list(QUESTIONS)
    for one in found:
        query = find(one["query"])
        values = {parameter["name"]: parameter["example"] for parameter in one["parameters"][:1]}
        result = run(snapshot, query.text, parameters=query.bind(values))
        assert isinstance(result, Solutions)
        assert result.rows, one["question"]
