"""Groups of a WHERE clause (SPARQL 1.1, section 19.8, productions from GroupGraphPattern on)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.rules.syntax.lexer import Kind
from kg.rules.syntax.scope import visible
from kg.rules.syntax.selects import Selects
from kg.rules.syntax.terms import Mode
from kg.rules.syntax.tree import Bind, Exists, Filter, GraphBlock, Group, Minus, Optional, SubSelect, Union, ValuesBlock

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.rules.syntax.tree import Node

__all__ = ["Patterns", "filter_of"]

_KEYWORDS: Final = ("FILTER", "OPTIONAL", "UNION", "MINUS", "BIND", "VALUES", "GRAPH", "SELECT", "SERVICE", "NOT")


class Patterns(Selects):
    """Reads groups."""

    def group(self) -> Group:
        """Read a group in braces, or a sub-SELECT in braces."""
        outer, first = self.block, len(self.consumed)
        start = self.expect("{").start
        with self.nested():
            self.new_block()
            nodes: list[Node] = [self.sub_select()] if self.at_word("SELECT") else self._nodes()
            self.expect("}", " or a pattern")
        self.block = outer
        return Group(tuple(nodes), self.span(start), self.spelling(self.consumed[first:]))

    def _nodes(self) -> list[Node]:
        nodes: list[Node] = []
        while True:
            nodes += self.triples(Mode.PATTERN)
            if self.at("}") or self.at_end():
                return nodes
            if self.at_subject():
                raise self.expected("`.` or `}`")
            nodes.append(self._node_at(nodes))
            if not isinstance(nodes[-1], Filter | Exists):
                self.new_block()
            self.accept(".")

    def _node_at(self, before: list[Node]) -> Node:
        if self.at("{"):
            return self._union()
        readers: dict[str, Callable[[], Node]] = {
            "FILTER": self._filter,
            "OPTIONAL": self._optional,
            "MINUS": self._minus,
            "VALUES": self._values,
            "GRAPH": self._graph,
        }
        word = self.token.text.upper() if self.token.kind is Kind.WORD else ""
        if word == "BIND":
            return self._bind(before)
        if word == "SERVICE":
            hint = "Rules read the store alone; load what the other server has first."
            raise self.error("SERVICE is not allowed in rules", self.token.start, code="KG209", hint=hint)
        if word not in readers:
            raise self.expected("a pattern or `}`", _KEYWORDS)
        return readers[word]()

    def _filter(self) -> Node:
        start = self.advance().start
        first = len(self.consumed)
        expression = self.constraint()
        node = Filter(expression, self.span(start))
        outside = [token.text for token in self.consumed[first:] if not _within(token.start, node)]
        return filter_of(node, outside)

    def _optional(self) -> Node:
        start = self.advance().start
        return Optional(self.group(), self.span(start))

    def _minus(self) -> Node:
        start = self.advance().start
        return Minus(self.group(), self.span(start))

    def _values(self) -> Node:
        start = self.advance().start
        variables, rows = self.table()
        return ValuesBlock(variables, rows, self.span(start))

    def _graph(self) -> Node:
        start = self.advance().start
        name = self.variable() if self.token.kind is Kind.VARIABLE else self.iri("a variable or the IRI of a graph")
        return GraphBlock(name, self.group(), self.span(start))

    def _bind(self, before: list[Node]) -> Node:
        start = self.advance().start
        self.expect("(")
        expression = self.expression()
        self.expect_word("AS")
        variable = self.new_variable(visible(before), "BIND")
        self.expect(")")
        return Bind(variable, expression, self.span(start))

    def _union(self) -> Node:
        start = self.token.start
        groups = [self.group()]
        while self.accept_word("UNION"):
            groups.append(self.group())
        only = groups[0].nodes
        if len(groups) == len(only) == 1 and isinstance(only[0], SubSelect):
            return only[0]
        return Union(tuple(groups), self.span(start))


def _within(offset: int, node: Filter) -> bool:
    return any(exists.span.start <= offset < exists.span.end for exists in node.expression.exists)


def filter_of(node: Filter, outside: list[str]) -> Filter | Exists:
    """Return a filter as the EXISTS that it is, if it is nothing else; `outside` are its tokens around it."""
    if len(node.expression.exists) != 1 or not set(outside) <= {"(", ")", "!"}:
        return node
    (only,) = node.expression.exists
    return Exists(only.group, only.negated ^ (outside.count("!") % 2 == 1), asserted=False, span=node.span)
