"""Expressions of Python in launch files (`$(eval ...)`), evaluated by walking them: nothing is compiled or run.

Known are literals, operators, comparisons, conditional expressions, indexing, and calls of the functions that are
given and of methods of texts that only read. Everything is bounded: length, depth, exponents, sizes of values, work.
"""

from __future__ import annotations

import ast
import math
import operator
import warnings
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

__all__ = ["BUILTINS", "MATHEMATICS", "ExpressionError", "evaluate_expression"]

_MOST_TEXT: Final = 20_000
_MOST_DEPTH: Final = 60
_MOST_SIZE: Final = 100_000
"""Characters and items that one value may have; integers count their bytes."""
_MOST_WORK: Final = 5_000_000
_MOST_BITS: Final = 4_096

_ENDLESS: Final = {"comb", "factorial", "perm", "prod", "dist", "sumprod", "fma"}
"""Functions of `math` whose cost is not bounded by the size of what they are given, or that no launch file needs."""

MATHEMATICS: Final[Mapping[str, object]] = {
    name: getattr(math, name) for name in dir(math) if not name.startswith("_") and name not in _ENDLESS
}
"""Functions and constants of `math` by name."""

BUILTINS: Final[Mapping[str, Callable[..., object]]] = {
    function.__name__: function
    for function in (abs, all, any, bool, dict, float, int, len, list, max, min, round, sorted, str, sum, tuple)
}
"""Functions of Python that are safe on values of bounded size."""

_METHODS: Final[Mapping[type, set[str]]] = {
    str: {
        *("capitalize", "count", "endswith", "find", "index", "isalpha", "isalnum", "isdigit", "islower", "isnumeric"),
        *("isspace", "isupper", "join", "lower", "lstrip", "partition", "removeprefix", "removesuffix", "replace"),
        *("rfind", "rindex", "rpartition", "rsplit", "rstrip", "split", "splitlines", "startswith", "strip", "title"),
        "upper",
    },
    list: {"count", "index"},
    tuple: {"count", "index"},
    dict: {"get", "items", "keys", "values"},
}

_UNARY: Final[dict[type[ast.unaryop], Callable[..., object]]] = {
    ast.Not: operator.not_,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
    ast.Invert: operator.invert,
}
_BINARY: Final[dict[type[ast.operator], Callable[..., object]]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.Pow: operator.pow,
    ast.LShift: operator.lshift,
    ast.RShift: operator.rshift,
    ast.BitAnd: operator.and_,
    ast.BitOr: operator.or_,
    ast.BitXor: operator.xor,
}
_COMPARED: Final[dict[type[ast.cmpop], Callable[..., object]]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Is: operator.is_,
    ast.IsNot: operator.is_not,
    ast.In: lambda left, right: left in right,
    ast.NotIn: lambda left, right: left not in right,
}


class ExpressionError(Exception):
    """An expression cannot be evaluated: it is malformed, too large, uses what is not allowed, or fails itself."""


