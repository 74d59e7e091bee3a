from __future__ import annotations

from search.store import CONTENT

from kg.search.index import build
from kg.search.searching import Search
from kg.search.wording import question

SEARCH = Search(build(CONTENT))


def test_the_question_that_splits_best_is_asked() -> None:
    """Each answer is a value of a filter, with its number of remaining hits."""
    hits = SEARCH.find("scan camera driver merger").hits
    asked = question(hits, {})
    assert asked is not None
    for value, left in asked.answers:
        assert 0 < left < len(hits)
        kept = SEARCH.find("scan camera driver merger", {asked.kind: [value]}).hits
        assert len(kept) >= left


def test_what_was_asked_is_not_asked_again() -> None:
    """After enough questions no choice remains."""
    hits = SEARCH.find("scan camera driver merger").hits
    asked: dict[str, object] = {}
    while (one := question(hits, asked)) is not None:
        assert one.kind not in asked
        asked[one.kind] = True
    assert asked


def test_one_hit_needs_no_question() -> None:
    """A single hit cannot be split."""
    assert question(SEARCH.find("camera").hits[:1], {}) is None
