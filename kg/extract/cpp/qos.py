"""Quality of service of one end of a ROS 2 interface, as the code builds it.

A profile starts from a number, a named profile or `QoS(...)`, and methods change it: in a chain
(`QoS(1).transient_local()`) or one after the other on a variable. Sources: rclcpp/qos.hpp, rmw/qos_profiles.h.
"""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Final

from kg.extract.cpp import syntax
from kg.extract.cpp.durations import INFINITE, definition, read_duration
from kg.extract.cpp.unit import Expr
from kg.extract.cpp.variables import WriteKind
from kg.extract.values import Number
from kg.facts import Qos

if TYPE_CHECKING:
    from collections.abc import Callable

    from tree_sitter import Node

    from kg.extract.cpp.context import Context
    from kg.extract.cpp.evaluate import Evaluator

__all__ = ["read_qos"]

_DEFAULT: Final = Qos("reliable", "volatile", "keep_last", 10)
_SENSOR: Final = Qos("best_effort", "volatile", "keep_last", 5)
_PARAMETERS: Final = Qos("reliable", "volatile", "keep_last", 1000)
_PROFILES: Final = {
    "SensorDataQoS": _SENSOR,
    "rmw_qos_profile_sensor_data": _SENSOR,
    "qos_profile_sensor_data": _SENSOR,
    "ClockQoS": Qos("best_effort", "volatile", "keep_last", 1),
    "ParametersQoS": _PARAMETERS,
    "rmw_qos_profile_parameters": _PARAMETERS,
    "ServicesQoS": _DEFAULT,
    "rmw_qos_profile_services_default": _DEFAULT,
    "rmw_qos_profile_default": _DEFAULT,
    "ParameterEventsQoS": _PARAMETERS,
    "RosoutQoS": Qos("reliable", "transient_local", "keep_last", 1000),
    "DynamicBroadcasterQoS": Qos("reliable", "volatile", "keep_last", 100),
    "DynamicListenerQoS": Qos("reliable", "volatile", "keep_last", 100),
    "StaticBroadcasterQoS": Qos("reliable", "transient_local", "keep_last", 1),
    "StaticListenerQoS": Qos("reliable", "transient_local", "keep_last", 100),
    "SystemDefaultsQoS": Qos(),
    "BestAvailableQoS": Qos(),
    "rmw_qos_profile_system_default": Qos(),
}
_SETTERS: Final[dict[str, Callable[[Qos], Qos]]] = {
    "reliable": lambda qos: replace(qos, reliability="reliable"),
    "best_effort": lambda qos: replace(qos, reliability="best_effort"),
    "reliability_best_available": lambda qos: replace(qos, reliability=None),
    "durability_volatile": lambda qos: replace(qos, durability="volatile"),
    "transient_local": lambda qos: replace(qos, durability="transient_local"),
    "keep_all": lambda qos: replace(qos, history="keep_all", depth=None),
}
_POLICIES: Final = {
    "reliability": {"reliable", "best_effort"},
    "durability": {"volatile", "transient_local"},
    "liveliness": {"automatic", "manual_by_topic"},
    "history": {"keep_last", "keep_all"},
}
_DURATIONS: Final = {
    "deadline": "deadline",
    "lifespan": "lifespan",
    "liveliness_lease_duration": "lease_duration",
}
"""Methods of rclcpp::QoS and fields of rmw_qos_profile_t that take a duration, with the fields of `Qos`."""
_SAME: Final = frozenset({"get_rmw_qos_profile", "from_rmw", "from_qos", "QoS"})
_IGNORED: Final = frozenset({"avoid_ros_namespace_conventions"})
_MAKING: Final = frozenset({"QoS", "KeepLast", "QoSInitialization"})
_DEEPEST: Final = 20


