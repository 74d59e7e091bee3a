"""Conversion of plain values to the classes of `rosbags`, and back."""

from __future__ import annotations

import keyword
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from rosbags.interfaces import Nodetype

from kg.errors import RobotError

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

    from kg.robot.connection import Value

MEMBER_OF_NOTHING: Final = "structure_needs_at_least_one_member"
"""The placeholder field that IDL, and so `rosbags`, puts into a message without fields."""

_NUMPY: Final = {"byte": "int8", "char": "uint8", "octet": "uint8"}


def plain(store: Typestore, kind: str, message: Any) -> Value:
    """Return a message of a type as a dict of its fields."""
    return {
        name: _plain(store, sort, getattr(message, _attribute(name)))
        for name, sort in store.fielddefs[kind][1]
        if name != MEMBER_OF_NOTHING
    }


def _plain(store: Typestore, kind: Any, value: Any) -> Any:
    sort, inner = kind
    if sort is Nodetype.NAME:
        return plain(store, inner, value)
    if sort is Nodetype.BASE:
        return value.item() if isinstance(value, np.generic) else value
    if isinstance(value, np.ndarray):
        return value.tobytes() if value.dtype == np.uint8 else value.tolist()
    return [_plain(store, inner[0], one) for one in value]


def _attribute(name: str) -> str:
    """Return the attribute of a field in `rosbags`, which avoids Python keywords."""
    return f"{name}_" if keyword.iskeyword(name) else name


def shaped(store: Typestore, kind: str, value: Any, path: str = "") -> Any:
    """Return the message for a dict of its fields; RobotError KG805 with the field that does not fit."""
    fields = [field for field in store.fielddefs[kind][1] if field[0] != MEMBER_OF_NOTHING]
    if not isinstance(value, dict):
        raise _misfit(path, value, kind)
    unknown = set(value) - {name for name, _ in fields}
    if unknown:
        listed = ", ".join(name for name, _ in fields) or "none"
        raise RobotError(
            "KG805",
            f"`{kind.replace('/msg/', '/')}` has no field `{min(map(str, unknown))}`",
            hint=f"Its fields are: {listed}.",
        )
    members = {name: _shaped(store, sort, value.get(name), f"{path}.{name}" if path else name) for name, sort in fields}
    return store.types[kind](**{_attribute(name): one for name, one in members.items()})


def _shaped(store: Typestore, kind: Any, value: Any, path: str) -> Any:
    sort, inner = kind
    if sort is Nodetype.NAME:
        return shaped(store, inner, {} if value is None else value, path)
    if sort is Nodetype.BASE:
        return _base(inner[0], value, path)
    element, length = inner
    given = _elements(value, length if sort is Nodetype.ARRAY else 0, element, path)
    if element[0] is Nodetype.BASE and element[1][0] != "string":
        return _array(element[1][0], given, path)
    return [_shaped(store, element, one, f"{path}[{index}]") for index, one in enumerate(given)]


def _elements(value: Any, length: int, element: Any, path: str) -> Any:
    if value is None:
        return [_default(element)] * length
    if not isinstance(value, list | tuple | bytes | bytearray | np.ndarray) or (length and len(value) != length):
        raise _misfit(path, value, f"list of {length} elements" if length else "list")
    return value


def _default(element: Any) -> int | None:
    if element[0] is not Nodetype.BASE or element[1][0] == "string":
        return None
    return False if element[1][0] == "bool" else 0


def _array(kind: str, given: Any, path: str) -> Any:
    wanted = np.dtype(_NUMPY.get(kind, kind))
    if isinstance(given, bytes | bytearray):
        if wanted.itemsize > 1:
            raise _misfit(path, given, f"list of {kind}")
        return np.frombuffer(bytes(given), dtype=wanted)
    try:
        array = np.asarray(given, dtype=_exact(wanted, given))
        fits = not len(given) or (array.ndim == 1 and _fits(array, wanted))
    except (ValueError, TypeError, OverflowError):
        fits = False
    if not fits:
        raise _misfit(path, given, f"list of {kind}")
    return array.astype(wanted)


def _exact(wanted: np.dtype[Any], given: Any) -> np.dtype[Any] | None:
    """Return the type for lists of large and small integers, which numpy would read as floats."""
    return wanted if wanted == np.uint64 and all(type(one) is int for one in given) else None


def _fits(array: Any, wanted: np.dtype[Any]) -> bool:
    if wanted.kind == "b" or array.dtype.kind == "b":
        return bool(wanted.kind == array.dtype.kind)
    if wanted.kind == "f":
        return array.dtype.kind in "iuf"
    limits = np.iinfo(wanted)
    return bool(array.dtype.kind in "iu" and limits.min <= array.min() and array.max() <= limits.max)


def _base(kind: str, value: Any, path: str) -> Any:
    if kind == "string":
        if not isinstance(value, str | None):
            raise _misfit(path, value, "text")
        return value or ""
    if kind == "bool":
        if not isinstance(value, bool | None):
            raise _misfit(path, value, "truth value")
        return bool(value)
    if isinstance(value, bool | str) or not isinstance(value, int | float | None):
        raise _misfit(path, value, "number")
    if kind.startswith("float"):
        return _real(value or 0, path)
    return _whole(kind, value or 0, path)


def _real(value: float, path: str) -> float:
    try:
        return float(value)
    except OverflowError:
        raise _misfit(path, value, "number that a float64 can be") from None


def _whole(kind: str, value: float, path: str) -> int:
    limits = np.iinfo(_NUMPY.get(kind, kind))
    least, most = int(limits.min), int(limits.max)
    if not least <= value <= most or value != int(value):
        raise _misfit(path, value, f"whole number from {least} to {most}")
    return int(value)


def _misfit(path: str, value: Any, kind: str) -> RobotError:
    shown = repr(value)
    return RobotError("KG805", f"`{path}` is {shown[:60]}, not a {kind.replace('/msg/', '/')}")
