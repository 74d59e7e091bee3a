"""Interfaces whose name and type a class specifies: `static constexpr char name[]` beside `using Message = ...`.

That is how `autoware_component_interface_specs` writes down the interfaces between components.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.cpp import syntax
from kg.extract.cpp.context import EMPTY
from kg.extract.cpp.unit import Expr
from kg.extract.values import Number
from kg.facts import Qos

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.extract.cpp.evaluate import Evaluator
    from kg.extract.cpp.unit import Class
    from kg.extract.values import Text, Unknown

__all__ = ["specifications", "specified", "specified_qos"]

_NAME: Final = "name"
_POLICIES: Final = {"reliability": ("reliable", "best_effort"), "durability": ("volatile", "transient_local")}
_TYPES: Final = ("Message", "Service", "Action")


def specifications(evaluator: Evaluator, where: Expr, called: syntax.Callee, given: list[Expr]) -> Iterator[Class]:
    """Yield the classes that specify the interface of a call: its template argument, or that of its first argument."""
    kinds = [where.child(node) for node in syntax.arguments(called.template)[:1]]
    if not kinds and given:
        declared = evaluator.types.of(given[0], EMPTY)
        kinds = list(declared.arguments[:1]) if declared is not None else []
    for kind in kinds:
        for settled, _ in evaluator.types.settle(kind, EMPTY):
            cls = evaluator.types.class_of(settled)
            if cls is not None and _NAME in cls.fields:
                yield cls


def specified(evaluator: Evaluator, cls: Class) -> Iterator[tuple[Text | Unknown, str | None]]:
    """Yield the names that a specification gives, each with its type (`package/Type`)."""
    alias = next((found for word in _TYPES if (found := _own_alias(cls, word)) is not None), None)
    kinds = evaluator.types.message(alias, EMPTY) if alias is not None else [(None, EMPTY)]
    default = cls.fields[_NAME][1]
    for name, _ in evaluator.texts(Expr.of(cls.unit, default), EMPTY) if default is not None else ():
        yield name, kinds[0][0]


def specified_qos(evaluator: Evaluator, cls: Class) -> Qos | None:
    """Return the quality of service that a specification holds as `depth`, `reliability` and `durability`."""
    found = {word: cls.fields[word][1] for word in ("depth", *_POLICIES) if word in cls.fields}
    depth = found.get("depth")
    if depth is None:
        return None
    numbers = [value for value, _ in evaluator.values(Expr.of(cls.unit, depth), EMPTY) if isinstance(value, Number)]
    policies = {}
    for word, values in _POLICIES.items():
        node = found.get(word)
        written = syntax.text(node).lower() if node is not None else ""
        policies[word] = next((value for value in values if written.endswith(value)), None)
    return Qos(policies["reliability"], policies["durability"], "keep_last", int(numbers[0].value) if numbers else None)


def _own_alias(cls: Class, word: str) -> Expr | None:
    """Return the type that a class calls `word`."""
    inside = [node for node in cls.unit.aliases.get(word, ()) if cls.start <= node.start_byte < cls.end]
    return Expr.of(cls.unit, inside[0]) if inside else None
