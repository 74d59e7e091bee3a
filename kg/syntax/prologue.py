"""Prefix and base declarations of queries and rules."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Final

from kg.syntax.lexer import tokens

_PREFIX: Final = re.compile(r"@?prefix\s+([\w.-]*):\s*<([^>]*)>", re.IGNORECASE)
_LENGTHS: Final = {"prefix": 3, "base": 2, "@prefix": 4, "@base": 3}
"""Number of tokens of a declaration, by its keyword."""


def declared(text: str) -> dict[str, str]:
    """Return the prefixes that a text of SPARQL or Turtle declares anywhere, even if it has errors."""
    return dict(_PREFIX.findall(text))


def declaration(text: str, prefixes: Mapping[str, str], *, turtle: bool = False) -> tuple[int, str]:
    """Return offset and text of an insertion that declares prefixes: after other declarations, or before the query.

    A comment at the start of the text stays first.
    """
    at = _declared_until(text)
    form = "@prefix {}: <{}> ." if turtle else "PREFIX {}: <{}>"
    lines = "\n".join(form.format(*each) for each in prefixes.items())
    return at, f"{lines}\n" if at == 0 or text[at - 1] == "\n" else f"\n{lines}"


def _declared_until(text: str) -> int:
    """Return the offset for another declaration."""
    end, remaining = 0, list(tokens(text))
    while remaining and (length := _LENGTHS.get(remaining[0].text.lower())):
        if len(remaining) < length:
            break
        end, remaining = remaining[length - 1].end, remaining[length:]
    if end == 0:
        return remaining[0].start if remaining else 0
    following = text.find("\n", end)
    return end if following < 0 or text[end:following].strip() else following + 1
