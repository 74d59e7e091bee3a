"""Queries from arguments: typed, from a file or standard input, or stored under a name, with parameters."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.errors import UsageError

if TYPE_CHECKING:
    from kg.query.stored import StoredQuery
    from kg.settings import Settings

_NAME: Final = re.compile(r"[\w.-]+(/[\w.-]+)*")


def pairs(given: list[str]) -> dict[str, str]:
    """Return the values of parameters given as `name=value`."""
    found = {}
    for pair in given:
        name, sign, value = pair.partition("=")
        if not sign or not name:
            raise UsageError("KG003", f"`{pair}` is not a parameter", hint="Write --param NAME=VALUE.")
        found[name.strip().lstrip("?")] = value
    return found


def query_meant(text: str | None, file: Path | None, settings: Settings) -> StoredQuery:
    """Return the query of the arguments: typed, from a file or standard input, or stored under a name."""
    from kg.query.stored import find, read  # noqa: PLC0415 - start-up time

    if (text is None) == (file is None):
        raise UsageError("KG003", "give a query or a file with one", hint="See `kg query --help`.")
    if text == "-" or str(file) == "-":
        return _typed(sys.stdin.read(), "standard input")
    if file is not None:
        return read(file, str(file))
    if text and _NAME.fullmatch(text):
        return find(text, settings.queries)
    return _typed(text or "", "query")


def _typed(text: str, place: str) -> StoredQuery:
    """Return an ad-hoc query; each of its variables may be a parameter."""
    from kg.query.stored import QueryParameter, StoredQuery  # noqa: PLC0415 - start-up time

    names = dict.fromkeys(re.findall(r"[?$](\w+)", text))
    parameters = tuple(QueryParameter(name, "string", "", "", None) for name in names)
    return StoredQuery("that was given", Path(place), "", "", parameters, text)
