"""The name that a node gives itself: `ros::init(argc, argv, "name")` or `Node("name")`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.cpp import syntax
from kg.extract.cpp.context import EMPTY
from kg.extract.cpp.sites import call_around
from kg.extract.cpp.unit import Expr
from kg.extract.values import Text

if TYPE_CHECKING:
    from collections.abc import Iterator

    from tree_sitter import Node

    from kg.extract.cpp.evaluate import Evaluator
    from kg.extract.cpp.unit import Class, Unit

__all__ = ["given_name"]

_NODES: Final = frozenset({"Node", "LifecycleNode"})
_NAME_OF_INIT: Final = 2
"""`argc` and `argv` stand before the name."""


def given_name(evaluator: Evaluator, cls: Class | None) -> str | None:
    """Return the name that a program, or a node class `cls`, gives its node; None where it cannot be known."""
    alone = _made(evaluator) if cls is None else ()
    for place in (*_initialised(evaluator), *_constructed(evaluator, cls), *alone):
        evaluator.restart()
        for value, _ in evaluator.texts(place, EMPTY):
            known = value.known if isinstance(value, Text) else None
            if known:
                return known
    return None


def _initialised(evaluator: Evaluator) -> Iterator[Expr]:
    for unit, node in evaluator.program.sites("init"):
        call = call_around(node)
        function = call.child_by_field_name("function") if call is not None else None
        called = syntax.callee(function) if function is not None else None
        if call is not None and called is not None and called.scope[-1:] == ("ros",):
            given = syntax.arguments(call.child_by_field_name("arguments"))
            if len(given) > _NAME_OF_INIT:
                yield Expr.of(unit, given[_NAME_OF_INIT])


def _made(evaluator: Evaluator) -> Iterator[Expr]:
    """Yield the names of nodes without a class of their own: `rclcpp::Node::make_shared("name")` and constructions."""
    for word in sorted(_NODES):
        for unit, node in evaluator.program.sites(word):
            sites = evaluator.sites.constructed_at(unit, node)
            yield from [site.arguments[0] for site in sites if site.arguments] or _make_shared(unit, node)


def _make_shared(unit: Unit, node: Node) -> list[Expr]:
    for outer in syntax.outward(node, 4):
        if outer.type == "call_expression":
            function = outer.child_by_field_name("function")
            called = syntax.callee(function) if function is not None else None
            given = syntax.arguments(outer.child_by_field_name("arguments"))
            if called is not None and called.name == "make_shared" and called.scope[-1:] == (syntax.text(node),):
                return [Expr.of(unit, argument) for argument in given[:1]]
            break
    return []


def _constructed(evaluator: Evaluator, cls: Class | None) -> Iterator[Expr]:
    live = (one for one in evaluator.program.live if evaluator.api.is_node(evaluator, one))
    for one in [cls] if cls is not None else live:
        for member in evaluator.program.family(one):
            for method in evaluator.program.methods(member):
                for entry in method.initialisers:
                    given = syntax.arguments(entry.named_children[-1])
                    if given and syntax.simple_name(entry.named_children[0]) in evaluator.api.handles:
                        yield Expr.of(method.unit, given[0])
