"""Catalogue of error codes, shared by `kg explain KG101`, the documentation and the pages.

The hundreds digit is the area: 0 usage and settings, 1 reading sources, 2 rules, 3 the store, 4 findings in an
architecture, 5 queries, 6 graph and ontology, 7 search and evaluation, 8 robots, 9 inside `kg` itself.
"""

from __future__ import annotations

from typing import Final

from kg.codes import (
    architecture,
    assistants,
    defects,
    graphs,
    queries,
    robots,
    rules,
    search,
    server,
    shell,
    sources,
    stores,
    updates,
    usage,
)
from kg.codes.entry import CodeEntry

__all__ = ["CATALOGUE", "CodeEntry"]

CATALOGUE: Final[dict[str, CodeEntry]] = {
    **usage.CODES,
    **sources.CODES,
    **rules.CODES,
    **stores.CODES,
    **architecture.CODES,
    **queries.CODES,
    **server.CODES,
    **shell.CODES,
    **assistants.CODES,
    **updates.CODES,
    **graphs.CODES,
    **search.CODES,
    **robots.CODES,
    **defects.CODES,
}
"""Entries by code, in ascending order."""
