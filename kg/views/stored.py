"""Stored queries: descriptions, parameters, and their text with values in it."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from kg.query.binding import bind
from kg.query.stored import StoredQuery, discover, find
from kg.views.arguments import texts

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.settings import Settings
    from kg.store.interface import Snapshot


def query_object(query: StoredQuery) -> dict[str, Any]:
    """Return a query as plain values: `query` (its name), `title`, `description`, `file`, `parameters`, `text`.

    A parameter has `name`, `type` (string, name, integer, boolean or iri), `example`, `description` and `default`
    (SPARQL, null when it may be left out).
    """
    return {
        "query": query.name,
        "title": query.title,
        "description": query.description,
        "file": str(query.path),
        "parameters": [asdict(one) for one in query.parameters],
        "text": query.text,
    }


def stored(
    snapshot: Snapshot,  # noqa: ARG001 - every view is given it
    settings: Settings,
    name: str = "",
    values: str | Mapping[str, str] = "",
) -> dict[str, Any]:
    """Return the stored queries as `queries`, sorted by name; or of the one called `name` its `query_object`.

    The one also has `bound`, its text with `values` for its parameters: name to text, or a JSON object of such. Empty
    values are left out.

    Raises:
        UsageError: KG001 for an unknown query, KG003 for values that are not a JSON object.
        QueryError: KG505 for a value of the wrong type.
    """
    if not name:
        return {"queries": [query_object(one) for one in discover(settings.queries).values()]}
    query = find(name, settings.queries)
    given = {key: value for key, value in texts(values, "values").items() if value}
    return {**query_object(query), "bound": bind(query.text, query.bind(given))}
