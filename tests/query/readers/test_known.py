"""Tests of what is known of requests that come."""

from __future__ import annotations

import time

import pytest

from kg.query.readers import known
from kg.query.readers.known import Known, Marks


def _marks(text: str) -> Marks:
    return Marks.of(text.encode(), text)


@pytest.mark.parametrize(
    ("one", "other", "alike"),
    [
        ("ASK { ?s ?p 1 }", "ASK{?s ?p 22} # more", True),
        ("ASK { ?s ?p 1 }", "ASK { ?o ?p 1 }", False),
        ("ASK { ?s ?p 'a' }", "ASK { ?s ?p 'b' }", True),
        ("ASK { ?s ?p <x#a> }", "ASK { ?s ?p <x#b> }", False),
        ("ASK { ?s ?p ?o }", "ASK { ?s ?p ?s }", False),
        ("ASK {} # 1" + " " * 9000, "ASK {} # 2" + " " * 9000, False),
    ],
)
def test_shapes_leave_values_out(one: str, other: str, *, alike: bool) -> None:
    """Texts that differ in numbers, strings, comments and white space are alike; those with other terms are not."""
    assert (_marks(one).shape == _marks(other).shape) == alike
    assert _marks(one).exact != _marks(other).exact


@pytest.mark.parametrize("part", ["<", '"', "'", "#", "<a", "1 ", "\\", "<\"'"])
def test_a_shape_costs_little(part: str) -> None:
    """No text takes the process that all requests go through more than a moment."""
    began = time.process_time()
    for _ in range(10):
        _marks((part * 4096)[:4096])
    assert time.process_time() - began < 1


def test_the_last_of_its_kind_tells() -> None:
    """What is like a slow request is suspected until one like it is quick; only the very one is known as slow."""
    store = Known(100)
    store.note(_marks("ASK { ?s ?p 1 }"), quick=False)
    assert store.is_slow(_marks("ASK { ?s ?p 1 }"))
    assert not store.is_slow(_marks("ASK { ?s ?p 2 }"))
    assert store.guess(_marks("ASK { ?s ?p 2 }")) is False
    assert store.guess(_marks("ASK {}"))
    store.note(_marks("ASK { ?s ?p 3 }"), quick=True)
    assert store.guess(_marks("ASK { ?s ?p 2 }"))


def test_in_a_flood_nothing_is_guessed_of_what_is_new(monkeypatch: pytest.MonkeyPatch) -> None:
    """When many were found to be slow in short order, nothing is guessed of what is not known, for some time."""
    store = Known(2)
    store.note(_marks("ASK {}"), quick=True)
    store.note(_marks("ASK { ?a ?b ?c }"), quick=False)
    assert store.guess(_marks("ASK { ?new ?b ?c }"))
    store.note(_marks("ASK { ?d ?e ?f }"), quick=False)
    assert store.guess(_marks("ASK { ?new ?b ?c }")) is None
    assert store.guess(_marks("ASK {}"))
    monkeypatch.setattr(known, "_FLOOD_SECONDS", 0.0)
    assert store.guess(_marks("ASK { ?new ?b ?c }"))


def test_no_more_is_remembered_than_fits(monkeypatch: pytest.MonkeyPatch) -> None:
    """The oldest are forgotten first."""
    monkeypatch.setattr(known, "_REMEMBERED", 2)
    store = Known(100)
    for text in ("ASK { ?a ?b ?c }", "ASK { ?d ?e ?f }", "ASK { ?g ?h ?i }"):
        store.note(_marks(text), quick=False)
    assert [store.is_slow(_marks(f"ASK {{ {text} }}")) for text in ("?a ?b ?c", "?d ?e ?f", "?g ?h ?i")] == [
        False,
        True,
        True,
    ]
