"""Constraints in SPARQL (SHACL, section 5): a node conforms when the SELECT has no solution for it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.rules.notations.shacl.paths import path_of
from kg.rules.notations.shacl.query import query_of, rename, variables
from kg.syntax.lexer import Kind

if TYPE_CHECKING:
    from kg.rules.form import Term
    from kg.rules.notations.shacl.functions import Functions
    from kg.rules.notations.shacl.graph import ShapesGraph
    from kg.rules.notations.shacl.paths import Names
    from kg.rules.notations.shacl.query import Words

__all__ = ["solution_of"]

_REFUSED: Final = frozenset({"SELECT", "COUNT", "SUM", "MIN", "MAX", "AVG", "GROUP_CONCAT", "SAMPLE"})


def solution_of(graph: ShapesGraph, functions: Functions, names: Names, shape: Term, node: Term) -> Words:
    """Return the group of the constraint `node` at a shape: `?this` is the focus node, other variables are new.

    Raises `RuleError` KG230 for queries with modifiers, aggregates or sub-SELECT.
    """
    query = query_of(graph, node, "select")
    texts = {word.text.upper() for word in [*query.head, *query.group] if word.kind is Kind.WORD}
    if query.modifiers or texts & _REFUSED:
        hint = "Write the query without sub-SELECT, aggregates, GROUP BY, ORDER BY and LIMIT."
        raise graph.unsupported("such a query of sh:sparql in a condition", node, hint)
    if "shapesGraph" in variables(query.group):
        raise graph.unsupported("$shapesGraph", node, "Write what the query needs of the shapes into it.")
    given = {name: names.fresh() for name in sorted(variables(query.group) - {"this"})} | {"currentShape": str(shape)}
    if "PATH" in given:
        path = path_of(graph, graph.required(shape, "path"), shape)
        if path.text is None or path.empty:
            raise graph.unsupported("$PATH for a path that may be empty", node, "Write the path into the query.")
        given["PATH"] = path.text
    return functions.inside(rename(query.group, given), node)
