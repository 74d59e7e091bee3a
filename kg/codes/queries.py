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
        "The query asks the store to call another server (SERVICE, LOAD).",
        "Ask without it; calls to other servers are off.",
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
        "The engine cannot evaluate the query.",
        "Read the engine's message, and change what it names.",
    ),
    "KG507": CodeEntry(
        "out of memory",
        "The query needed more memory than one query may use.",
        "Ask for fewer rows, avoid ORDER BY and cross products, or raise `--max-memory`.",
    ),
    "KG508": CodeEntry(
        "reader ended",
        "The process that ran the query ended before the answer was whole; others took its place.",
        "Simplify the query; if it happens again, report the query.",
    ),
    "KG509": CodeEntry(
        "busy",
        "As many queries wait as may, or as many long queries run.",
        "Try again in a moment, or raise `--readers` or `--queue`.",
    ),
    "KG510": CodeEntry(
        "cancelled",
        "The query was cancelled while it ran.",
        "Run it again if that was not meant.",
    ),
    "KG511": CodeEntry(
        "answer too large",
        "The answer has more bytes than one answer may have.",
        "Ask for fewer rows with LIMIT, or raise `--max-answer-bytes`.",
    ),
    "KG512": CodeEntry(
        "data has changed",
        "The answer was asked of a snapshot of the data that is no longer there.",
        "Ask again without the snapshot to see what holds now.",
    ),
    "KG513": CodeEntry(
        "unknown term",
        "A name of the query occurs nowhere in the store, so that a pattern with it finds nothing.",
        "Use one of the names suggested, or complete it from the store.",
    ),
    "KG514": CodeEntry(
        "unbound variable",
        "The query asks for, or computes with, a variable that no pattern gives a value.",
        "Correct its name, or add the pattern that binds it.",
    ),
    "KG515": CodeEntry(
        "cartesian product of patterns",
        "Two parts of the query share no variable, so that each match of one is combined with each of the other.",
        "Join them by a variable, or by a FILTER that compares them.",
    ),
    "KG516": CodeEntry(
        "query too deep",
        "The query nests deeper, or has more operators and patterns, than the engine survives.",
        "Write the query with fewer of them.",
    ),
}
