"""The expressions of `$(eval ...)`: a small part of Python's, read by Python's parser and evaluated here.

Source: wiki.ros.org/roslaunch/XML, "substitution args". roslaunch gives the text to Python's `eval`; here nothing is
called but the functions listed below, and every value stays small, so that an expression ends soon whatever it says.
"""

from __future__ import annotations

import ast
import math
import operator
import re
import warnings
from typing import TYPE_CHECKING, Any, Final

from kg.extract.launch.ros1.texts import HOLE, MOST_CHARACTERS

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

__all__ = ["ExpressionError", "NotKnownError", "UnsupportedError", "evaluate_expression"]

_MOST_SOURCE: Final = 2000
_MOST_STEPS: Final = 5000
_MOST_DEPTH: Final = 60
_MOST_BITS: Final = 8192
_MOST_FACTORIAL: Final = 500
_MOST_DIGITS: Final = 400
_FORMAT: Final = re.compile(r"%(?:\.?\d{0,2}|0\d)[sdifgr]|%%|[^%]")

_PYTHON_ERRORS: Final = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError)


class ExpressionError(Exception):
    """The expression is none, or Python raises an error when it evaluates it."""


class UnsupportedError(Exception):
    """The expression uses what is not evaluated here, or its values grow too large."""


class NotKnownError(Exception):
    """The value depends on something that is not known."""


