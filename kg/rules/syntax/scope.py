"""Which variables a pattern makes visible behind it (SPARQL 1.1, section 18.2.1)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.rules.form import Variable, variables_of
from kg.rules.syntax.tree import (
    Bind,
    Exists,
    Filter,
    GraphBlock,
    Optional,
    SubSelect,
    TriplePattern,
    Union,
    ValuesBlock,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.rules.syntax.tree import Node

__all__ = ["mentioned", "visible"]


def visible(nodes: Iterable[Node]) -> set[str]:
    """Return the names of the variables that may be bound behind `nodes`, those of blank nodes too."""
    return {name for node in nodes for name in _names(node)}


def mentioned(nodes: Iterable[Node]) -> set[str]:
    """Return the names of all variables in the triples, filters and assignments of `nodes`, those inside NOT too."""
    found = visible(nodes := list(nodes))
    for node in nodes:
        if isinstance(node, Exists):
            found |= mentioned(node.group.nodes)
        elif isinstance(node, Filter | Bind):
            found.update(node.expression.variables)
    return found


def _names(node: Node) -> Iterator[str]:
    if isinstance(node, TriplePattern):
        if isinstance(node.predicate, Variable):
            yield node.predicate.name
        for part in (node.subject, node.object):
            yield from (variable.name for variable in variables_of(part))
    elif isinstance(node, Optional | GraphBlock):
        if isinstance(node, GraphBlock) and isinstance(node.name, Variable):
            yield node.name.name
        yield from visible(node.group.nodes)
    elif isinstance(node, Union):
        for group in node.groups:
            yield from visible(group.nodes)
    elif isinstance(node, Bind):
        yield node.variable.name
    elif isinstance(node, ValuesBlock):
        yield from (variable.name for variable in node.variables)
    elif isinstance(node, SubSelect):
        yield from (projection.variable.name for projection in node.projections)
        if not node.projections:
            yield from visible(node.group.nodes)
