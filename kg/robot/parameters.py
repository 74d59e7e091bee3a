"""Reading and setting the parameters of running nodes.

In ROS 2 each node has its own, with services to list, describe and set them (rcl_interfaces). In ROS 1 all are on the
master, those of a node below its name. A value is a text as in a parameter file: `0.5`, `[1, 2]`, `true`.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from typing import Any, Final, Protocol, TypeGuard

import msgspec
from yaml import BaseLoader, YAMLError

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.connecting import is_recording, of_robot
from kg.robot.connection import Connection, GraphProblem, Value
from kg.similar import did_you_mean
from kg.yamltext import load_yaml

_LIST: Final = "rcl_interfaces/ListParameters"
_LISTING: Final = "/list_parameters"
_PATIENCE: Final = 5.0  # seconds to wait for an answer of a node
_UNSET: Final = "not set"
_TYPES: Final[tuple[tuple[str, str], ...]] = (
    (_UNSET, ""),
    ("boolean", "bool_value"),
    ("integer", "integer_value"),
    ("double", "double_value"),
    ("string", "string_value"),
    ("byte array", "byte_array_value"),
    ("boolean array", "bool_array_value"),
    ("integer array", "integer_array_value"),
    ("double array", "double_array_value"),
    ("string array", "string_array_value"),
)
"""The types of rcl_interfaces/ParameterType by their numbers, under the names of `ros2 param`, with their fields."""
_NUMBERS: Final = {name: number for number, (name, _) in enumerate(_TYPES)}
_TRUTH: Final = {"true": True, "false": False}
_OF_PYTHON: Final[Mapping[type, str]] = {bool: "boolean", int: "integer", float: "double", str: "string"}


class NodeParameter(msgspec.Struct, frozen=True, kw_only=True):
    """A parameter of a running node, with its description.

    `type` is a name of `ros2 param describe`, or in ROS 1 also `list` or `mapping`. `minimum`, `maximum` and `step`
    limit numbers; `constraints` are others, in words. `dynamic` parameters accept values of any type.
    """

    node: str
    name: str
    type: str
    value: Any = None
    description: str = ""
    constraints: str = ""
    read_only: bool = False
    dynamic: bool = False
    minimum: float | None = None
    maximum: float | None = None
    step: float | None = None


class _Server(Protocol):
    """A connection to a system with one parameter server: that of ROS 1."""

    async def parameter_names(self) -> list[str]:
        """Return the names of all parameters."""

    async def parameter(self, name: str) -> Any:
        """Return a parameter, None if it is not set."""

    async def set_parameter(self, name: str, value: Any) -> None:
        """Set a parameter."""


async def read(connection: Connection, node: str | None = None) -> tuple[list[NodeParameter], list[GraphProblem]]:
    """Return the parameters of a robot or one of its nodes, and the problems of nodes that did not answer.

    In ROS 1 the node may be any namespace.

    Raises:
        RobotError: KG843 an unknown node, KG851 a recording, KG852 ROS 1 over a bridge, and those of a call if only one
            node is read.
    """
    if is_recording(connection.address):
        raise RobotError("KG851", f"{connection.address} is a recording, which has no parameters")
    parameters, problems = await (_read_server if _is_server(connection) else _read_nodes)(connection, node)
    if node is not None and problems:
        raise RobotError(problems[0].code, f"{problems[0].subject}: {problems[0].message}")
    return parameters, problems


async def find(connection: Connection, node: str, name: str, *, new: bool = False) -> NodeParameter:
    """Return one parameter of a node; raises as `read`.

    In ROS 1, a `new` one, which is to be set, need not exist, since any node may add parameters.
    """
    parameters, _ = await read(connection, None if new and _is_server(connection) else node)
    by_name = {_joined(one.node, one.name): one for one in parameters}
    whole = _joined(f"/{node.strip('/')}", name)
    if whole in by_name:
        return by_name[whole]
    if new and _is_server(connection):
        return NodeParameter(node=f"/{node.strip('/')}", name=name, type=_UNSET)
    hint = did_you_mean(name, {one.name for one in parameters})
    raise RobotError("KG843", f"{node} has no parameter `{name}`", hint=hint)


async def write(connection: Connection, parameter: NodeParameter, value: Any) -> NodeParameter:
    """Set a parameter to a value returned by `parsed`, and return the parameter as the node then reports it.

    Raises:
        RobotError: KG843 with the node's reason if it refuses the value, and those of a call.
    """
    if _is_server(connection):
        await connection.set_parameter(_joined(parameter.node, parameter.name), value)
        return msgspec.structs.replace(parameter, value=value)
    kind = _kind_of(value) if parameter.dynamic or parameter.type == _UNSET else parameter.type
    number = _NUMBERS[kind]
    request = {"name": parameter.name, "value": {"type": number, _TYPES[number][1]: value}}
    answer = await _ask(connection, parameter.node, "SetParameters", {"parameters": [request]})
    for result in answer["results"]:
        if not result["successful"]:
            reason = result["reason"] or "it gives no reason"
            raise RobotError("KG843", f"{parameter.node} refuses {value!r} for `{parameter.name}`: {reason}")
    (after,) = await _values(connection, parameter.node, [parameter.name])
    return msgspec.structs.replace(parameter, type=kind, value=after[1])


def parsed(parameter: NodeParameter, text: str) -> Any:
    """Return the value in a text.

    Raises:
        RobotError: KG843 another type than the node describes, outside of its limits (it is never clamped), or the
            parameter is read-only.
    """
    if parameter.read_only:
        raise _refused(parameter, "it is read-only", "Start the node with another value.")
    if parameter.dynamic or parameter.type not in _PARSERS:
        return _guessed(parameter, text)
    value = _PARSERS[parameter.type](parameter, text)
    if parameter.type in {"integer", "double"}:
        if parameter.minimum is not None and not value >= parameter.minimum:
            raise _refused(parameter, f"{text} is below its minimum, {parameter.minimum:g}")
        if parameter.maximum is not None and not value <= parameter.maximum:
            raise _refused(parameter, f"{text} is above its maximum, {parameter.maximum:g}")
    return value


def _refused(parameter: NodeParameter, why: str, hint: str | None = None) -> RobotError:
    return RobotError("KG843", f"`{parameter.name}` of {parameter.node} cannot be set: {why}", hint=hint)


def _is_server(connection: Any) -> TypeGuard[_Server]:
    return hasattr(connection, "parameter_names")


def _joined(node: str, name: str) -> str:
    return f"{node.rstrip('/')}/{name}"


async def _read_server(connection: Any, node: str | None) -> tuple[list[NodeParameter], list[GraphProblem]]:
    names = sorted(await connection.parameter_names())
    nodes = sorted((one.name for one in (await connection.graph()).nodes), key=len, reverse=True)
    if node is None:
        owners = {name: next((one for one in nodes if name.startswith(f"{one}/")), "/") for name in names}
    else:
        space = f"/{node.strip('/')}"
        owners = {name: space for name in names if name.startswith(f"{space.rstrip('/')}/")}
        if not owners and space not in nodes:
            spaces = {*nodes, *(name.rpartition("/")[0] for name in names)}
            hint = did_you_mean(space, spaces) or "`kg robot nodes` lists the nodes, `kg robot params` all parameters."
            raise RobotError("KG843", f"no node and no parameter is called `{space}`", hint=hint)
    values = await asyncio.gather(*(connection.parameter(name) for name in owners))
    parameters = [
        NodeParameter(node=owner, name=name[len(owner.rstrip("/")) + 1 :], type=_kind_of(value), value=value)
        for (name, owner), value in zip(owners.items(), values, strict=True)
    ]
    return sorted(parameters, key=lambda one: (one.node, one.name)), []


def _kind_of(value: Any) -> str:
    if isinstance(value, list):
        kinds = {type(one) for one in value}
        return f"{_OF_PYTHON[kinds.pop()]} array" if len(kinds) == 1 and kinds <= _OF_PYTHON.keys() else "list"
    if isinstance(value, dict):
        return "mapping"
    return _UNSET if value is None else _OF_PYTHON.get(type(value), type(value).__name__)


async def _read_nodes(connection: Connection, node: str | None) -> tuple[list[NodeParameter], list[GraphProblem]]:
    if connection.ros == 1:
        raise RobotError("KG852", f"{connection.address} is a bridge, over which kg reads no parameters of ROS 1")
    graph = of_robot(await connection.graph())
    services = {end.name for end in graph.ends if end.role is Role.SERVICES and end.type == _LIST}
    # A bridge may not report nodes, so they are found by their services.
    nodes = {name.removesuffix(_LISTING) for name in services if name.endswith(_LISTING)}
    if node is not None:
        called = f"/{node.strip('/')}"
        if called not in nodes:
            hint = did_you_mean(called, nodes) or "`kg robot nodes` lists the nodes."
            raise RobotError("KG843", f"no node `{called}` offers parameters", hint=hint)
        nodes = {called}
    replies = await asyncio.gather(*(_of_node(connection, one) for one in sorted(nodes)))
    return [one for parameters, _ in replies for one in parameters], [one for _, problem in replies for one in problem]


async def _of_node(connection: Connection, node: str) -> tuple[list[NodeParameter], list[GraphProblem]]:
    try:
        names = sorted((await _ask(connection, node, "ListParameters", {}))["result"]["names"])
        values = await _values(connection, node, names)
        described = await _ask(connection, node, "DescribeParameters", {"names": names})
    except RobotError as error:
        return [], [GraphProblem(error.code, node, error.message)]
    descriptors = {one["name"]: one for one in described["descriptors"]}
    return [
        _parameter(node, name, kind, value, descriptors.get(name, {}))
        for name, (kind, value) in zip(names, values, strict=True)
    ], []


def _parameter(node: str, name: str, kind: str, value: Any, descriptor: Mapping[str, Any]) -> NodeParameter:
    (limits,) = [*descriptor.get("floating_point_range", ()), *descriptor.get("integer_range", ())][:1] or [None]
    return NodeParameter(
        node=node,
        name=name,
        type=kind if kind != _UNSET else _type_of(descriptor.get("type", 0)),
        value=value,
        description=descriptor.get("description", ""),
        constraints=descriptor.get("additional_constraints", ""),
        read_only=descriptor.get("read_only", False),
        dynamic=descriptor.get("dynamic_typing", False),
        minimum=limits and limits["from_value"],
        maximum=limits and limits["to_value"],
        step=limits and (limits["step"] or None),
    )


async def _values(connection: Connection, node: str, names: list[str]) -> list[tuple[str, Any]]:
    """Return types and values, one request each: a node with an unset parameter may omit all values."""
    replies = (await _ask(connection, node, "GetParameters", {"names": names}))["values"]
    if len(replies) != len(names):
        each = await asyncio.gather(*(_ask(connection, node, "GetParameters", {"names": [name]}) for name in names))
        replies = [one["values"][0] if one["values"] else {"type": 0} for one in each]
    values: list[tuple[str, Any]] = []
    for one in replies:
        kind = _type_of(one["type"])
        value = one[_TYPES[_NUMBERS[kind]][1]] if kind != _UNSET else None
        values.append((kind, list(value) if isinstance(value, bytes) else value))
    return values


def _type_of(number: int) -> str:
    return _TYPES[number][0] if number < len(_TYPES) else _UNSET


async def _ask(connection: Connection, node: str, kind: str, request: Value) -> Value:
    """Call a service of a node: `ListParameters` is `~/list_parameters`."""
    service = "".join(f"_{sign.lower()}" if sign.isupper() else sign for sign in kind).strip("_")
    return await connection.call(f"{node}/{service}", f"rcl_interfaces/{kind}", request, seconds=_PATIENCE)


def _boolean(parameter: NodeParameter, text: str) -> bool:
    if text.lower() not in _TRUTH:
        raise _refused(parameter, f"`{text}` is neither true nor false")
    return _TRUTH[text.lower()]


def _integer(parameter: NodeParameter, text: str) -> int:
    try:
        return int(text, 0)
    except ValueError:
        raise _refused(parameter, f"`{text}` is not a whole number") from None


def _double(parameter: NodeParameter, text: str) -> float:
    try:
        return float(text.replace(".inf", "inf").replace(".nan", "nan"))
    except ValueError:
        raise _refused(parameter, f"`{text}` is not a number") from None


def _byte(parameter: NodeParameter, text: str) -> int:
    value = _integer(parameter, text)
    if value not in range(256):
        raise _refused(parameter, f"`{text}` is not a byte: 0 to 255")
    return value


def _elements(parameter: NodeParameter, text: str) -> list[str]:
    try:
        elements = load_yaml(text, BaseLoader)
    except YAMLError:
        elements = None
    if not isinstance(elements, list) or not all(isinstance(one, str) for one in elements):
        raise _refused(parameter, f"`{text}` is not a list; write [1, 2]")
    return elements


def _guessed(parameter: NodeParameter, text: str) -> Any:
    try:
        value = load_yaml(text)
    except YAMLError:
        value = text
    kind = _kind_of(value)
    if kind == _UNSET or (kind not in _NUMBERS and kind != parameter.type):
        raise _refused(parameter, f"`{text}` is not a value of a parameter")
    return value


def _array(of: Callable[[NodeParameter, str], Any]) -> Callable[[NodeParameter, str], list[Any]]:
    return lambda parameter, text: [of(parameter, one) for one in _elements(parameter, text)]


_PARSERS: Final[Mapping[str, Callable[[NodeParameter, str], Any]]] = {
    "boolean": _boolean,
    "integer": _integer,
    "double": _double,
    "string": lambda _, text: text,
    "byte array": _array(_byte),
    "boolean array": _array(_boolean),
    "integer array": _array(_integer),
    "double array": _array(_double),
    "string array": _array(lambda _, text: text),
}
