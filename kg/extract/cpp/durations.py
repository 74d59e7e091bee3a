"""Durations of C++ in seconds: `100ms`, `std::chrono::seconds(1)`, `rclcpp::Duration::from_seconds(0.5)`, `rmw_time_t`.

Sources: rclcpp/duration.hpp (one number is nanoseconds, two are seconds and nanoseconds), rmw/time.h, rmw/types.h.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.cpp import syntax
from kg.extract.cpp.variables import WriteKind, writes
from kg.extract.values import Number

if TYPE_CHECKING:
    from tree_sitter import Node

    from kg.extract.cpp.context import Context
    from kg.extract.cpp.evaluate import Evaluator
    from kg.extract.cpp.unit import Expr

__all__ = ["INFINITE", "definition", "read_duration"]

INFINITE: Final = 9_223_372_036.0
"""Seconds from which on a duration stands for none: 64 bits of nanoseconds hold no more (RMW_DURATION_INFINITE)."""
_SUFFIXES: Final = {"h": 3600.0, "min": 60.0, "s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
_UNITS: Final = {
    "hours": 3600.0,
    "minutes": 60.0,
    "seconds": 1.0,
    "milliseconds": 1e-3,
    "microseconds": 1e-6,
    "nanoseconds": 1e-9,
    "from_seconds": 1.0,
    "from_nanoseconds": 1e-9,
}
_CONSTANTS: Final = {
    "RMW_DURATION_INFINITE": INFINITE,
    "RMW_DURATION_UNSPECIFIED": 0.0,
    "RMW_QOS_DEADLINE_DEFAULT": 0.0,
    "RMW_QOS_LIFESPAN_DEFAULT": 0.0,
    "RMW_QOS_LIVELINESS_LEASE_DURATION_DEFAULT": 0.0,
}
_SAME: Final = frozenset({"duration_cast", "from_rmw_time", "to_rmw_time", "to_chrono"})
_PAIRS: Final = frozenset({"Duration", "rmw_time_t", "rmw_time_s", "Time"})
_NAMES: Final = frozenset({"identifier", "field_identifier", "qualified_identifier", "field_expression"})
_DEEPEST: Final = 20


def read_duration(evaluator: Evaluator, where: Expr, context: Context, depth: int = 0) -> float | None:
    """Return the seconds that an expression stands for, `INFINITE` or more for without end; None when not known."""
    node = syntax.unwrap(where.node)
    where = where.child(node)
    if depth > _DEEPEST:
        return None
    if node.type in _NAMES:
        return _named(evaluator, where, context, depth)
    if node.type == "user_defined_literal":
        return _literal(evaluator, where, context)
    if node.type == "binary_expression":
        return _multiple(evaluator, where, context, depth)
    if node.type == "initializer_list":
        return _made(evaluator, "rmw_time_t", _given(where, node), context, depth)
    if node.type == "compound_literal_expression":
        kind, value = node.child_by_field_name("type"), node.child_by_field_name("value")
        return _made(evaluator, syntax.simple_name(kind) if kind else "", _given(where, value), context, depth)
    function = node.child_by_field_name("function") if node.type == "call_expression" else None
    called = syntax.callee(function) if function is not None else None
    if called is None:
        return None
    if called.receiver is not None and called.name in _SAME:
        return read_duration(evaluator, where.child(called.receiver), context, depth + 1)
    given = _given(where, node.child_by_field_name("arguments"))
    if (
        called.name == "duration"
        and called.template is not None
        and len(syntax.template_arguments(called.template)) > 1
    ):
        return None
    return _made(evaluator, called.name, given, context, depth)


def definition(evaluator: Evaluator, where: Expr, name: str) -> tuple[WriteKind, Expr, Node | None, int | None] | None:
    """Return what a name is first given where it is seen: how, the value, the declared type, and the value's end.

    The end is None where the value is not given in the same function.
    """
    function = where.unit.function_at(where.at)
    for write in writes(where.unit, name, function.start, where.at) if function is not None else ():
        if write.kind in (WriteKind.VALUE, WriteKind.CONSTRUCT) and write.owner is None:
            return write.kind, write.value, write.type, write.end
    declared = evaluator.types.declaration(name, where)
    if declared is None or declared[1] is None:
        return None
    kind = WriteKind.CONSTRUCT if declared[1].node.type == "initializer_list" else WriteKind.VALUE
    return kind, declared[1], declared[0].node, None


def _given(where: Expr, listed: Node | None) -> list[Expr]:
    return [where.child(node) for node in syntax.arguments(listed)]


def _number(evaluator: Evaluator, where: Expr, context: Context) -> float | None:
    numbers = {value.value for value, _ in evaluator.values(where, context) if isinstance(value, Number)}
    return numbers.pop() if len(numbers) == 1 else None


def _literal(evaluator: Evaluator, where: Expr, context: Context) -> float | None:
    number, suffix = where.node.named_children[0], syntax.text(where.node.named_children[-1])
    value = _number(evaluator, where.child(number), context)
    return None if value is None or suffix not in _SUFFIXES else value * _SUFFIXES[suffix]


def _multiple(evaluator: Evaluator, where: Expr, context: Context, depth: int) -> float | None:
    """Return the value of `2 * 100ms` or `100ms * 2`."""
    operator = where.node.child_by_field_name("operator")
    sides = [where.node.child_by_field_name(side) for side in ("left", "right")]
    if operator is None or syntax.text(operator) != "*":
        return None
    parts = [where.child(side) for side in sides if side is not None]
    for times, lasting in (parts, parts[::-1]):
        factor, seconds = _number(evaluator, times, context), read_duration(evaluator, lasting, context, depth + 1)
        if factor is not None and seconds is not None:
            return factor * seconds
    return None


def _made(evaluator: Evaluator, name: str, given: list[Expr], context: Context, depth: int) -> float | None:
    """Return the duration that `name(given)` makes."""
    if name == "max" and not given:
        return INFINITE
    if not given:
        return 0.0 if name == "rmw_time_t" else None
    numbers = [_number(evaluator, one, context) for one in given]
    first = numbers[0]
    if name in _PAIRS and len(numbers) > 1:
        return None if first is None or numbers[1] is None else first + numbers[1] * 1e-9
    if first is None:
        return read_duration(evaluator, given[0], context, depth + 1)
    if name in _PAIRS:
        return first * 1e-9
    return first if name == "duration" else first * _UNITS[name] if name in _UNITS else None


def _named(evaluator: Evaluator, where: Expr, context: Context, depth: int) -> float | None:
    field = where.node.child_by_field_name("field")
    name = syntax.text(field) if field is not None else syntax.simple_name(where.node)
    if name in _CONSTANTS:
        return _CONSTANTS[name]
    found = definition(evaluator, where, name)
    if found is None:
        return None
    kind, value, declared, _ = found
    if kind is WriteKind.VALUE and value.node.type != "initializer_list":
        return read_duration(evaluator, value, context, depth + 1)
    node = value.node
    given = value.unit.reparse(node) if node.type == "parameter_list" else syntax.arguments(node)
    name = syntax.simple_name(declared) if declared is not None else ""
    return _made(evaluator, name, [value.child(one) for one in given], context, depth)
