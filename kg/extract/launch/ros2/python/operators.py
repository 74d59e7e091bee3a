"""Operators on values: arithmetic within bounds, joining of texts, comparisons and truth as far as they are certain."""

from __future__ import annotations

import ast
import operator
from typing import TYPE_CHECKING, Final

from kg.extract.launch.ros2.actions import Action, Condition, Substitution
from kg.extract.launch.ros2.python.machine import MAX_ITEMS, MAX_TEXT
from kg.extract.launch.ros2.python.paths import join_paths
from kg.extract.launch.ros2.python.texts import known, reason_of, simplify, to_text
from kg.extract.launch.ros2.python.values import (
    Choice,
    Description,
    Function,
    Guarded,
    Instance,
    Items,
    PathValue,
    Table,
    Unknown,
    Words,
    guard,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.launch.ros2.context import Context
    from kg.extract.launch.ros2.python.values import Value

__all__ = ["add", "binary", "compare", "is_whole", "same", "truth"]

_ARITHMETIC: Final[dict[type[ast.operator], Callable[[float, float], float]]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
}
_ORDER: Final[dict[type[ast.cmpop], Callable[[float, float], bool]]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}
_MAX_NUMBER: Final = 10**30


def is_whole(value: Value) -> bool:
    """Tell whether a value is one of Python that is wholly known."""
    if value is None or isinstance(value, str | bool | int | float):
        return True
    return isinstance(value, Items | tuple) and all(is_whole(item) for item in value)


def binary(kind: type[ast.operator], left: Value, right: Value) -> Value:
    """Return `left OPERATOR right` for all operators but those of formatting."""
    if kind is ast.Add:
        return add(left, right)
    if kind is ast.Div and isinstance(left, PathValue | Words):
        return _divide(left, right)
    if kind is ast.BitOr and isinstance(left, Table) and isinstance(right, Table):
        merged = left.copy()
        merged.update(right)
        merged.places.update(right.places)
        return merged
    if kind is ast.Mult and isinstance(left, str | Items) and isinstance(right, int):
        return _repeat(left, right)
    return _calculate(kind, left, right)


def _calculate(kind: type[ast.operator], left: Value, right: Value) -> Value:
    function = _ARITHMETIC.get(kind)
    if function is None or not isinstance(left, int | float) or not isinstance(right, int | float):
        whole = isinstance(left, int | float | str | Items | tuple)
        return Unknown(reason_of(right if whole else left))
    if abs(left) > _MAX_NUMBER or abs(right) > _MAX_NUMBER:
        return Unknown("a number is too large")
    try:
        return function(left, right)
    except (ArithmeticError, ValueError):
        return Unknown("the calculation fails")


def add(left: Value, right: Value) -> Value:
    """Return `left + right`; texts with unknown parts are joined part by part."""
    if isinstance(left, str) and isinstance(right, str):
        return left + right if len(left) + len(right) <= MAX_TEXT else Unknown("a text is too long")
    if isinstance(left, Items) and isinstance(right, Items):
        if len(left) + len(right) > MAX_ITEMS:
            return Unknown("too many items")
        return Items([*left, *right], left.guards, left.places + right.places)
    if isinstance(left, tuple) and isinstance(right, tuple):
        return left + right if len(left) + len(right) <= MAX_ITEMS else Unknown("too many items")
    if isinstance(left, str | Words) and isinstance(right, str | Words | Unknown | Choice):
        return simplify(to_text(left) + to_text(right), lazy=isinstance(left, Words) and left.lazy)
    if isinstance(left, Unknown | Choice) and isinstance(right, str | Words):
        return simplify(to_text(left) + to_text(right))
    if isinstance(left, Items | Choice | Unknown) and isinstance(right, Items | Choice | Unknown):
        return Items([*_spread(left), *_spread(right)], left.guards if isinstance(left, Items) else ())
    return _calculate(ast.Add, left, right)


def _spread(value: Items | Choice | Unknown) -> list[Value]:
    """Return the items of a list of which not all need to be known."""
    if isinstance(value, Items):
        return list(value)
    if isinstance(value, Unknown):
        return [value]
    found: list[Value] = []
    for condition, option in value.options:
        inner = list(option) if isinstance(option, Items | tuple) else [option]
        found += [guard(condition, item) if condition else item for item in inner]
    return found


def _divide(left: PathValue | Words, right: Value) -> Value:
    """Return a path below another: of pathlib, or of launch's path substitutions."""
    if isinstance(left, PathValue):
        return PathValue(join_paths([left, right]))
    if len(left.parts) == 1 and isinstance(left.parts[0], Substitution) and left.parts[0].kind == "path-join":
        return Words((Substitution("path-join", (*left.parts[0].arguments, to_text(right))),), lazy=True)
    return Words((Substitution("path-join", (left.parts, to_text(right))),), lazy=True)


def _repeat(left: str | Items, times: int) -> Value:
    if len(left) * max(times, 0) > MAX_ITEMS:
        return Unknown("a value is too long")
    return left * times if isinstance(left, str) else Items(list(left) * times, left.guards)


def truth(value: Value, context: Context | None = None) -> bool | None:
    """Return whether a value is true; None where that cannot be known."""
    if value is None or isinstance(value, bool | int | float | str):
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
    if isinstance(value, tuple):
        return bool(value)
    if isinstance(value, Choice):
        found = {truth(option, context) for _, option in value.options}
        return found.pop() if len(found) == 1 else None
    if isinstance(value, Action | Condition | Description | Function | Instance | PathValue):
        return True
    return None


def compare(kind: type[ast.cmpop], left: Value, right: Value, context: Context | None) -> bool | None:
    """Return whether a comparison holds; None where that cannot be known."""
    if kind in {ast.Eq, ast.Is}:
        return _equal(left, right, context)
    if kind in {ast.NotEq, ast.IsNot}:
        found = _equal(left, right, context)
        return None if found is None else not found
    if kind in {ast.In, ast.NotIn}:
        found = _contains(right, left, context)
        return found if found is None or kind is ast.In else not found
    if isinstance(left, int | float) and isinstance(right, int | float):
        return _ORDER[kind](left, right)
    return None


def _equal(left: Value, right: Value, context: Context | None) -> bool | None:
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


def _contains(container: Value, item: Value, context: Context | None) -> bool | None:
    text, part = known(container, context), known(item, context)
    if text is not None and part is not None:
        return part in text
    if isinstance(container, Table):
        if is_whole(item) and not isinstance(item, Items) and item in container:
            return True
        return False if container.rest is None and is_whole(item) else None
    if not isinstance(container, Items | tuple | set | frozenset):
        return None
    found = [_equal(other, item, context) for other in container]
    return True if True in found else None if None in found else False


def same(left: Value, right: Value) -> bool:
    """Tell whether two values are certainly one."""
    if left is right:
        return True
    simple = (str, bool, int, float, Words, PathValue, Unknown)
    return type(left) is type(right) and isinstance(left, simple) and bool(left == right)
