"""SHACL property paths (SHACL, section 2.3.1) as SPARQL paths.

A path that may be empty (`zeroOrMorePath`, `zeroOrOnePath`) also gives the node where it begins, and does so in SHACL
whether the data has that node or not; in SPARQL only a node of the data. So a path is taken apart: into one that goes
one step at least, and the fact that it may be empty.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from pyoxigraph import BlankNode, NamedNode

from kg.rules.notations.shacl.vocabulary import sh

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.rules.form import Term
    from kg.rules.notations.shacl.graph import ShapesGraph


@dataclass(frozen=True, slots=True)
class Path:
    """`text` is a SPARQL path of one step at least, None when there is none; `empty`: the path may be empty."""

    text: str | None
    empty: bool


@dataclass(frozen=True, slots=True)
class Branch:
    """Patterns and the term (a variable with `?`, or a constant) that they give; no pattern for a term known before.

    `matched`: the term is a variable that the triples of this branch bind, so that another may be in its place.
    """

    pattern: str
    term: str
    matched: bool = False

    def filtered(self, *filters: str) -> Branch:
        """Return the branch with filters behind its pattern."""
        return Branch(" ".join(part for part in (self.pattern, *filters) if part), self.term, self.matched)

    def giving(self, term: str) -> Branch | None:
        """Return the branch with another term in place of its variable; None when that cannot be put there."""
        if not self.matched:
            return None
        name = re.escape(self.term)
        return Branch(re.sub(rf"{name}(?!\w)", lambda _: term, self.pattern), term)


class Names:
    """Gives variables that a text does not have."""

    def __init__(self, used: set[str]) -> None:
        """Take the names, without `?`, that must not be given."""
        self._used = used
        self._count = 0

    def fresh(self) -> str:
        """Return the next variable, with `?`."""
        self._count += 1
        while f"v{self._count}" in self._used:
            self._count += 1
        return f"?v{self._count}"


def steps(path: Path, start: str, names: Names) -> Iterator[Branch]:
    """Yield how the values of a path are reached from a term."""
    if path.empty:
        yield Branch("", start)
    if path.text is not None:
        value = names.fresh()
        yield Branch(f"{start} {path.text} {value} .", value, matched=True)


def path_of(graph: ShapesGraph, node: Term, owner: Term) -> Path:
    """Return the path that a node of the graph stands for; KG201 when it is none."""
    return _Paths(graph, owner).path(node, ())


_KINDS: Final = {
    "inversePath": ("^", "", False),
    "zeroOrMorePath": ("", "+", True),
    "oneOrMorePath": ("", "+", False),
    "zeroOrOnePath": ("", "", True),
}
"""The property of a path to what SPARQL has before and behind its inner path, and whether it may be empty."""


class _Paths:
    """Reads the paths of one owner, which errors name."""

    def __init__(self, graph: ShapesGraph, owner: Term) -> None:
        self._graph = graph
        self._owner = owner

    def path(self, node: Term, around: tuple[Term, ...]) -> Path:
        if isinstance(node, NamedNode):
            return Path(str(node), empty=False)
        if not isinstance(node, BlankNode) or node in around:
            raise self._malformed()
        inside = (*around, node)
        if self._graph.is_list(node):
            return _sequence([self.path(member, inside) for member in self._members(node)])
        for name, (before, behind, empty) in _KINDS.items():
            if inner := self._graph.values(node, sh(name)):
                path = self.path(inner[0], inside)
                return Path(f"{before}({path.text}){behind}" if path.text else None, path.empty or empty)
        if listed := self._graph.values(node, sh("alternativePath")):
            parts = [self.path(member, inside) for member in self._members(listed[0])]
            return Path(_any([part.text for part in parts if part.text]), any(part.empty for part in parts))
        raise self._malformed()

    def _members(self, node: Term) -> list[Term]:
        members = self._graph.members(node, self._owner)
        if len(members) < 2:  # noqa: PLR2004 - the standard asks for two
            raise self._malformed()
        return members

    def _malformed(self) -> Exception:
        return self._graph.error(
            f"{self._graph.called(self._owner)} has an invalid sh:path",
            self._owner,
            hint="A path is an IRI, a list of two paths at least, or a blank node with one of sh:inversePath, "
            "sh:alternativePath, sh:zeroOrMorePath, sh:oneOrMorePath and sh:zeroOrOnePath.",
        )


def _any(texts: list[str]) -> str | None:
    distinct = list(dict.fromkeys(texts))
    return f"({'|'.join(distinct)})" if len(distinct) > 1 else next(iter(distinct), None)


def _sequence(parts: list[Path]) -> Path:
    """Join paths; one that may be empty may be left out."""
    first, *others = parts
    for part in others:
        joined = f"{first.text}/{part.text}" if first.text and part.text else None
        texts = [joined, first.text if part.empty else None, part.text if first.empty else None]
        first = Path(
            _any([f"({text})" if text == joined else text for text in texts if text]), first.empty and part.empty
        )
    return first
