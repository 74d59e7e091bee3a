"""The prefixes that a Turtle file declares: the short forms of its names. SPARQL inside rules has its own."""

from __future__ import annotations

from collections import deque

from pyoxigraph import RdfFormat, parse

__all__ = ["prefixes"]


def prefixes(text: str) -> dict[str, str]:
    """Return the prefixes of a file of Turtle that parses, as they are at its end."""
    parsed = parse(text.encode(), RdfFormat.TURTLE)
    deque(parsed, maxlen=0)
    return dict(parsed.prefixes)
