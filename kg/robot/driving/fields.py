"""What is at a path of a message, and putting something there."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from kg.errors import RobotError
from kg.robot.driving.functions import FUNCTIONS
from kg.robot.driving.paths import Call, Each, Field, Path
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from kg.robot.connection import Value
    from kg.robot.driving.functions import Function
    from kg.robot.driving.paths import Argument
    from kg.robot.messages import Types

__all__ = ["check", "look", "put", "roots", "type_at"]


def look(path: Argument, value: Any) -> Any:
    """Return what is at a path of a value; None for what is not there, and for a number that is NaN."""
    if isinstance(path, float):
        return path
    if isinstance(path, Call):
        found = _called(path, value)
    elif isinstance(path, Field):
        found = _field(value if path.of is None else look(path.of, value), path.name, many=_many(path.of))
    elif isinstance(path, Each):
        found = _elements(look(path.of, value), many=_many(path.of))
    else:
        found = _element(look(path.of, value), path.index, many=_many(path.of))
    return None if isinstance(found, float) and math.isnan(found) else found


def _called(call: Call, value: Any) -> Any:
    try:
        return _function(call).read(look, value, call.arguments)
    except (TypeError, KeyError, AttributeError, ArithmeticError):
        raise RobotError("KG826", f"`{call}` is of a field of another kind") from None


def _many(path: Path | None) -> bool:
    """Tell whether what follows a path is taken of each of its elements."""
    if path is None or isinstance(path, Call):
        return False
    return isinstance(path, Each) or _many(path.of)


def _field(of: Any, name: str, *, many: bool) -> Any:
    if many:
        return [_field(one, name, many=False) for one in of or ()]
    return of.get(name) if isinstance(of, dict) else None


def _elements(of: Any, *, many: bool) -> Any:
    if many:
        return [element for one in of or () for element in one or ()]
    return list(of) if isinstance(of, list | tuple | bytes) else []


def _element(of: Any, index: int, *, many: bool) -> Any:
    if many:
        return [_element(one, index, many=False) for one in of or ()]
    return of[index] if isinstance(of, list | tuple | bytes) and -len(of) <= index < len(of) else None


def put(path: Path, message: Value, value: Any) -> None:
    """Put a value at a path of a message, which may lack what is on the way there.

    Raises:
        RobotError: KG826 for a path that only reads.
    """
    if isinstance(path, Call):
        write, (target, *others) = _function(path).write, path.arguments
        numbers = tuple(one for one in others if isinstance(one, float))
        if write is None or isinstance(target, float) or len(numbers) != len(others):
            raise RobotError("KG826", f"`{path}` cannot be written")
        put(target, message, write(value, numbers))
    elif isinstance(path, Field):
        _inner(path.of, message, path)[path.name] = value
    else:
        raise RobotError("KG826", f"`{path}` cannot be written")


def _inner(path: Path | None, message: Value, whole: Path) -> Value:
    """Return the message at a path, made where it is not there."""
    if path is None:
        return message
    if not isinstance(path, Field):
        raise RobotError("KG826", f"`{whole}` cannot be written")
    inner: Value = _inner(path.of, message, whole).setdefault(path.name, {})
    return inner


def _function(call: Call) -> Function:
    function = FUNCTIONS.get(call.function)
    if function is None:
        raise RobotError(
            "KG826", f"`{call}` uses no function that there is", hint=did_you_mean(call.function, FUNCTIONS)
        )
    return function


def roots(path: Argument) -> list[str]:
    """Return the fields of the whole message that a path begins with; a function may look at several."""
    if isinstance(path, float):
        return []
    if isinstance(path, Call):
        paths = path.arguments[:1] if path.function == "nearest" else path.arguments
        return [name for one in paths for name in roots(one)]
    return [path.name] if isinstance(path, Field) and path.of is None else roots(path.of or 0.0)


def check(path: Path, types: Types, kind: str) -> None:
    """Raise RobotError KG826 for a path with a function that is not known, or to a field that a type does not have."""
    type_at(path, types, kind)


def type_at(path: Path, types: Types, kind: str) -> str | None:
    """Return the type that is at a path of a type, None where it is not known.

    Raises:
        RobotError: KG826 as `check`, KG804 when the type of the message is not known.
    """
    return _kind(path, types, kind, str(path))


def _kind(path: Argument, types: Types, kind: str, whole: str) -> str | None:
    """Return the type that is at a path, None where it is not known."""
    if isinstance(path, float):
        return None
    if isinstance(path, Call):
        return _returned(path, types, kind, whole)
    if not isinstance(path, Field):
        return _kind(path.of, types, kind, whole)
    inner = kind if path.of is None else _kind(path.of, types, kind, whole)
    if inner is None:
        return None
    if "/" not in inner:
        raise RobotError("KG826", f"`{whole}`: `{path.of}` has no fields, for it is a {inner}")
    found = {one.name: one for one in types.fields(inner)}
    if path.name not in found:
        hint = did_you_mean(path.name, found) or f"Its fields are: {', '.join(found)}."
        raise RobotError("KG826", f"`{whole}`: {inner} has no field `{path.name}`", hint=hint)
    return found[path.name].type


def _returned(call: Call, types: Types, kind: str, whole: str) -> str | None:
    function = _function(call)
    if not function.least <= len(call.arguments) <= function.most:
        raise RobotError("KG826", f"`{call}` has {len(call.arguments)} arguments, not {function.least}")
    inner = _kind(call.arguments[0], types, kind, whole)
    if call.function == "nearest" and inner is not None:
        _kind(call.arguments[1], types, inner, whole)
    return inner if call.function in {"first", "nearest"} else None
