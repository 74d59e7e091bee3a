"""Message types between ROS 2 peers: their hashes, and the descriptions that nodes provide.

A hash (RIHS01) is the SHA-256 of a type's description (REP 2016). A service's description, with request, response and
event, is derived here, since no file has it. Nodes of Jazzy and later provide descriptions of their types by hash
(`~/get_type_description`, type_description_interfaces). In the numbers of field types, `FIELD_TYPE_INT8` = 2 is a
single value; add 48 for an array, 96 for a bounded list, 144 for a list.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.messages.types import learn_all, short
from kg.robot.messages.values import MEMBER_OF_NOTHING
from kg.robot.ros2.names import family, full_type

if TYPE_CHECKING:
    from kg.robot.connection import ComputationGraph, Value
    from kg.robot.messages import Field, Types
    from kg.robot.ros2.connection import Ros2Connection

_EVENT: Final = "service_msgs/ServiceEventInfo"
_DUMMY: Final = (MEMBER_OF_NOTHING, (Nodetype.BASE, ("uint8", 0)))


def type_hash(types: Types, kind: str, *, service: bool = False) -> str:
    """Return `RIHS01_` and 64 digits for a message or a service; RobotError KG804 if a nested type is unknown."""
    store = get_typestore(Stores.EMPTY)
    described: dict[str, Any] = {}
    if service:
        _describe_service(types, kind, described)
    else:
        _describe(types, kind, described)
    store.fielddefs = described
    return store.hash_rihs01(full_type(kind, service=service))


def _describe(types: Types, kind: str, described: dict[str, Any]) -> None:
    if full_type(kind) in described:
        return
    fields = types.fields(kind)
    described[full_type(kind)] = ([], [(one.name, _description(one)) for one in fields] or [_DUMMY])
    for one in fields:
        if one.is_message:
            _describe(types, one.type, described)


def _description(field: Field) -> Any:
    sort = Nodetype.NAME if field.is_message else Nodetype.BASE
    base = "uint8" if field.type == "char" else field.type  # rosidl converts it to `uint8`
    element = (sort, full_type(field.type) if field.is_message else (base, field.bound))
    if field.length is None:
        return element
    return (Nodetype.ARRAY, (element, field.length)) if field.length else (Nodetype.SEQUENCE, (element, field.most))


def _describe_service(types: Types, kind: str, described: dict[str, Any]) -> None:
    parts = [(name, f"{kind}_{name.capitalize()}") for name in ("request", "response")]
    for one in (*(part for _, part in parts), _EVENT):
        _describe(types, one, described)
    event: list[Any] = [("info", (Nodetype.NAME, full_type(_EVENT)))]
    event += [(name, (Nodetype.SEQUENCE, ((Nodetype.NAME, full_type(part)), 1))) for name, part in parts]
    described[full_type(f"{kind}_Event")] = ([], event)
    whole: list[Any] = [(f"{name}_message", (Nodetype.NAME, full_type(part))) for name, part in parts]
    whole.append(("event_message", (Nodetype.NAME, full_type(f"{kind}_Event"))))
    described[full_type(kind, service=True)] = ([], whole)


_SERVICE: Final = "type_description_interfaces/GetTypeDescription"
_PATIENCE: Final = 2.0  # seconds for a node to describe a type
_NESTED, _STRING, _BOUNDED_STRING = 1, 17, 21
_BASE: Final = {
    2: "int8",
    3: "uint8",
    4: "int16",
    5: "uint16",
    6: "int32",
    7: "uint32",
    8: "int64",
    9: "uint64",
    10: "float32",
    11: "float64",
    13: "uint8",
    15: "bool",
    16: "byte",
    _STRING: "string",
}
"""Names of types in `.msg` files; `wchar`, `wstring`, `long double` and fixed-length strings are not supported."""
_WHOLE: Final = ("_Event", "_SendGoal", "_GetResult")
_GROUP: Final = 48
_ONE, _ARRAY, _LIMITED = range(3)


async def describe(connection: Ros2Connection, kind: str, name: str) -> str | None:
    """Request the type of a topic, service or action from its nodes, and learn it with its nested types.

    Returns:
        None on success, else the reason; empty if there is no node to ask.
    """

    def describing(graph: ComputationGraph) -> list[tuple[str, str]]:
        able = {end.node for end in graph.ends if end.role is Role.SERVICES and end.type == _SERVICE}
        return sorted({(node, digest) for node, digest in connection.wire.hashes(name) if node in able})

    await connection.watch.until(lambda graph: bool(describing(graph)) or graph.complete)
    why = ""
    for node, digest in describing(connection.watch.now()):
        request = {"type_name": full_type(kind), "type_hash": digest}
        try:
            answer = await connection.call(f"{node}/get_type_description", _SERVICE, request, seconds=_PATIENCE)
            if answer["successful"]:
                learn_all(connection.types, texts(answer["type_description"]))
                return None
            why = f"`{node}` does not describe it: {answer['failure_reason'][:200]}"
        except RobotError as error:
            why = f"`{node}` does not describe it: {error.message}"
    return why


def texts(description: Value) -> dict[str, str]:
    """Return the definitions of messages in a TypeDescription, in `.msg` form, by `package/Type`.

    The descriptions of a whole service or action, and of events, are left out. RobotError KG804 for a field of an
    unsupported type.
    """
    definitions: dict[str, str] = {}
    for one in (description["type_description"], *description["referenced_type_descriptions"]):
        _, folder, own = one["type_name"].split("/") if one["type_name"].count("/") == 2 else ("", "", "")  # noqa: PLR2004 - package/folder/Type
        if folder == family(one["type_name"]) and not own.endswith(_WHOLE):
            fields = (field for field in one["fields"] if field["name"] != MEMBER_OF_NOTHING)
            lines = (f"{_written(field['type'])} {field['name']}\n" for field in fields)
            definitions[short(one["type_name"])] = "".join(lines)
    return definitions


def _written(field_type: dict[str, Any]) -> str:
    group, base = divmod(field_type["type_id"], _GROUP)
    if base == _NESTED:
        element = short(field_type["nested_type_name"])
    elif base == _BOUNDED_STRING:
        element = f"string<={field_type['string_capacity']}"
    elif base in _BASE:
        element = _BASE[base]
    else:
        raise RobotError("KG804", f"fields of the type {field_type['type_id']} are not supported")
    if group == _ONE:
        return element
    limit = {_ARRAY: f"{field_type['capacity']}", _LIMITED: f"<={field_type['capacity']}"}.get(group, "")
    return f"{element}[{limit}]"
