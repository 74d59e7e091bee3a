"""Results of described framework calls: the column `returns`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.symbolic.durations import DURATION, construct_duration
from kg.symbolic.names import NODE_NAME, OWN_NAMESPACE, below, camera_info, namespace_of, own_namespace, resolved
from kg.symbolic.values import (
    Guard,
    Kind,
    Object,
    Sequence,
    Text,
    Truth,
    Unknown,
    Value,
    alternatives,
    concatenate,
    join,
    number,
)

if TYPE_CHECKING:
    from kg.symbolic.effects import Framework
    from kg.symbolic.state import Invocation

_DEPENDS: Final = Unknown("it depends on a parameter")
_FIXED: Final[dict[str, Value]] = {
    "node name": Text((NODE_NAME,)),
    "own namespace": Text((OWN_NAMESPACE,)),
    "own prefix": Text((OWN_NAMESPACE, "/")),
}


def result(framework: Framework, returns: str | None, call: Invocation, parameter: Value | None) -> Value:
    """Return the result of a call; `parameter` is the value of the parameter that it reads."""
    if returns is None:
        return Unknown("it is not known before the program runs")
    what, _, detail = returns.partition(":")
    values, node = call.arguments.values, call.node
    if what in _FIXED:
        return _FIXED[what]
    if what == "parameter":
        return parameter if parameter is not None else Unknown("the parameter is not known")
    if what == "is set":
        name: str | None = getattr(parameter, "parameter", None)
        return Guard((f"?{name}",)) if name is not None else _DEPENDS
    if what == "host":
        return framework.host_node()
    if what == "self":
        return node if node is not None else Unknown("it is not known")
    if what == "handle":
        return Object(Kind(("ros", "NodeHandle")), native={"namespace": Text.of(detail)})
    if what == "path":
        return concatenate(values[0], Text.of("/"), values[1])
    if what == "namespace":
        return own_namespace(node)
    if what == "duration":
        return construct_duration(DURATION, float(detail), values or [number(1)])
    if not detail.isdecimal():
        return Object(Kind(tuple(returns.split("::"))))
    if what == "format":
        return framework.machine.language.formatted(tuple(values[int(detail) :]))
    return _of_argument(framework, what, values[int(detail)], node)


def _of_argument(framework: Framework, what: str, argument: Value, node: Value | None) -> Value:
    if what == "is declared":
        return _is_declared(framework, argument, node)
    if what == "automatic":
        if isinstance(node, Object):
            node.native["automatic"] = argument
        return node if node is not None else Unknown("it is not known")
    if what == "listed":
        return _listed(argument)
    if what == "package":
        return concatenate(Text.of("package://"), argument)
    if what == "resolved":
        handles = alternatives(node) if node is not None else ()
        return join(*(resolved(one, argument) for one in handles or (None,)))
    if what == "private":
        return below(Text.of("~"), argument)
    if what == "sub node":
        native = {"namespace": below(namespace_of(node), argument)}
        return Object(Kind(("rclcpp", "Node")), native=native if node is None else {**native, "of": node})
    return camera_info(argument) if what == "camera info" else argument


def _listed(prefixes: Value) -> Value:
    """Return the names and prefixes of the parameters below some prefixes, each name with a hole."""
    if not isinstance(prefixes, Sequence) or not prefixes.items or prefixes.open:
        return _DEPENDS
    hole = Text.hole("launch files set the parameters below it")
    listed = Sequence(tuple(concatenate(one, Text.of("."), hole) for one in prefixes.items))
    return Object(Kind(("rcl_interfaces", "ListParametersResult")), fields={"names": listed, "prefixes": listed})


def _is_declared(framework: Framework, name: Value, node: Value | None) -> Value:
    """Return whether a parameter is declared; those of launch files can be, without code, if the node says so."""
    exact = name.exact if isinstance(name, Text) else None
    if exact is None:
        return _DEPENDS
    if framework.parameters.declares(node, exact):
        return Truth(True)
    automatic = node.native.get("automatic") if isinstance(node, Object) else None
    return Truth(False) if automatic in (None, Truth(False)) else _DEPENDS
