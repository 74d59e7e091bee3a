"""From the text of a file to rules: its queries are parsed and decomposed, their places put back into the file."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace
from typing import TYPE_CHECKING, Any

from kg.errors import Place, RuleError
from kg.rules.decompose import decompose
from kg.rules.notations.shacl.graph import ShapesGraph
from kg.rules.notations.shacl.statements import statements
from kg.syntax.parser import parse_rq
from kg.syntax.position import place_at

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from kg.rules.form import Rule
    from kg.rules.notations.shacl.statements import Statement


def rules(text: str, name: str, path: Path | str) -> tuple[Rule, ...]:
    """Return the rules of a shapes graph in Turtle, their parts numbered from one through the file.

    `name` is that of the rules, `path` the path in errors. Raises `RuleError`: KG201 for text that does not parse and
    shapes that are ill-formed, KG230 for features that are not supported, with the node and the way out.
    """
    graph = ShapesGraph(text, str(path))
    found: dict[tuple[object, ...], Rule] = {}
    for statement in statements(graph):
        for rule in _compiled(graph, statement, name):
            found.setdefault((rule.head, rule.body), rule)
    return tuple(replace(rule, part=part) for part, rule in enumerate(found.values(), 1))


def _compiled(graph: ShapesGraph, statement: Statement, name: str) -> tuple[Rule, ...]:
    """Return the rules of one query."""

    def moved(place: Place) -> Place:
        offset = _offset(statement.text, place)
        return place_at(graph.text, statement.source(offset), graph.path)

    try:
        unit = parse_rq(statement.text, graph.path)
        found = decompose(unit.rules[0], name, graph.path, statement.text)
    except RuleError as error:
        where = moved(error.place) if error.place else None
        fixes = [each for each in error.fixes if each.place is None]
        raise RuleError(error.code, error.message, place=where, hint=error.hint, fixes=fixes) from None
    return tuple(replace(_with_places(rule, moved), order=statement.order) for rule in found)


def _offset(text: str, place: Place) -> int:
    """Return the offset of a place in a text."""
    start = 0
    for _ in range((place.line or 1) - 1):
        start = text.find("\n", start) + 1
    return start + (place.column or 1) - 1


def _with_places(part: Any, moved: Callable[[Place], Place]) -> Any:
    """Return a part of the internal form with other places."""
    if isinstance(part, Place):
        return moved(part)
    if isinstance(part, tuple):
        return tuple(_with_places(one, moved) for one in part)
    if is_dataclass(part) and not isinstance(part, type):
        changed = {field.name: _with_places(getattr(part, field.name), moved) for field in fields(part)}
        return replace(part, **changed)
    return part
