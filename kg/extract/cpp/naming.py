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

    from kg.extract.cpp.evaluate import Evaluator
    from kg.extract.cpp.unit import Class

__all__ = ["given_name"]

_NAME_OF_INIT: Final = 2
"""`argc` and `argv` stand before the name."""


def given_name(evaluator: Evaluator, cls: Class | None) -> str | None:
    """Return the name that a program, or a node class `cls`, gives its node; None where it cannot be known."""
    for place in (*_initialised(evaluator), *_constructed(evaluator, cls)):
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


def _constructed(evaluator: Evaluator, cls: Class | None) -> Iterator[Expr]:
    live = (one for one in evaluator.program.live if evaluator.api.is_node(evaluator, one))
    for one in [cls] if cls is not None else live:
        for member in evaluator.program.family(one):
            for method in evaluator.program.methods(member):
                for entry in method.initialisers:
                    given = syntax.arguments(entry.named_children[-1])
                    if given and syntax.simple_name(entry.named_children[0]) in evaluator.api.handles:
                        yield Expr.of(method.unit, given[0])
