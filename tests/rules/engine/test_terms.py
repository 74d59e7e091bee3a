from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pyoxigraph import BlankNode, Literal, NamedNode, Triple

from kg.rules.engine import terms
from kg.rules.engine.pages import Pages
from kg.rules.engine.terms import BLANK, IRI, LITERAL, TRIPLE, Dictionary, Spellings
from kg.store.terms import spell

if TYPE_CHECKING:
    from pathlib import Path

    from kg.rules.form import Term

INNER = Triple(NamedNode("urn:a"), NamedNode("urn:b"), Literal("x", language="en"))
TERMS: list[Term] = [
    NamedNode("urn:a"),
    BlankNode("b1"),
    Literal(""),
    Literal('a "b" \\ \n'),
    Literal(3),
    INNER,
    Triple(BlankNode("b1"), NamedNode("urn:b"), INNER),
]

KINDS = [IRI, BLANK, LITERAL, LITERAL, LITERAL, TRIPLE, TRIPLE]


@pytest.mark.parametrize("term", TERMS)
def test_a_term_is_read_back_as_it_was(term: Term) -> None:
    """A term survives spelling and parsing, and has one identifier."""
    dictionary = Dictionary()
    identifier = dictionary.intern_term(term)
    assert dictionary.term(identifier) == term
    assert dictionary.intern(spell(term)) == identifier == dictionary.find(spell(term))


def test_kinds_are_known_for_terms_that_come_later_too() -> None:
    """The kind of a term follows from its spelling; "unbound" has none."""
    dictionary = Dictionary()
    first = dictionary.intern_all(spell(term) for term in TERMS[:2])
    assert dictionary.kinds(first).tolist() == [IRI, BLANK]
    later = dictionary.intern_all(spell(term) for term in TERMS)
    assert dictionary.kinds(np.append(later, 0)).tolist() == [*KINDS, 0]


def test_kinds_of_kept_terms_are_read_from_their_text() -> None:
    """Terms in a file and later terms have the same kinds as in memory."""
    dictionary = Dictionary(Spellings.of([spell(term) for term in TERMS[:4]]))
    every = dictionary.intern_all([spell(term) for term in TERMS])
    assert dictionary.kinds(np.append(every, [0, every[1]])).tolist() == [*KINDS, 0, BLANK]


def test_a_triple_term_has_the_parts_it_was_made_of() -> None:
    """Its parts are the same, made of identifiers or parsed from a spelling."""
    dictionary = Dictionary()
    read = dictionary.intern_term(INNER)
    parts = dictionary.parts(read)
    assert [dictionary.term(part) for part in parts] == [INNER.subject, INNER.predicate, INNER.object]
    assert dictionary.intern_triple(*parts) == read


@given(st.text(st.characters(codec="utf-8"), max_size=5))
def test_strings_of_any_characters_survive(text: str) -> None:
    """Control characters, quotes and all of Unicode survive spelling and parsing."""
    dictionary = Dictionary()
    assert dictionary.term(dictionary.intern_term(Literal(text))) == Literal(text)


texts = st.lists(st.binary(max_size=3), unique=True, max_size=40)


@given(texts, texts)
def test_kept_terms_are_those_that_were_kept(kept: list[bytes], asked: list[bytes]) -> None:
    """A dictionary that loads its terms on access gives the same identifiers."""
    lazy, eager = Dictionary(Spellings.of(kept)), Dictionary.of(kept)
    assert [lazy.find(one) for one in asked] == [eager.find(one) for one in asked]
    assert lazy.intern_all(asked).tolist() == eager.intern_all(asked).tolist()
    numbers = range(len(eager))
    assert lazy.spellings(numbers) == eager.spellings(numbers) == [lazy.spelling(number) for number in numbers]


def test_kept_terms_with_one_checksum_are_told_apart() -> None:
    """These two spellings have the same CRC-32."""
    kept = Spellings.of([b"plumless", b"buckeroo"])
    assert [kept.find(one) for one in (b"plumless", b"buckeroo", b"other")] == [0, 1, None]


@given(st.lists(texts, max_size=4))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_terms_are_written_whole(tmp_path: Path, steps: list[list[bytes]]) -> None:
    """Terms in memory and in several files become one file, in which each has its identifier."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(terms, "_RECENT", 3)
        dictionary = Dictionary(pages=Pages(tmp_path))
        for step in steps:
            dictionary.intern_all(step)
        known = {one: dictionary.intern(one) for step in steps for one in step}
    kept, parts = dictionary.whole()
    whole = replace(kept, text=memoryview(b"".join(parts)))
    assert len(whole) == len(known)
    assert {one: whole.find(one) for one in known} == {one: number - 1 for one, number in known.items()}
    again = Dictionary(whole)
    assert again.spellings(list(known.values())) == list(known)
    assert all(again.intern(one) == number for one, number in known.items())
