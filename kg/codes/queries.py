"""The codes of queries: KG5xx."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

CODES: Final = {
    "KG501": CodeEntry(
        "query does not parse",
        "The query is not valid SPARQL 1.1 at the place given.",
        "Correct the query there.",
    ),
    "KG502": CodeEntry(
        "query refused",
        "The query asks the store to call another server (SERVICE, LOAD), which is disabled.",
        "Remove the call from the query.",
    ),
    "KG503": CodeEntry(
        "deadline exceeded",
        "The query ran longer than its deadline.",
        "Make the query more specific or raise `--timeout`.",
    ),
    "KG504": CodeEntry(
        "unsupported format",
        "The result cannot be written in the requested format.",
        "Use one of the formats that the message lists.",
    ),
    "KG505": CodeEntry(
        "invalid query parameter",
        "A stored query was called with an unknown parameter, without a required one, or with an invalid value.",
        "`kg query NAME --help-query` lists the parameters.",
    ),
    "KG506": CodeEntry(
        "query failed",
        "The engine cannot evaluate the query.",
        "Read the engine's message, and change the part of the query that it names.",
    ),
    "KG507": CodeEntry(
        "out of memory",
        "The query needed more memory than one query is allowed to use.",
        "Request fewer rows, avoid ORDER BY and cross products, or raise `--max-memory`.",
    ),
    "KG508": CodeEntry(
        "reader process ended",
        "The reader process of the query ended before the result was complete. Other readers replaced it.",
        "Simplify the query. If it happens again, report the query.",
    ),
    "KG509": CodeEntry(
        "busy",
        "The queue of queries is full, or the maximum number of long queries is running.",
        "Try again in a moment, or raise `--readers` or `--queue`.",
    ),
    "KG510": CodeEntry(
        "cancelled",
        "The query was cancelled while it ran.",
        "Run it again if you did not mean to cancel it.",
    ),
    "KG511": CodeEntry(
        "result too large",
        "The result exceeds the maximum number of bytes.",
        "Request fewer rows with LIMIT, or raise `--max-answer-bytes`.",
    ),
    "KG512": CodeEntry(
        "data has changed",
        "The query refers to a snapshot of the data that no longer exists.",
        "Run the query without the snapshot to use the current data.",
    ),
    "KG513": CodeEntry(
        "unknown term",
        "A name in the query is missing from the store, so its pattern matches nothing.",
        "Use one of the names suggested, or complete the name from the store.",
    ),
    "KG514": CodeEntry(
        "unbound variable",
        "The query selects or computes with a variable that no pattern binds.",
        "Correct its name, or add the pattern that binds it.",
    ),
    "KG515": CodeEntry(
        "cartesian product of patterns",
        "Two parts of the query share no variable. Each match of one is combined with each match of the other.",
        "Join them by a variable, or by a FILTER that compares them.",
    ),
    "KG516": CodeEntry(
        "query too deep",
        "The query exceeds the engine's limit on nesting, operators or patterns.",
        "Split or simplify the query.",
    ),
}