def read_qos(evaluator: Evaluator, where: Expr, context: Context, depth: int = 0) -> Qos | None:
    """Return the quality of service that an argument stands for; None where nothing of it is known."""
    node = syntax.unwrap(where.node)
    where = where.child(node)
    if depth > _DEEPEST:
        return None
    if node.type == "number_literal":
        return _with_depth(evaluator, where, context)
    if node.type in ("identifier", "field_identifier", "qualified_identifier", "field_expression"):
        return _named(evaluator, where, context, depth)
    if node.type == "compound_literal_expression":
        kind, value = node.child_by_field_name("type"), node.child_by_field_name("value")
        return _made(
            evaluator, where, syntax.simple_name(kind) if kind else "", syntax.arguments(value), context, depth
        )
    if node.type == "call_expression":
        return _called(evaluator, where, context, depth)
    return None


def _with_depth(evaluator: Evaluator, where: Expr, context: Context) -> Qos | None:
    """Return the default profile with the depth that an expression is."""
    numbers = {value.value for value, _ in evaluator.values(where, context) if isinstance(value, Number)}
    return replace(_DEFAULT, depth=int(numbers.pop())) if len(numbers) == 1 else None


def _called(evaluator: Evaluator, where: Expr, context: Context, depth: int) -> Qos | None:
    function = where.node.child_by_field_name("function")
    called = syntax.callee(function) if function is not None else None
    if called is None:
        return None
    given = syntax.arguments(where.node.child_by_field_name("arguments"))
    if called.receiver is None:
        return _made(evaluator, where, called.name, given, context, depth)
    before = read_qos(evaluator, where.child(called.receiver), context, depth + 1)
    return before and _changed(evaluator, before, called.name, [where.child(node) for node in given], context)


def _made(  # noqa: PLR0913, PLR0917 - the parts of one construction
    evaluator: Evaluator, where: Expr, name: str, given: list[Node], context: Context, depth: int
) -> Qos | None:
    """Return the profile that `name(given)` makes."""
    if name in _PROFILES:
        return _PROFILES[name]
    if name == "KeepAll":
        return replace(_DEFAULT, history="keep_all", depth=None)
    if (name in _MAKING or name in _SAME) and given:
        last = where.child(given[-1])
        first = where.child(given[0])
        return read_qos(evaluator, last, context, depth + 1) or _with_depth(evaluator, first, context)
    return None


def _changed(evaluator: Evaluator, qos: Qos, name: str, given: list[Expr], context: Context) -> Qos | None:
    """Return a profile after one of its methods was called; None for methods that make something else of it."""
    if name in _SETTERS:
        return _SETTERS[name](qos)
    if name == "keep_last" and given:
        counted = _with_depth(evaluator, given[0], context)
        return replace(qos, history="keep_last", depth=counted.depth if counted is not None else None)
    if name in _DURATIONS and given:
        return _lasting(qos, name, read_duration(evaluator, given[-1], context), len(given))
    if name in _POLICIES and given:
        return _with_policy(qos, name, given[0])
    return qos if name in _SAME or name in _IGNORED else None


def _with_policy(qos: Qos, name: str, chosen: Expr) -> Qos:
    """Return a profile with a policy that is named by an enumerator; None of it where that is none of those known."""
    word = syntax.text(chosen.node).rpartition("::")[2].lower().replace("_", "")
    value = next((policy for policy in _POLICIES[name] if word.endswith(policy.replace("_", ""))), None)
    return Qos(**{**asdict(qos), name: value})


def _lasting(qos: Qos, name: str, seconds: float | None, given: int) -> Qos | None:
    """Return a profile with a duration; None when that is not known, since no deadline would mean something else.

    Zero stands for the default, which is none (RMW_DURATION_UNSPECIFIED in rmw/types.h).
    """
    if seconds is None or given > 1:
        return None
    return Qos(**{**asdict(qos), _DURATIONS[name]: seconds if 0 < seconds < INFINITE else None})


