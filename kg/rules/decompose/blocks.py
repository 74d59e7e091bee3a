"""Groups that stay SPARQL: conservative estimates of what they read and bind."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode

from kg.rules import sparql
from kg.rules.decompose.paths import normal
from kg.rules.decompose.renaming import certain, possible
from kg.rules.form import EngineBlock, Variable
from kg.syntax import tree
from kg.syntax.printer import path_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.errors import Place

_ANY: Final = None
"""Stands among predicates for all of them."""


def block(text: str, nodes: tuple[tree.Node, ...], place: Place | None = None) -> EngineBlock:
    """Return the block of a group; `text` is it without braces, its names IRIs in brackets."""
    always, ever = certain(nodes), possible(nodes)
    return EngineBlock(
        text.strip(),
        tuple(Variable(name) for name in sorted(ever)),
        tuple(Variable(name) for name in sorted(ever - always)),
        reads(nodes),
        monotone=is_monotone(nodes),
        place=place,
    )


def reads(nodes: Iterable[tree.Node]) -> frozenset[NamedNode] | None:
    """Return the predicates that nodes read, None where they may read any."""
    predicates = set(_read(nodes))
    return None if _ANY in predicates else frozenset(predicate for predicate in predicates if predicate is not None)


def _read(nodes: Iterable[tree.Node]) -> Iterator[NamedNode | None]:
    nodes = tuple(nodes)
    for node in nodes:
        if isinstance(node, tree.TriplePattern):
            yield from _path_reads(node.predicate)
            if normal(node.predicate).zero and not _is_anchored(node, nodes):
                # Of length zero it holds for all terms of the graph, whatever predicate they are with.
                yield _ANY
        inner = [exists.group for expression in tree.expressions_of(node) for exists in expression.exists]
        for group in (*tree.groups_of(node), *inner):
            yield from _read(group.nodes)


def _is_anchored(pattern: tree.TriplePattern, nodes: tuple[tree.Node, ...]) -> bool:
    """Return whether an end of a path is an end of a triple next to it that has its own predicate.

    A constant is not enough: the store's engine finds no path of length zero at a term that its graph does not have.
    """
    ends = {pattern.subject, pattern.object}
    triples = [n for n in nodes if isinstance(n, tree.TriplePattern) and isinstance(n.predicate, NamedNode)]
    anchors = {end for triple in triples for end in (triple.subject, triple.object)}
    return any(isinstance(end, Variable) for end in ends & anchors)


def _path_reads(path: tree.Path) -> Iterator[NamedNode | None]:
    if isinstance(path, NamedNode):
        yield path
    elif isinstance(path, tree.Sequence | tree.Alternative):
        for part in path.parts:
            yield from _path_reads(part)
    elif isinstance(path, tree.Inverse | tree.Repeat):
        yield from _path_reads(path.path)
    else:
        yield _ANY


def is_monotone(nodes: Iterable[tree.Node]) -> bool:
    """Return whether more triples never take a solution away; False when in doubt."""
    return all(map(_grows, nodes))


def _grows(node: tree.Node) -> bool:
    if isinstance(node, tree.Optional | tree.Minus):
        return False
    if isinstance(node, tree.Exists):
        return not node.negated and is_monotone(node.group.nodes)
    if isinstance(node, tree.Filter | tree.Bind):
        return not node.expression.exists
    if isinstance(node, tree.SubSelect):
        grouped = node.keys or node.having or any(c.expression and c.expression.aggregates for c in node.projections)
        plain = not any(c.expression and c.expression.exists for c in node.projections)
        return not node.sliced and not grouped and plain and is_monotone(node.group.nodes)
    if isinstance(node, tree.Union | tree.GraphBlock):
        return all(is_monotone(group.nodes) for group in tree.groups_of(node))
    return True


def pattern_text(pattern: tree.TriplePattern) -> str:
    """Return a triple pattern as SPARQL text."""
    return f"{sparql.term(pattern.subject)} {path_text(pattern.predicate, sparql.term)} {sparql.term(pattern.object)} ."
