"""The way back of `kg.graph.texts`: descriptions of node types are read from the graph as facts."""

from __future__ import annotations

import re
from collections import defaultdict
from typing import TYPE_CHECKING, Any, Final

from kg.facts import Description, DescriptionKind, Location

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

__all__ = ["DESCRIPTIONS", "descriptions_of", "summary"]

DESCRIPTIONS: Final = """
SELECT ?node ?text ?kind ?path ?line ?heading WHERE {
  %s
  ?node rnkg:hasDescription ?said .
  ?said rnkg:text ?text ; rnkg:descriptionKind ?kind ; rnkg:path ?path ; rnkg:line ?line .
  OPTIONAL { ?said rnkg:heading ?heading }
}"""
"""The query for the descriptions of nodes that a pattern for ?node chooses."""

_BEST: Final = (
    DescriptionKind.PLUGIN,
    DescriptionKind.WIKI,
    DescriptionKind.DOCSTRING,
    DescriptionKind.README,
    DescriptionKind.COMMENT,
    DescriptionKind.LAUNCH,
    DescriptionKind.MANIFEST,
)
"""Kinds of descriptions, those first that are written to say what a node is for."""
_SENTENCE: Final = re.compile(r"(?<=[^.\s]{2}[.!?])\s+(?=[A-Z])")


def descriptions_of(rows: Iterable[Any]) -> Mapping[str, tuple[Description, ...]]:
    """Return the descriptions of each node by its IRI, the best first, from the rows of `DESCRIPTIONS`."""
    found: defaultdict[str, list[Description]] = defaultdict(list)
    for row in rows:
        place = Location(row["path"].value, int(row["line"].value))
        kind, heading = DescriptionKind(row["kind"].value), row["heading"]
        found[row["node"].value].append(
            Description(row["text"].value, kind, place, heading=heading.value if heading else None)
        )
    return {node: tuple(sorted(said, key=_rank)) for node, said in found.items()}


def _rank(one: Description) -> tuple[int, str, int, str]:
    return _BEST.index(one.kind), one.location.path, one.location.line, one.text


def summary(said: Iterable[Description]) -> str | None:
    """Return the first sentence of the first description; None where there is none."""
    first = next(iter(said), None)
    return _SENTENCE.split(first.text, maxsplit=1)[0] if first else None
