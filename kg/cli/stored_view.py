"""Stored queries for people: the list of them, and what one of them answers and takes."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING

from kg.cli.output import Column

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.query.stored import StoredQuery

COLUMNS = (Column("query", "name"), Column("answers"), Column("parameters", spare=1))


def list_rows(queries: Iterable[StoredQuery]) -> list[tuple[str, str, str]]:
    """Return a row for each query: name, what it answers, its parameters."""
    return [(one.name, one.title, " ".join(parameter.name for parameter in one.parameters)) for one in queries]


def manual(query: StoredQuery) -> Iterator[str]:
    """Yield the lines about one query, its text at the end."""
    yield f"{query.name}: {query.title}"
    if query.description:
        yield ""
        yield query.description
    if query.parameters:
        yield ""
        yield "Parameters:"
        longest = max(len(one.name) for one in query.parameters)
        for one in query.parameters:
            default = f", by default {one.default}" if one.default else ""
            yield f"  {one.name:<{longest}}  {one.description} ({one.type}{default})"
        first = query.parameters[0]
        yield ""
        yield "For example:"
        yield f"  kg query {query.name} --param {first.name}={shlex.quote(first.example)}"
    yield ""
    lines = [line for line in query.text.splitlines() if not line.startswith("#")]
    yield from "\n".join(lines).strip().splitlines()