def evaluate_expression(
    source: str, look_up: Callable[[str], object], functions: Mapping[str, Callable[..., Any]]
) -> object:
    """Return the value of an expression.

    `look_up` gives the value of a name that Python and `math` do not have, or raises one of the errors of this module;
    `functions` are those that the expression may call beside the built-in ones. A text with a `HOLE` in it is one that
    is known in part: it can be joined with others, all else raises `NotKnownError`.
    """
    if len(source) > _MOST_SOURCE:
        raise UnsupportedError(f"the expression is longer than {_MOST_SOURCE} characters")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree = ast.parse(source.strip(), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise ExpressionError(getattr(error, "msg", None) or "the expression cannot be parsed") from None
    return _Evaluator(look_up, functions).value(tree.body)


def _multiply(left: Any, right: Any) -> object:
    for one, other in ((left, right), (right, left)):
        if isinstance(one, str | list | tuple) and isinstance(other, int) and _size(one) * other > MOST_CHARACTERS:
            raise UnsupportedError("a value grows too large")
    return left * right


def _power(left: Any, right: Any) -> object:
    if isinstance(left, int) and isinstance(right, int) and left.bit_length() * abs(right) > _MOST_BITS:
        raise UnsupportedError("a number grows too large")
    return left**right


def _shift(left: Any, right: Any) -> object:
    if isinstance(right, int) and right > _MOST_BITS:
        raise UnsupportedError("a number grows too large")
    return left << right


def _modulo(left: Any, right: Any) -> object:
    if isinstance(left, str) and (_FORMAT.sub("", left) or left.count("%") * _size(right) > MOST_CHARACTERS):
        raise UnsupportedError("the format of a text is not evaluated")
    return left % right


def _factorial(number: Any) -> int:
    if isinstance(number, int) and number > _MOST_FACTORIAL:
        raise UnsupportedError("a number grows too large")
    return math.factorial(number)


def _rounded(number: Any, digits: Any = None) -> object:
    if isinstance(digits, int) and abs(digits) > _MOST_DIGITS:
        raise UnsupportedError("a number is rounded to too many digits")
    return round(number, digits)


def _replaced(text: str, old: Any, new: Any, *rest: int) -> str:
    if isinstance(old, str) and isinstance(new, str) and (text.count(old) + 1) * len(new) > MOST_CHARACTERS:
        raise UnsupportedError("a value grows too large")
    return text.replace(old, new, *rest)


def _joined(text: str, items: Any) -> str:
    if len(text) * len(items) > MOST_CHARACTERS:
        raise UnsupportedError("a value grows too large")
    return text.join(items)


_BINARY: Final[dict[type[ast.operator], Callable[[Any, Any], object]]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: _multiply,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: _modulo,
    ast.Pow: _power,
    ast.LShift: _shift,
    ast.RShift: operator.rshift,
    ast.BitAnd: operator.and_,
    ast.BitOr: operator.or_,
    ast.BitXor: operator.xor,
}
_UNARY: Final[dict[type[ast.unaryop], Callable[[Any], object]]] = {
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
    ast.Invert: operator.invert,
    ast.Not: operator.not_,
}
_COMPARISONS: Final[dict[type[ast.cmpop], Callable[[Any, Any], object]]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.In: lambda one, other: one in other,
    ast.NotIn: lambda one, other: one not in other,
    ast.Is: operator.is_,
    ast.IsNot: operator.is_not,
}
_MATH: Final = (
    "acos acosh asin asinh atan atan2 atanh ceil copysign cos cosh degrees exp expm1 fabs floor fmod fsum gcd hypot "
    "isclose isfinite isinf isnan log log10 log1p log2 modf pow radians remainder sin sinh sqrt tan tanh trunc"
)
_FUNCTIONS: Final[dict[str, Callable[..., Any]]] = {
    **{name: getattr(math, name) for name in _MATH.split()},
    "factorial": _factorial,
    "round": _rounded,
    **{one.__name__: one for one in (abs, all, any, bool, float, int, len, list, max, min, sorted, str, sum, tuple)},
}
_NAMES: Final[dict[str, object]] = {
    "true": True,
    "false": False,
    **{name: getattr(math, name) for name in ("e", "inf", "nan", "pi", "tau")},
}
_TEXT_METHODS: Final = (
    "capitalize count endswith find index isalpha isdigit isnumeric isspace lower lstrip rfind rsplit rstrip split "
    "startswith strip swapcase title upper"
)
_METHODS: Final[dict[str, Callable[..., Any]]] = {
    **{name: getattr(str, name) for name in _TEXT_METHODS.split()},
    "replace": _replaced,
    "join": _joined,
}


class _Evaluator:
    """Walks one expression."""

    def __init__(self, look_up: Callable[[str], object], functions: Mapping[str, Callable[..., Any]]) -> None:
        self._look_up = look_up
        self._functions = {**_FUNCTIONS, **functions}
        self._own = frozenset(functions)
        self._steps = 0
        self._depth = 0

    def value(self, node: ast.expr) -> Any:
        """Return the value of a node, which is never large."""
        self._steps += 1
        self._depth += 1
        evaluate = getattr(self, f"_{type(node).__name__.lower()}", None)
        if evaluate is None:
            raise UnsupportedError(f"{type(node).__name__} is not evaluated")
        if self._steps > _MOST_STEPS or self._depth > _MOST_DEPTH:
            raise UnsupportedError("the expression takes too long")
        try:
            result = evaluate(node)
        except _PYTHON_ERRORS as error:
            raise ExpressionError(f"{type(error).__name__}: {error}"[:200]) from None
        self._depth -= 1
        if isinstance(result, complex) or _size(result) > MOST_CHARACTERS:
            raise UnsupportedError("a value grows too large")
        return result

    def _known(self, node: ast.expr) -> Any:
        value = self.value(node)
        _require(value)
        return value

    def _truth(self, value: object) -> bool:
        if not (isinstance(value, str) and value.strip(HOLE)):
            _require(value)
        return bool(value)

    def _constant(self, node: ast.Constant) -> object:
        if node.value is not None and not isinstance(node.value, str | int | float):
            raise UnsupportedError(f"{type(node.value).__name__} is not evaluated")
        return node.value

    def _name(self, node: ast.Name) -> object:
        if node.id in _NAMES:
            return _NAMES[node.id]
        if node.id in self._functions:
            raise UnsupportedError(f"the function {node.id} is used as a value")
        return self._look_up(node.id)

    def _binop(self, node: ast.BinOp) -> object:
        left, right = self.value(node.left), self.value(node.right)
        texts = isinstance(left, str) and isinstance(right, str)
        if not (texts and isinstance(node.op, ast.Add)):
            _require(left)
            _require(right)
        compute = _BINARY.get(type(node.op))
        if compute is None:
            raise UnsupportedError(f"{type(node.op).__name__} is not evaluated")
        return compute(left, right)

    def _unaryop(self, node: ast.UnaryOp) -> object:
        if isinstance(node.op, ast.Not):
            return not self._truth(self.value(node.operand))
        return _UNARY[type(node.op)](self._known(node.operand))

    def _boolop(self, node: ast.BoolOp) -> object:
        wanted = isinstance(node.op, ast.Or)
        value: object = None
        for operand in node.values:
            value = self.value(operand)
            if self._truth(value) is wanted:
                break
        return value

    def _compare(self, node: ast.Compare) -> object:
        left = self._known(node.left)
        result: object = True
        for comparison, operand in zip(node.ops, node.comparators, strict=True):
            right = self._known(operand)
            result = _COMPARISONS[type(comparison)](left, right)
            if not result:
                break
            left = right
        return result

    def _ifexp(self, node: ast.IfExp) -> object:
        return self.value(node.body if self._truth(self.value(node.test)) else node.orelse)

    def _list(self, node: ast.List) -> list[object]:
        return [self.value(item) for item in node.elts]

    def _tuple(self, node: ast.Tuple) -> tuple[object, ...]:
        return tuple(self.value(item) for item in node.elts)

    def _subscript(self, node: ast.Subscript) -> object:
        held = self._known(node.value)
        if isinstance(node.slice, ast.Slice):
            ends = (node.slice.lower, node.slice.upper, node.slice.step)
            return held[slice(*(end and self._known(end) for end in ends))]
        return held[self._known(node.slice)]

    def _call(self, node: ast.Call) -> object:
        if node.keywords or any(isinstance(one, ast.Starred) for one in node.args):
            raise UnsupportedError("arguments by name are not evaluated")
        if isinstance(node.func, ast.Attribute):
            text = self._known(node.func.value)
            if not isinstance(text, str) or node.func.attr not in _METHODS:
                raise UnsupportedError(f"the method {node.func.attr} is not evaluated")
            return _METHODS[node.func.attr](text, *(self._known(one) for one in node.args))
        if not isinstance(node.func, ast.Name) or node.func.id not in self._functions:
            raise UnsupportedError("the function is not evaluated")
        if node.func.id == "str" and len(node.args) == 1:
            return str(self.value(node.args[0]))
        return self._functions[node.func.id](*(self._known(one) for one in node.args))


def _require(value: object) -> None:
    """Raise when a part of a value is not known."""
    if isinstance(value, str) and HOLE in value:
        raise NotKnownError
    if isinstance(value, list | tuple):
        for item in value:
            _require(item)


def _size(value: object) -> int:
    """Return how large a value is, more or less in characters; above the limit any number that is."""
    if isinstance(value, str):
        return len(value)
    if isinstance(value, int):
        return 1 + value.bit_length() // 3 if value.bit_length() <= _MOST_BITS else MOST_CHARACTERS + 1
    total = 1
    if isinstance(value, list | tuple):
        for item in value:
            total += 2 + _size(item)
            if total > MOST_CHARACTERS:
                break
    return total
