"""Message types in DDS: classes for Cyclone DDS created from `Types`, and types learned from peers (XTypes).

The classes describe a type to the library; `Types` encodes and decodes the values, since both use the CDR of ROS 2
(XCDR version 1, little endian).
"""

from __future__ import annotations

import asyncio
import typing
from typing import TYPE_CHECKING, Any, Final

from cyclonedds.core import DDSException
from cyclonedds.dynamic import get_types_for_typeid
from cyclonedds.idl import IdlStruct, make_idl_struct
from cyclonedds.idl import types as idl
from cyclonedds.idl.types import array, bounded_str, sequence
from cyclonedds.util import duration

from kg.errors import RobotError
from kg.robot.messages.types import learn_all
from kg.robot.messages.values import MEMBER_OF_NOTHING
from kg.robot.ros2.names import dds_type, ros_type

if TYPE_CHECKING:
    from cyclonedds.domain import DomainParticipant

    from kg.robot.messages import Field, Types

_BASE: Final[dict[str, Any]] = {
    "bool": bool,
    "byte": idl.uint8,
    "char": idl.uint8,
    "octet": idl.uint8,
    "int8": idl.int8,
    "int16": idl.int16,
    "int32": idl.int32,
    "int64": idl.int64,
    "uint8": idl.uint8,
    "uint16": idl.uint16,
    "uint32": idl.uint32,
    "uint64": idl.uint64,
    "float32": idl.float32,
    "float64": idl.float64,
    "string": str,
}
_ARRAY: Final[Any] = idl.array
_SEQUENCE: Final[Any] = idl.sequence
HEADER: Final = {"guid": idl.uint64, "seq": idl.int64}
"""The header of rmw_cyclonedds_cpp before requests and responses (cdds_request_header_t)."""


class Classes:
    """A cache of the created classes."""

    def __init__(self, types: Types) -> None:
        self._types = types
        self._classes: dict[tuple[str, bool], Any] = {}

    def of(self, kind: str, *, header: bool = False) -> Any:
        """Return the class of a message, optionally with a service header before it; RobotError KG804."""
        if (kind, header) not in self._classes:
            fields = {one.name: self._sort(kind, one) for one in self._types.fields(kind)}
            fields = fields or {"structure_needs_at_least_one_member": idl.uint8}
            name = kind.partition("/")[2] + "_"
            typename = dds_type(kind).replace("::", ".")
            before = {one + "_" * (one in fields): sort for one, sort in HEADER.items()} if header else {}
            struct = make_idl_struct(name, typename, {**before, **fields}, dataclassify=False)
            self._classes[kind, header] = struct
        return self._classes[kind, header]

    def _sort(self, kind: str, field: Field) -> Any:
        if field.is_message:
            element = self.of(field.type)
        elif field.type in _BASE:
            element = _BASE[field.type]
        else:
            raise RobotError("KG804", f"`{kind}` has a field of the type {field.type}, which cannot be sent over DDS")
        if field.length is None:
            return element
        return _ARRAY[element, field.length] if field.length else _SEQUENCE[element]


_WAIT: Final = duration(seconds=1)
_PLAIN: Final[dict[Any, str]] = {bool: "bool", str: "string"}


async def learned(participant: DomainParticipant, type_id: Any, types: Types) -> bool:
    """Request the description of a type and learn it with its nested types; return whether that succeeded.

    The library blocks until peers answer, so it is called in a thread.
    """
    try:
        _, descriptions = await asyncio.to_thread(get_types_for_typeid, participant, type_id, _WAIT)
        learn_all(types, dict(map(definition, descriptions.values())))
    except (DDSException, RobotError, TypeError, ValueError):
        return False
    return True


def definition(sort: Any) -> tuple[str, str]:
    """Return the name and the text of the definition of a message; TypeError for types unknown to ROS 2.

    The header of a request or response is not part of the service's type, and is left out.
    """
    hints = typing.get_type_hints(sort, include_extras=True)
    if _name(sort).endswith(("_Request", "_Response")) and [*hints][: len(HEADER)] == [*HEADER]:
        hints = dict([*hints.items()][len(HEADER) :])
    lines = [f"{_written(hint)} {name}\n" for name, hint in hints.items() if name != MEMBER_OF_NOTHING]
    return _name(sort), "".join(lines)


def _name(sort: Any) -> str:
    name = ros_type(sort.__idl_typename__.replace(".", "::"))
    if name is None:
        raise TypeError(sort.__idl_typename__)
    return name


def _written(hint: Any) -> str:
    inner = hint.__metadata__[0] if hasattr(hint, "__metadata__") else hint
    if isinstance(inner, sequence):
        limit = f"<={inner.max_length}" if inner.max_length else ""
        return f"{_written(inner.subtype)}[{limit}]"
    if isinstance(inner, array):
        return f"{_written(inner.subtype)}[{inner.length}]"
    if isinstance(inner, bounded_str):
        return f"string<={inner.max_length}"
    if isinstance(inner, str):
        return inner
    if inner in _PLAIN:
        return _PLAIN[inner]
    if isinstance(inner, type) and issubclass(inner, IdlStruct):
        return _name(inner)
    raise TypeError(inner)