def _named(evaluator: Evaluator, where: Expr, context: Context, depth: int) -> Qos | None:
    """Return a profile with a name: one of rmw's, a variable with what its methods made of it, or a number."""
    field = where.node.child_by_field_name("field")
    name = syntax.text(field) if field is not None else syntax.simple_name(where.node)
    if name in _PROFILES:
        return _PROFILES[name]
    found = definition(evaluator, where, name)
    if found is not None:
        kind, value, declared, end = found
        start = _written(evaluator, value, kind, declared, context, depth)
        return _after(evaluator, start, name, (end, where), context) if start and end is not None else start
    return _with_depth(evaluator, where, context)


def _written(  # noqa: PLR0913, PLR0917 - the parts of one declaration
    evaluator: Evaluator, value: Expr, kind: WriteKind, declared: Node | None, context: Context, depth: int
) -> Qos | None:
    """Return the profile that a variable is given; one of another type is the number of a depth."""
    if kind is WriteKind.VALUE:
        return read_qos(evaluator, value, context, depth + 1)
    node = value.node
    given = value.unit.reparse(node) if node.type == "parameter_list" else syntax.arguments(node)
    name = syntax.simple_name(declared) if declared is not None else "QoS"
    return _made(evaluator, value, name, given, context, depth)


def _after(evaluator: Evaluator, qos: Qos, name: str, span: tuple[int, Expr], context: Context) -> Qos | None:
    """Return a variable's profile after the methods called on it within a span."""
    start, where = span
    result: Qos | None = qos
    for use in where.unit.occurrences(name):
        if start <= use.start_byte < where.at:
            result = result and _chained(evaluator, result, use, where, context)
            result = result and _assigned(evaluator, result, use, where, context)
    return result


def _assigned(evaluator: Evaluator, qos: Qos, use: Node, where: Expr, context: Context) -> Qos | None:
    """Return a profile of rmw after a field of it was assigned, `profile.depth = 5` or `profile.deadline.sec = 1`."""
    path: list[str] = []
    inner = use
    for outer in syntax.outward(use, 3):
        field, right = outer.child_by_field_name("field"), outer.child_by_field_name("right")
        left = outer.child_by_field_name("left")
        if outer.type == "field_expression" and field is not None:
            path.append(syntax.text(field))
        elif outer.type == "assignment_expression" and left is not None and left.id == inner.id and right is not None:
            return _with_field(evaluator, qos, path, Expr.of(where.unit, right), context)
        inner = outer
    return qos


def _with_field(evaluator: Evaluator, qos: Qos, path: list[str], value: Expr, context: Context) -> Qos | None:
    match path:
        case ["depth"]:
            counted = _with_depth(evaluator, value, context)
            return replace(qos, depth=counted.depth if counted is not None else None)
        case [name] if name in _POLICIES:
            return _with_policy(qos, name, value)
        case [name] if name in _DURATIONS:
            return _lasting(qos, name, read_duration(evaluator, value, context), 1)
        case [name, "sec" | "nsec" as unit] if name in _DURATIONS:
            counted = _with_depth(evaluator, value, context)
            before: float = getattr(qos, _DURATIONS[name]) or 0.0
            scale = 1.0 if unit == "sec" else 1e-9
            return counted and _lasting(qos, name, before + (counted.depth or 0) * scale, 1)
        case _:
            return qos


def _chained(evaluator: Evaluator, qos: Qos, use: Node, where: Expr, context: Context) -> Qos | None:
    """Return a profile after the chain of methods called on a use of its variable, `q.reliable().keep_all()`."""
    result: Qos | None = qos
    inner = use
    for _ in range(_DEEPEST):
        access = inner.parent
        call = access.parent if access is not None and access.type == "field_expression" else None
        called = syntax.callee(access) if access is not None and call is not None else None
        if call is None or called is None or call.type != "call_expression" or called.receiver is None:
            break
        if called.receiver.id != inner.id:
            break
        given = [Expr.of(where.unit, node) for node in syntax.arguments(call.child_by_field_name("arguments"))]
        result = result and (_changed(evaluator, result, called.name, given, context) or result)
        inner = call
    return result
