"""Messages as rosbridge writes them in JSON, to plain values and back.

Arrays of bytes are texts in base64, numbers that are not finite are null, times of ROS 1 have `secs` and `nsecs`
(github.com/RobotWebTools/rosbridge_suite, ROSBRIDGE_PROTOCOL.md and `message_conversion.py`).
"""

from __future__ import annotations

import math
from base64 import b64decode, b64encode
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from kg.robot.connection import Value
    from kg.robot.messages import Field, Types

__all__ = ["from_json", "to_json"]

_TIMES: Final = {"builtin_interfaces/Time", "builtin_interfaces/Duration"}
_BYTES: Final = {"uint8", "char", "octet"}
_SECONDS: Final = {1: ("secs", "nsecs"), 2: ("sec", "nanosec")}


def from_json(types: Types, kind: str, told: Any) -> Value:
    """Return the value of a message, whole; RobotError KG805 for what is none of that type, KG804 for no type."""
    return types.complete(kind, _read(types, kind, told))


def _read(types: Types, kind: str, told: Any) -> Any:
    if not isinstance(told, dict):
        return told  # which `complete` refuses, with the field
    if kind in _TIMES:
        names = _SECONDS[1] if "secs" in told else _SECONDS[2]
        return {new: told.get(old, 0) for new, old in zip(_SECONDS[2], names, strict=True)}
    fields = {one.name: one for one in types.fields(kind)}
    return {name: _read_field(types, fields[name], one) if name in fields else one for name, one in told.items()}


def _read_field(types: Types, field: Field, told: Any) -> Any:
    if field.length is None:
        return _read_one(types, field, told)
    if field.type in _BYTES and isinstance(told, str):
        return b64decode(told, validate=True)
    return [_read_one(types, field, one) for one in told] if isinstance(told, list) else told


def _read_one(types: Types, field: Field, told: Any) -> Any:
    if field.is_message:
        return _read(types, field.type, told)
    return math.nan if told is None and field.type.startswith("float") else told


def to_json(types: Types, kind: str, value: Value) -> dict[str, Any]:
    """Return the object of a message, whole; RobotError KG805 and KG804 as `Types.complete`."""
    written: dict[str, Any] = _write(types, kind, types.complete(kind, value))
    return written


def _write(types: Types, kind: str, value: Value) -> Any:
    if kind in _TIMES:
        return dict(zip(_SECONDS[types.ros], (value["sec"], value["nanosec"]), strict=True))
    return {one.name: _write_field(types, one, value[one.name]) for one in types.fields(kind)}


def _write_field(types: Types, field: Field, value: Any) -> Any:
    if isinstance(value, bytes):
        return b64encode(value).decode()
    if field.length is not None:
        return [_write_one(types, field, one) for one in value]
    return _write_one(types, field, value)


def _write_one(types: Types, field: Field, value: Any) -> Any:
    if field.is_message:
        return _write(types, field.type, value)
    return None if isinstance(value, float) and not math.isfinite(value) else value
