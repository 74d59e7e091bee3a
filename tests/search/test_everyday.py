"""Everyday wordings: how they are matched, and what the table of them has to be like."""

from __future__ import annotations

from typing import Final

import pytest
from search.store import CONTENT

from kg.search.index import build
from kg.search.names import Names
from kg.search.needs import meanings, parse
from kg.search.searching import wording_scores
from kg.search.words import content_terms, lexicon, phrase

INDEX: Final = build(CONTENT)
NAMES: Final = Names(INDEX.features.names, INDEX.concepts, INDEX.text.names)


def terms(text: str) -> set[tuple[str, ...]]:
    """Return the terms that the everyday wordings of a text stand for."""
    return {term for one in meanings(text.split()) for term in one.terms}


@pytest.mark.parametrize("text", ["find the way", "find its way", "finds my way", "find way"])
def test_articles_and_endings_do_not_count(text: str) -> None:
    """`find its way` is found in other forms, but not in another order."""
    assert content_terms("navigation") in terms(text)
    assert content_terms("navigation") not in terms("way find")


def test_a_few_words_may_stand_at_a_gap() -> None:
    """The hand that picks something up is a gripper, if what it picks up has a short name."""
    assert ("gripper",) in terms("pick the red box up")
    assert ("gripper",) not in terms("pick one or two or three of them up")


def test_a_part_of_a_longer_wording_does_not_count() -> None:
    """`floor plan` is a map; the floor of it is none."""
    assert [one.places for one in meanings(["the", "floor", "plan"])] == [(1, 2)]


def test_the_first_term_is_the_best() -> None:
    """Each further term of an entry weighs less."""
    (meaning,) = meanings(["bump", "into"])
    weights = list(meaning.terms.values())
    assert weights[0] == 1.0
    assert weights == sorted(weights, reverse=True)
    assert weights[-1] < 1.0


def test_a_word_with_a_meaning_is_not_unknown() -> None:
    """No node is described by `dodge`, which is a way to avoid obstacles; similar spellings are not searched."""
    (wording,) = parse("dodge", NAMES).wordings
    assert not wording.unknown
    assert not wording.near
    assert ("avoid",) in {one.terms for one in wording.alternatives}


def test_the_more_nodes_have_a_word_the_less_its_everyday_meaning_counts() -> None:
    """The term counts less than the same term as a synonym of a rare word."""
    (wording,) = parse("sweep", NAMES).wordings
    loose = [one for one in wording.alternatives if one.loose]
    assert loose
    assert wording_scores(INDEX, wording).max() < max(one.weight for one in loose)


def test_every_entry_can_be_matched_and_searched() -> None:
    """Each wording has words around its gaps, each term has words to search for, and none stands for itself."""
    for wording, own in lexicon().everyday.items():
        assert all(phrase(part) for part in wording.split("...")), wording
        assert all(content_terms(term) for term in own), wording
        assert wording not in own
        assert wording == wording.strip().lower()
