"""The codes of queries: KG5xx."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

__all__ = ["CODES"]

CODES: Final = {
    "KG501": CodeEntry(
        "query does not parse",
        "The query is not SPARQL 1.1 at the place given.",
        "Correct the query there.",
    ),
    "KG502": CodeEntry(
        "query refused",
        "The query nests too deep or asks the store to call another server (SERVICE, LOAD).",
        "Simplify the query; calls to other servers are off.",
    ),
    "KG503": CodeEntry(
        "deadline",
        "The query ran longer than its deadline.",
        "Make the query more specific or raise `--timeout`.",
    ),
    "KG504": CodeEntry(
        "format",
        "The result cannot be written in the format asked for.",
        "Use one of the formats named.",
    ),
    "KG505": CodeEntry(
        "query parameter",
        "A stored query was called with a parameter it does not have, without one it needs, or with a bad value.",
        "`kg query NAME --help-query` lists the parameters.",
    ),
    "KG506": CodeEntry(
        "query failed",
        "The engine could not evaluate the query.",
        "Read the engine's message; `kg doctor` checks the store.",
    ),
}
