"""Random rules in SPARQL and small graphs: all constructs of decomposition, deeply nested."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypeVar

from pyoxigraph import DefaultGraph, Literal, NamedNode, Quad

if TYPE_CHECKING:
    from collections.abc import Callable
    from random import Random

__all__ = ["Texts", "graph"]

T = TypeVar("T")

NODES: Final = [NamedNode(f"urn:{name}") for name in "abc"]
PREDICATES: Final = [NamedNode(f"urn:{name}") for name in "pqr"]
VARIABLES: Final = ["?x", "?y", "?z", "?v"]
OBJECTS: Final[list[NamedNode | Literal]] = [*NODES, *NODES, Literal(1), Literal(2)]
GRAPHS: Final[list[NamedNode | DefaultGraph]] = [DefaultGraph(), DefaultGraph(), DefaultGraph(), NamedNode("urn:g")]
ALL_NODES: Final = {Quad(NODES[0], NamedNode("urn:u"), node, DefaultGraph()) for node in OBJECTS}
"""All constants of paths are nodes of the graph: SPARQL has paths of length zero at others, the engine does not."""


def graph(random: Random) -> set[Quad]:
    """Return a small graph in two graphs."""
    return ALL_NODES | {
        Quad(random.choice(NODES), random.choice(PREDICATES), random.choice(OBJECTS), random.choice(GRAPHS))
        for _ in range(random.randint(2, 12))
    }


@dataclass(slots=True)
class Texts:
    """Generator of texts; nested parts become simpler with each level."""

    random: Random

    def rule(self) -> str:
        """Return a rule whose head uses variables of its body."""
        body = self.group(self.random.choice([1, 2, 2, 3]))
        ends = [name for name in (*VARIABLES, "?n") if name in body] or ["<urn:a>"]
        head = [f"{self._of(ends)} <urn:h{number}> {self._of(ends)} ." for number in range(self.random.randint(1, 2))]
        return f"CONSTRUCT {{ {' '.join(head)} }} WHERE {body}"

    def group(self, depth: int) -> str:
        """Return a group in braces."""
        elements = [self._element(depth) for _ in range(self.random.randint(0, 2))]
        elements.insert(self.random.choice([0, 0, len(elements)]), self.triple())
        if self._maybe(0.3):
            elements.insert(self.random.randint(0, len(elements)), f"FILTER({self.test(2)})")
        return f"{{ {' '.join(elements)} }}"

    def _element(self, depth: int) -> str:
        if depth <= 0 or self._maybe(0.3):
            return self._of([self.triple, self.triple, self._bind, self._table])()
        inner = depth - 1
        made: Callable[[], str] = self._of(
            [
                lambda: f"OPTIONAL {self.group(inner)}",
                lambda: f"OPTIONAL {self.group(inner)}",
                lambda: f"{self.group(inner)} UNION {self.group(inner)}",
                lambda: f"MINUS {self.group(inner)}",
                lambda: f"FILTER EXISTS {self.group(inner)}",
                lambda: f"FILTER NOT EXISTS {self.group(inner)}",
                lambda: f"FILTER({self.test(1)} && !EXISTS {self.group(inner)})",
                lambda: f"FILTER({self.test(1)} || EXISTS {self.group(inner)})",
                lambda: f"GRAPH <urn:g> {self.group(inner)}",
                lambda: self._select(inner),
                lambda: self._select(inner),
                lambda: self.group(inner),
            ]
        )
        return made()

    def triple(self) -> str:
        """Return a triple pattern."""
        start = self._of([*VARIABLES, *VARIABLES, "<urn:a>", "<urn:b>", "[]"])
        end = self._of([*VARIABLES, *VARIABLES, "<urn:a>", "<urn:c>", "1", f"[ {self._iri()} {self._of(VARIABLES)} ]"])
        predicate = self.path(3) if self._maybe(0.4) else "?p" if self._maybe(0.05) else self._iri()
        return f"{start} {predicate} {end} ."

    def path(self, depth: int) -> str:
        """Return a property path."""
        if depth <= 0 or self._maybe(0.2):
            return self._iri()
        one, other = self.path(depth - 1), self.path(depth - 1)
        negated = f"!({self._iri()}|^{self._iri()})"
        repeated = [f"({one}){sign}" for sign in "**++?"]
        return self._of([f"({one}/{other})", f"({one}|{other})", f"^({one})", *repeated, negated, f"!{self._iri()}"])

    def test(self, depth: int) -> str:
        """Return an expression that is true, false or an error."""
        one, other = self._of(VARIABLES), self._of(VARIABLES)
        tests = [f"{one} != {other}", f"{one} = {self._term()}", f"BOUND({one})", f"!BOUND({one})", f"isIRI({one})"]
        tests += [f"COALESCE({one} > 1, {self._of(['true', 'false'])})", f"{one} IN ({other}, {self._term()})"]
        if depth > 0 and self._maybe(0.4):
            inner = self.test(depth - 1)
            return self._of([f"({self.test(depth - 1)} {sign} {inner})" for sign in ("&&", "||")] + [f"!({inner})"])
        return self._of(tests)

    def _bind(self) -> str:
        one, other = self._of(VARIABLES), self._of(VARIABLES)
        values = [self._term(), one, f"{one} + 1", f"IF({self.test(1)}, {one}, {other})"]
        values.append(f"COALESCE({one}, {self._term()})")
        return f"BIND({self._of(values)} AS {self._of(['?v', '?v', '?z', '?t'])})"

    def _table(self) -> str:
        cells = [self._of([self._term(), self._term(), "UNDEF"]) for _ in range(4)]
        return "VALUES (?x ?y) {{ ({} {}) ({} {}) }}".format(*cells)

    def _select(self, depth: int) -> str:
        body = self.group(depth)
        columns = ["?x (COUNT(*) AS {})", "?y (COUNT(DISTINCT ?z) AS {})", "?x (SUM(?y) AS {})", "?x (MAX(?z) AS {})"]
        if self._maybe(0.4):
            return f"{{ SELECT {self._of(['?x ?y', 'DISTINCT ?x ?z', '*', '?x (?y AS ?t)', '?z'])} WHERE {body} }}"
        if self._maybe(0.2):
            return f"{{ SELECT {self._of(['(COUNT(?y) + 1 AS ?n)', '(MIN(?y) AS ?n)'])} WHERE {body} }}"
        column = self._of(columns).format(self._of(["?n", "?n", "?v"]))
        having = self._of(["", "", " HAVING(COUNT(*) > 1)", " HAVING(SUM(?y) > 1)"])
        keys = self._of([column[:2], column[:2], f"{column[:2]} {self._of(VARIABLES[:3])}"])
        return f"{{ SELECT {column} WHERE {body} GROUP BY {keys}{having} }}"

    def _iri(self) -> str:
        return str(self._of(PREDICATES))

    def _term(self) -> str:
        return self._of(["<urn:a>", "<urn:b>", "<urn:c>", "1"])

    def _of(self, choices: list[T]) -> T:
        return self.random.choice(choices)

    def _maybe(self, share: float) -> bool:
        return self.random.random() < share
