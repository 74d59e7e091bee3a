"""Lists as SPARQL."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kg.query.core import run
from kg.query.result import Solutions
from kg.views.listing import listing
from kg.views.lists import LISTS

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

_WITHOUT = {"findings"}


def _number(snapshot: EmbeddedSnapshot, query: str) -> int:
    found = run(snapshot, query)
    assert isinstance(found, Solutions)
    return len(list(found.rows))


@pytest.mark.parametrize("of", LISTS)
def test_the_query_of_a_list_has_its_rows(snapshot: EmbeddedSnapshot, settings: Settings, of: str) -> None:
    """The query has as many rows as the list, for each value of each filter that has a query, and for words."""
    whole = listing(snapshot, settings, of=of)
    assert (whole["query"] is None) == (of in _WITHOUT)
    asked = [{}, {"text": "SCAN r"}]
    asked += [{name: one["value"]} for name, values in whole["facets"].items() for one in values]
    tried = 0
    for given in asked:
        found = listing(snapshot, settings, of=of, **given)
        if found["query"] is not None:
            assert (given, _number(snapshot, found["query"])) == (given, found["total"])
            tried += 1
    assert tried > 0 or of in _WITHOUT
