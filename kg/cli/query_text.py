"""Queries from arguments: typed, from a file or standard input, or stored under a name, with parameters."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.errors import UsageError
from kg.lazily import lazily

if TYPE_CHECKING:
    from kg.settings import Settings

with lazily():
    from kg.query.stored import QueryParameter, StoredQuery, TermText, find, read

_PAIR: Final = re.compile(r"\s*[?$]?(?P<name>[^=:\s]+)\s*(?P<sign>:?=)(?P<value>.*)", re.DOTALL)
_NAME: Final = re.compile(r"[\w.-]+(/[\w.-]+)*")


def pairs(given: list[str]) -> dict[str, str]:
    """Return the values of parameters given as `name=value`, or as `name:=term`."""
    values: dict[str, str] = {}
    for pair in given:
        match = _PAIR.fullmatch(pair)
        if match is None:
            hint = "Write --param NAME=VALUE, or NAME:=TERM."
            raise UsageError("KG003", f"`{pair}` is not a parameter", hint=hint)
        if match["name"] in values:
            raise UsageError("KG003", f"the parameter {match['name']} is given twice", hint="Give it one value.")
        values[match["name"]] = TermText(match["value"]) if match["sign"] == ":=" else match["value"]
    return values


def resolve_query(text: str | None, file: Path | None, settings: Settings) -> StoredQuery:
    """Return the query of the arguments: typed, from a file or standard input, or stored under a name."""
    if (text is None) == (file is None):
        raise UsageError("KG003", "give a query or a file with one", hint="See `kg query --help`.")
    if text == "-" or str(file) == "-":
        return _typed(sys.stdin.read().removeprefix("\ufeff"), "standard input")
    if file is not None:
        return read(file, str(file))
    if text and _NAME.fullmatch(text):
        return find(text, settings.queries)
    return _typed(text or "", "query")


def _typed(text: str, place: str) -> StoredQuery:
    """Return an ad-hoc query; each of its variables may be a parameter."""
    names = dict.fromkeys(re.findall(r"[?$](\w+)", text))
    parameters = tuple(QueryParameter(name, "string", "", "", None) for name in names)
    return StoredQuery("that was given", Path(place), "", "", parameters, text)
