"""Pre-binding (SHACL, appendix A): `$this` has its value everywhere in a query, also inside its groups.

The patterns that bind the focus node are at the beginning of the whole group. SPARQL joins from inside to outside,
so a group inside it that uses the variable in an expression must bind it too, in a sub-SELECT once for each node,
since aggregates count solutions.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.rules.notations.shacl.query import closing, plain, variables
from kg.syntax.lexer import Kind

if TYPE_CHECKING:
    from kg.rules.form import Term
    from kg.rules.notations.shacl.graph import ShapesGraph
    from kg.rules.notations.shacl.query import Words

_THIS: Final = "this"


def bind_inside(graph: ShapesGraph, owner: Term, words: Words, binder: str) -> Words:
    """Return the inside of a group with `binder` at the beginning of each inner group that needs `$this`.

    Raises `RuleError` KG201 for a sub-SELECT that uses `$this` and does not project it, and for an assignment to it.
    """
    return _Groups(graph, owner, binder).inside(words)


class _Groups:
    def __init__(self, graph: ShapesGraph, owner: Term, binder: str) -> None:
        self._graph = graph
        self._owner = owner
        self._binder = plain(binder)
        self._once = plain(f"{{ SELECT DISTINCT ?this WHERE {{ {binder} }} }}")

    def inside(self, words: Words) -> Words:
        """Handle the groups in `words`, which are between braces."""
        if words and words[0].text.upper() == "SELECT":
            return self._select(words)
        found: Words = []
        index = 0
        while index < len(words):
            if words[index].text != "{":
                self._check(words, index)
                found.append(words[index])
                index += 1
                continue
            end = closing(words, index)
            inner = words[index + 1 : end]
            before = words[index - 1].text.upper() if index else ""
            found.append(words[index])
            found += inner if before == "EXISTS" else self._group(inner)
            found += words[end : end + 1]
            index = end + 1
        return found

    def _group(self, inner: Words) -> Words:
        return [self._binder, *self.inside(inner)] if _needs(inner) else self.inside(inner)

    def _select(self, words: Words) -> Words:
        opening = next((index for index, word in enumerate(words) if word.text == "{"), len(words))
        end = closing(words, opening)
        head = words[:opening]
        uses = _THIS in variables(words[opening:end])
        if uses and _THIS not in variables(head) and "*" not in [word.text for word in head]:
            hint = "Project it, and group by it to aggregate: SELECT $this (COUNT(?x) AS ?n) ... GROUP BY $this."
            raise self._graph.error(
                "a sub-SELECT uses $this and does not project it", self._owner, hint=hint, offset=words[0].offset
            )
        start = [self._once] if _needs(words[opening + 1 : end]) else []
        return [*head, *words[opening : opening + 1], *start, *self.inside(words[opening + 1 : end]), *words[end:]]

    def _check(self, words: Words, index: int) -> None:
        """Refuse a query that gives `$this` another value (SHACL, appendix A)."""
        word = words[index]
        assigned = word.kind is Kind.VARIABLE and word.text[1:] == _THIS and index > 0
        if assigned and words[index - 1].text.upper() == "AS":
            hint = "Take another variable; $this is the focus node."
            raise self._graph.error("$this has a value already", self._owner, hint=hint, offset=word.offset)


def _needs(words: Words) -> bool:
    """Return whether a group uses `$this` in an expression of its own: inside brackets, or inside EXISTS."""
    if words and words[0].text.upper() == "SELECT":
        return False
    index = depth = 0
    while index < len(words):
        word = words[index]
        if word.text == "{":
            end = closing(words, index)
            if words[index - 1].text.upper() == "EXISTS" and _THIS in variables(words[index:end]):
                return True
            index = end
        elif word.text in {"(", ")"}:
            depth += 1 if word.text == "(" else -1
        elif depth > 0 and word.kind is Kind.VARIABLE and word.text[1:] == _THIS:
            return True
        index += 1
    return False
