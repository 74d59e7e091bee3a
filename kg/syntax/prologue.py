"""The declarations at the beginning of a query or rule."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

from kg.syntax.lexer import tokens

if TYPE_CHECKING:
    from collections.abc import Mapping

_PREFIX: Final = re.compile(r"@?prefix\s+([\w.-]*):\s*<([^>]*)>", re.IGNORECASE)
_LENGTHS: Final = {"prefix": 3, "base": 2, "@prefix": 4, "@base": 3}
"""How many tokens a declaration has that begins with these."""


def declared(text: str) -> dict[str, str]:
    """Return the prefixes that a text of SPARQL or Turtle declares anywhere, also one with errors elsewhere."""
    return dict(_PREFIX.findall(text))


def declaration(text: str, prefixes: Mapping[str, str], *, turtle: bool = False) -> tuple[int, str]:
    """Return the offset and the text of an insertion that declares prefixes: after the others, else before the query.

    The comment at the beginning of a text stays there.
    """
    at = _declared_until(text)
    form = "@prefix {}: <{}> ." if turtle else "PREFIX {}: <{}>"
    lines = "\n".join(form.format(*each) for each in prefixes.items())
    return at, f"{lines}\n" if at == 0 or text[at - 1] == "\n" else f"\n{lines}"


def _declared_until(text: str) -> int:
    """Return the offset of a further declaration."""
    end, rest = 0, list(tokens(text))
    while rest and (length := _LENGTHS.get(rest[0].text.lower())):
        if len(rest) < length:
            break
        end, rest = rest[length - 1].end, rest[length:]
    if end == 0:
        return rest[0].start if rest else 0
    following = text.find("\n", end)
    return end if following < 0 or text[end:following].strip() else following + 1
