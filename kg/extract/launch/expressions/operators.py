"""Operators on values: Python's own on those that are whole; texts and lists are joined part by part.

Comparisons and truth are known as far as they are certain.
"""

from __future__ import annotations

import ast
import operator
from typing import TYPE_CHECKING, Any, Final

from kg.extract.launch.expressions.formatting import format_percent
from kg.extract.launch.expressions.joining import add
from kg.extract.launch.expressions.texts import known, reason_of, to_text
from kg.extract.launch.expressions.values import (
    Choice,
    Guarded,
    Items,
    Object,
    Substitution,
    Table,
    TextLike,
    Unknown,
    Words,
)
from kg.extract.launch.expressions.whole import (
    MAX_BITS,
    MAX_ITEMS,
    MAX_TEXT,
    UnsupportedError,
    apply,
    is_whole,
    refuse_over,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.launch.expressions.texts import Settler
    from kg.extract.launch.expressions.values import Value

__all__ = ["binary", "compare", "same", "truth", "unary"]


def _multiply(left: Any, right: Any) -> object:
    for one, times in ((left, right), (right, left)):
        if isinstance(one, str | Items | tuple) and isinstance(times, int):
            refuse_over(len(one) * times, MAX_TEXT if isinstance(one, str) else MAX_ITEMS)
    return left * right


def _power(left: Any, right: Any) -> object:
    if isinstance(left, int) and isinstance(right, int) and left.bit_length() * abs(right) > MAX_BITS:
        raise UnsupportedError("a number grows too large")
    return left**right


def _shift(left: Any, right: Any) -> object:
    if isinstance(right, int) and right > MAX_BITS:
        raise UnsupportedError("a number grows too large")
    return left << right


_BINARY: Final[dict[type[ast.operator], Callable[[Any, Any], object]]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: _multiply,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.Pow: _power,
    ast.LShift: _shift,
    ast.RShift: operator.rshift,
    ast.BitAnd: operator.and_,
    ast.BitOr: operator.or_,
    ast.BitXor: operator.xor,
    ast.MatMult: operator.matmul,
}
_UNARY: Final[dict[type[ast.unaryop], Callable[[Any], object]]] = {
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
    ast.Invert: operator.invert,
}
_COMPARED: Final[dict[type[ast.cmpop], Callable[[Any, Any], object]]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.In: lambda left, right: left in right,
    ast.NotIn: lambda left, right: left not in right,
}


def unary(kind: type[ast.unaryop], value: Value, context: Settler | None) -> Value:
    """Return `not value`, `-value`, `+value`, `~value`."""
    if kind is ast.Not:
        found = truth(value, context)
        return Unknown(reason_of(value)) if found is None else not found
    return apply(_UNARY[kind], [value]) if is_whole(value) else Unknown(reason_of(value))


def binary(kind: type[ast.operator], left: Value, right: Value) -> Value:
    """Return `left OPERATOR right`."""
    if kind is ast.Mod and isinstance(left, str):
        return format_percent(left, right)
    if kind is ast.Add:
        joined = add(left, right)
        if joined is not None:
            return joined
    if kind is ast.Div and isinstance(left, TextLike):
        return left.below(right)
    if kind is ast.Div and isinstance(left, Words):
        return _path(left, right)
    if kind is ast.BitOr and isinstance(left, Table) and isinstance(right, Table):
        merged = left.copy()
        merged.update(right)
        merged.places.update(right.places)
        merged.rest = left.rest or right.rest
        return merged
    if kind is ast.Mult and isinstance(left, Items) and isinstance(right, int):
        refuse_over(len(left) * right, MAX_ITEMS)
        return Items(list(left) * right, left.guards)
    if is_whole(left) and is_whole(right):
        return apply(_BINARY[kind], [left, right])
    return Unknown(reason_of(right if is_whole(left) or isinstance(left, Items | tuple) else left))


def _path(left: Words, right: Value) -> Value:
    """Return a path below another, of launch's path substitutions."""
    if len(left.parts) == 1 and isinstance(left.parts[0], Substitution) and left.parts[0].kind == "path-join":
        return Words((Substitution("path-join", (*left.parts[0].arguments, to_text(right))),), lazy=True)
    return Words((Substitution("path-join", (left.parts, to_text(right))),), lazy=True)


def truth(value: Value, context: Settler | None = None) -> bool | None:
    """Return whether a value is true; None where that cannot be known."""
    if value is None or isinstance(value, bool | int | float | str | tuple):
        return bool(value)
    if isinstance(value, Words):
        if value.lazy:
            return True  # an object that has no length
        text = known(value, context)
        return bool(text) if text is not None else True if any(isinstance(part, str) for part in value.parts) else None
    if isinstance(value, Table):
        return True if value else None if value.rest else False
    if isinstance(value, Items):
        return True if any(not isinstance(item, Guarded | Unknown) for item in value) else None if value else False
    if isinstance(value, Choice):
        found = {truth(option, context) for _, option in value.options}
        return found.pop() if len(found) == 1 else None
    return True if isinstance(value, Object) else None


def compare(kind: type[ast.cmpop], left: Value, right: Value, context: Settler | None) -> bool | None:
    """Return whether a comparison holds; None where that cannot be known."""
    if kind in {ast.Is, ast.IsNot}:
        found = _identical(left, right, context)
        return found if found is None or kind is ast.Is else not found
    if is_whole(left) and is_whole(right):
        return bool(apply(_COMPARED[kind], [left, right]))
    if kind in {ast.Eq, ast.NotEq}:
        found = _equal(left, right, context)
        return found if found is None or kind is ast.Eq else not found
    if kind in {ast.In, ast.NotIn}:
        found = _contains(right, left, context)
        return found if found is None or kind is ast.In else not found
    return None


def _identical(left: Value, right: Value, context: Settler | None) -> bool | None:
    """Return whether two values are one object; equal texts and numbers count as one."""
    whole = is_whole(left) and is_whole(right)
    if whole and (type(left) is not type(right) or isinstance(left, Items | Table | tuple)):
        return left is right
    return _equal(left, right, context)


def _equal(left: Value, right: Value, context: Settler | None) -> bool | None:
    if left is right:
        return True
    for one, other in ((left, right), (right, left)):
        if isinstance(one, Words) and one.lazy and (other is None or isinstance(other, str | bool | int | float)):
            return False  # a substitution is an object: it equals no text, whatever it gives when it is performed
        if one is None and not isinstance(other, Unknown | Choice):
            return False
    if is_whole(left) and is_whole(right):
        return bool(left == right)
    first, second = known(left, context), known(right, context)
    return first == second if first is not None and second is not None else None


def _contains(container: Value, item: Value, context: Settler | None) -> bool | None:
    text, part = known(container, context), known(item, context)
    if text is not None and part is not None:
        return part in text
    if isinstance(container, Table):
        if is_whole(item) and not isinstance(item, Items | Table) and item in container:
            return True
        return False if container.rest is None and is_whole(item) else None
    if not isinstance(container, Items | tuple):
        return None
    found = [_equal(other, item, context) for other in container]
    return True if True in found else None if None in found else False


def same(left: Value, right: Value) -> bool:
    """Tell whether two values are certainly one."""
    if left is right:
        return True
    simple = (str, bool, int, float, Words, TextLike, Unknown)
    return type(left) is type(right) and isinstance(left, simple) and bool(left == right)