def evaluate_expression(
    text: str, names: Mapping[str, object], functions: Mapping[str, Callable[..., object]]
) -> object:
    """Return the value of an expression in which `names` and `functions` are known, dotted ones (`math.pi`) too.

    Raises `ExpressionError`; an exception that a given function raises passes unless it is one that Python's own
    operations raise (`TypeError`, `ValueError`, `ArithmeticError`, `LookupError`, `AttributeError`).
    """
    if len(text) > _MOST_TEXT:
        raise ExpressionError(f"the expression has more than {_MOST_TEXT} characters")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about escapes, which are the launch file's own
            tree = ast.parse(text.strip(), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise ExpressionError(f"`{_short(text)}` is no expression of Python") from error
    try:
        return _Walk(names, functions).value(tree.body, 0)
    except (TypeError, ValueError, ArithmeticError, LookupError, AttributeError, RecursionError) as error:
        raise ExpressionError(f"`{_short(text)}` cannot be evaluated: {error}") from error


class _Walk:
    """One evaluation."""

    def __init__(self, names: Mapping[str, object], functions: Mapping[str, Callable[..., object]]) -> None:
        self._names = names
        self._functions = functions
        self._work = 0

    def value(self, node: ast.expr, depth: int) -> object:
        """Return the value of a node, which is of bounded size."""
        if depth > _MOST_DEPTH:
            raise ExpressionError(f"the expression is nested deeper than {_MOST_DEPTH} levels")
        reader = _READERS.get(type(node))
        if reader is None:
            raise ExpressionError(f"`{_short(ast.unparse(node))}` is not allowed in an expression")
        value = reader(self, node, depth + 1)
        self._work += self.bounded(value)
        if self._work > _MOST_WORK:
            raise ExpressionError("the expression means too much work")
        return value

    def bounded(self, *values: object) -> int:
        """Return the size of values; raises where it is more than a value may have."""
        size = sum(_size(value, 0) for value in values)
        if size > _MOST_SIZE:
            raise ExpressionError(f"a value of the expression is larger than {_MOST_SIZE} characters")
        return size

    def constant(self, node: ast.Constant, _depth: int) -> object:
        if isinstance(node.value, bytes | complex) or node.value is ...:
            raise ExpressionError(f"`{node.value!r}` is not allowed in an expression")
        return node.value

    def name(self, node: ast.Name, _depth: int) -> object:
        return self._known(node.id)

    def _known(self, name: str) -> object:
        if name in self._names:
            return self._names[name]
        if name in self._functions:
            return self._functions[name]
        raise ExpressionError(f"`{name}` is not known")

    def attribute(self, node: ast.Attribute, _depth: int) -> object:
        dotted = _dotted(node)
        if dotted is None:
            raise ExpressionError(f"`{_short(ast.unparse(node))}` is not allowed in an expression")
        return self._known(dotted)

    def both(self, node: ast.BoolOp, depth: int) -> object:
        ends = isinstance(node.op, ast.Or)
        value: object = None
        for operand in node.values:
            value = self.value(operand, depth)
            if bool(value) is ends:
                break
        return value

    def unary(self, node: ast.UnaryOp, depth: int) -> object:
        return _UNARY[type(node.op)](self.value(node.operand, depth))

    def binary(self, node: ast.BinOp, depth: int) -> object:
        apply = _BINARY.get(type(node.op))
        if apply is None:
            raise ExpressionError("matrices are not known in an expression")
        left, right = self.value(node.left, depth), self.value(node.right, depth)
        _check_growth(node.op, left, right)
        return apply(left, right)

    def compared(self, node: ast.Compare, depth: int) -> object:
        left = self.value(node.left, depth)
        value: object = True
        for kind, operand in zip(node.ops, node.comparators, strict=True):
            right = self.value(operand, depth)
            value = _COMPARED[type(kind)](left, right)
            if not value:
                break
            left = right
        return value

    def either(self, node: ast.IfExp, depth: int) -> object:
        return self.value(node.body if self.value(node.test, depth) else node.orelse, depth)

    def items(self, node: ast.List | ast.Tuple, depth: int) -> object:
        values = self._values(node.elts, depth)
        return tuple(values) if isinstance(node, ast.Tuple) else values

    def mapping(self, node: ast.Dict, depth: int) -> object:
        keys = self._values([key for key in node.keys if key is not None], depth)
        values = self._values(node.values, depth)
        return dict(zip(keys, values, strict=True))

    def _values(self, nodes: Sequence[ast.expr], depth: int) -> list[object]:
        values = []
        size = 0
        for node in nodes:
            values.append(self.value(node, depth))
            size += self.bounded(values[-1])
            if size > _MOST_SIZE:
                raise ExpressionError(f"a value of the expression is larger than {_MOST_SIZE} characters")
        return values

    def part(self, node: ast.Subscript, depth: int) -> object:
        whole: object = self.value(node.value, depth)
        if not isinstance(whole, str | list | tuple | dict):
            raise ExpressionError(f"`{_short(ast.unparse(node.value))}` has no items")
        if isinstance(node.slice, ast.Slice):
            ends = (node.slice.lower, node.slice.upper, node.slice.step)
            wanted: object = slice(*(None if end is None else self.value(end, depth) for end in ends))
        else:
            wanted = self.value(node.slice, depth)
        found: object = operator.getitem(whole, wanted)  # type: ignore[misc]  # a wrong one is a TypeError
        return found

    def formatted(self, node: ast.JoinedStr, depth: int) -> object:
        parts = []
        for piece in node.values:
            if isinstance(piece, ast.FormattedValue):
                if piece.format_spec is not None or piece.conversion not in (-1, ord("s")):
                    raise ExpressionError("formats are not allowed in an expression")
                parts.append(str(self.value(piece.value, depth)))
            else:
                parts.append(str(self.value(piece, depth)))
            self.bounded(*parts)
        return "".join(parts)

    def call(self, node: ast.Call, depth: int) -> object:
        if any(keyword.arg is None for keyword in node.keywords):
            raise ExpressionError("`**` is not allowed in an expression")
        function = self._function(node.func, depth)
        arguments = self._values(node.args, depth)
        named = {str(keyword.arg): self.value(keyword.value, depth) for keyword in node.keywords}
        self.bounded(*arguments, *named.values())
        return function(*arguments, **named)

    def _function(self, node: ast.expr, depth: int) -> Callable[..., object]:
        if isinstance(node, ast.Attribute) and ((dotted := _dotted(node)) is None or not self._has(dotted)):
            return _method(self.value(node.value, depth), node.attr)
        function = self.value(node, depth)
        if not callable(function):
            raise ExpressionError(f"`{_short(ast.unparse(node))}` is no function")
        return function

    def _has(self, name: str) -> bool:
        return name in self._names or name in self._functions


_READERS: Final[dict[type[ast.expr], Callable[[_Walk, Any, int], object]]] = {
    ast.Constant: _Walk.constant,
    ast.Name: _Walk.name,
    ast.Attribute: _Walk.attribute,
    ast.BoolOp: _Walk.both,
    ast.UnaryOp: _Walk.unary,
    ast.BinOp: _Walk.binary,
    ast.Compare: _Walk.compared,
    ast.IfExp: _Walk.either,
    ast.List: _Walk.items,
    ast.Tuple: _Walk.items,
    ast.Dict: _Walk.mapping,
    ast.Subscript: _Walk.part,
    ast.JoinedStr: _Walk.formatted,
    ast.Call: _Walk.call,
}


def _method(owner: object, name: str) -> Callable[..., object]:
    """Return a method of a text or a collection that only reads it."""
    if name not in _METHODS.get(type(owner), ()):
        raise ExpressionError(f"`.{name}` is not allowed in an expression")

    def bounded(*arguments: object) -> object:
        if name == "replace" and isinstance(owner, str) and len(arguments) > 1:
            _refuse_over((len(owner) + 1) * max(1, _size(arguments[1], 0)))
        if name == "join" and isinstance(owner, str) and arguments:
            _refuse_over(_size(arguments[0], 0) * (len(owner) + 1))
        found: object = getattr(owner, name)(*arguments)
        return list(found) if isinstance(owner, dict) and name != "get" else found  # type: ignore[call-overload]  # views

    return bounded


def _check_growth(kind: ast.operator, left: object, right: object) -> None:
    """Refuse what would make a value too large before it is made."""
    if isinstance(kind, ast.Pow) and isinstance(left, int) and isinstance(right, int):
        bits = left.bit_length() * abs(right)
        if abs(left) > 1 and bits > _MOST_BITS:
            raise ExpressionError("the exponent is too large")
    elif isinstance(kind, ast.LShift) and isinstance(right, int) and right > _MOST_BITS:
        raise ExpressionError("the exponent is too large")
    elif isinstance(kind, ast.Mult):
        for whole, times in ((left, right), (right, left)):
            if isinstance(whole, str | list | tuple) and isinstance(times, int):
                _refuse_over(_size(whole, 0) * max(0, times))
    elif isinstance(kind, ast.Mod) and isinstance(left, str) and any(mark in left for mark in "0123456789*"):
        raise ExpressionError("formats with a width are not allowed in an expression")


def _refuse_over(size: int) -> None:
    if size > _MOST_SIZE:
        raise ExpressionError(f"a value of the expression is larger than {_MOST_SIZE} characters")


def _size(value: object, depth: int) -> int:
    if isinstance(value, str):
        return len(value) + 1
    if isinstance(value, int):
        return value.bit_length() // 8 + 1
    if depth <= _MOST_DEPTH and isinstance(value, list | tuple | set):
        return 1 + sum(_size(item, depth + 1) for item in value)
    if depth <= _MOST_DEPTH and isinstance(value, dict):
        return 1 + sum(_size(key, depth + 1) + _size(item, depth + 1) for key, item in value.items())
    return 1


def _dotted(node: ast.expr) -> str | None:
    """Return a name with dots as it is written; None for any other expression."""
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute):
        before = _dotted(node.value)
        return None if before is None else f"{before}.{node.attr}"
    return None


def _short(text: str) -> str:
    return text if len(text) <= 60 else f"{text[:57]}..."  # noqa: PLR2004  (what fits in a message)
