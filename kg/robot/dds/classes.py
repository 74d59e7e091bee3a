"""Classes of messages for Cyclone DDS, made while it runs from what `Types` knows.

They tell the library the form of a type; values are encoded and decoded by `Types`, since both write the CDR that
ROS 2 has on the wire (XCDR version 1, little endian).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from cyclonedds.idl import make_idl_struct
from cyclonedds.idl import types as idl

from kg.errors import RobotError
from kg.robot.ros2.names import dds_type

if TYPE_CHECKING:
    from kg.robot.messages import Field, Types

__all__ = ["HEADER", "Classes"]

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
"""What rmw_cyclonedds_cpp puts before requests and responses (cdds_request_header_t)."""


class Classes:
    """The classes that were made, each once."""

    def __init__(self, types: Types) -> None:
        self._types = types
        self._made: dict[tuple[str, bool], Any] = {}

    def of(self, kind: str, *, header: bool = False) -> Any:
        """Return the class of a message, with the header of a service before it if asked for; RobotError KG804."""
        if (kind, header) not in self._made:
            fields = {one.name: self._sort(kind, one) for one in self._types.fields(kind)}
            fields = fields or {"structure_needs_at_least_one_member": idl.uint8}
            name = kind.partition("/")[2] + "_"
            typename = dds_type(kind).replace("::", ".")
            before = {one + "_" * (one in fields): sort for one, sort in HEADER.items()} if header else {}
            made = make_idl_struct(name, typename, {**before, **fields}, dataclassify=False)
            self._made[kind, header] = made
        return self._made[kind, header]

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
