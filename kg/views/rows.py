"""Rows of answers: why one is there, and the place that one names: the views `why_row` and `place`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kg.facts import Location
from kg.rules.explain.rows import why_row as traced
from kg.views.arguments import texts, whole
from kg.views.evidence import places
from kg.views.terms import given_term
from kg.views.why import explaining
from kg.views.why_tree import Telling

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot


def why_row(
    snapshot: EmbeddedSnapshot, settings: Settings, *, query: str, row: str | Mapping[str, str]
) -> dict[str, Any]:
    """Return the proofs of the facts that a SELECT `query` matched for a `row`: name of variable to term, as N-Triples.

    The row may also be given as JSON. The keys: `row` (`name`, and `term`, `label`, `short` of its value), `proofs` as
    of the view `why`, `conditions`, sentences of what else held, and `remark`, which says where the row was made of
    several solutions, as those of groups are, that the facts are those of one; else it is null.

    Raises:
        UsageError: KG003 for what is not a row, or a term that is none.
        QueryError: KG502 or KG516 for a query that is refused.
        RuleError: KG201 for a query that is not a SELECT, KG226 for a row that cannot be traced back (of inner groups).
    """
    rules, view = explaining(snapshot, settings)
    terms = {name: given_term(text) for name, text in texts(row, "row").items()}
    derivation = traced(view, rules.rules, query, terms)
    telling = Telling(view, rules, places(snapshot), settings.base)
    return {
        "row": telling.bindings(terms),
        "proofs": [telling.proof(one) for one in derivation.proofs],
        "conditions": [one.text for one in derivation.conditions],
        "remark": derivation.remark,
    }


def place(snapshot: EmbeddedSnapshot, settings: Settings, *, path: str, line: str = "") -> dict[str, Any] | None:  # noqa: ARG001 - every view is given settings
    """Return the evidence of a path of a source and a line of it, where only one source has that file; else None."""
    where = places(snapshot)
    source = where.find(path)
    return None if source is None else where.evidence(source, Location(path, whole(line, 0)))
