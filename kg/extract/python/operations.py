"""What expressions in launch files have of Python: operators, functions and methods, each within bounds."""

from __future__ import annotations

import math
import operator
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

MOST_ITEMS: Final = 5_000
MOST_TEXT: Final = 200_000
MOST_BITS: Final = 8_192
_MOST_DIGITS: Final = 400
_MOST_FACTORIAL: Final = 500
TOO_LARGE: Final = "a value grows too large"
_PYTHON_ERRORS: Final = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError)


class ExpressionError(Exception):
    """Python raises an error when it evaluates the expression."""


class UnsupportedError(Exception):
    """The expression uses what is not evaluated here, or its values grow too large."""


def called(function: Callable[..., Any], args: list[Any], named: Mapping[str, Any]) -> Any:
    """Return what a function gives; `ExpressionError` for an error of Python's own that it raises."""
    try:
        return function(*args, **named)
    except _PYTHON_ERRORS as error:
        raise ExpressionError(f"{type(error).__name__}: {error}"[:200]) from None


def refuse_over(size: int, most: int = MOST_TEXT) -> None:
    """Raise `UnsupportedError` for a value that is too large."""
    if size > most:
        raise UnsupportedError(TOO_LARGE)


def _multiply(left: Any, right: Any) -> object:
    for one, times in ((left, right), (right, left)):
        if isinstance(one, str | list | tuple) and isinstance(times, int):
            refuse_over(len(one) * times, MOST_TEXT if isinstance(one, str) else MOST_ITEMS)
    return left * right


def _power(left: Any, right: Any) -> object:
    if isinstance(left, int) and isinstance(right, int):
        refuse_over(left.bit_length() * abs(right), MOST_BITS)
    return left**right


def _shift(left: Any, right: Any) -> object:
    if isinstance(right, int):
        refuse_over(right, MOST_BITS)
    return left << right


def _rounded(number: Any, ndigits: Any = None) -> object:
    if isinstance(ndigits, int):
        refuse_over(abs(ndigits), _MOST_DIGITS)
    return round(number, ndigits)


def _factorial(number: Any) -> int:
    if isinstance(number, int):
        refuse_over(number, _MOST_FACTORIAL)
    return math.factorial(number)


def _range(*bounds: Any) -> list[int]:
    numbers = range(*bounds)
    return list(numbers[: MOST_ITEMS + 1])


def _distinct(items: Any = ()) -> list[object]:
    """Return a set as a list in the order of its items."""
    return list(dict.fromkeys(items))


def _listed(make: Callable[..., Any]) -> Callable[..., list[object]]:
    return lambda *args, **named: list(make(*args, **named))


BINARY: Final[dict[str, Callable[[Any, Any], object]]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": _multiply,
    "true/": operator.truediv,
    "//": operator.floordiv,
    "%": operator.mod,
    "**": _power,
    "<<": _shift,
    ">>": operator.rshift,
    "&": operator.and_,
    "|": operator.or_,
    "^": operator.xor,
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "in": lambda left, right: left in right,
}
UNARY: Final[dict[str, Callable[[Any], object]]] = {"+": operator.pos, "-": operator.neg, "~": operator.invert}
PADDED: Final = ("center", "ljust", "rjust", "zfill")
_TEXT_METHODS: Final = frozenset(
    {
        *PADDED, "capitalize", "casefold", "count", "endswith", "find", "index", "isalnum", "isalpha", "isascii",
        "isdecimal", "isdigit", "isidentifier", "islower", "isnumeric", "isspace", "istitle", "isupper", "lower",
        "lstrip", "partition", "removeprefix", "removesuffix", "replace", "rfind", "rindex", "rpartition", "rsplit",
        "rstrip", "split", "splitlines", "startswith", "strip", "swapcase", "title", "upper",
    }
)  # fmt: skip
METHODS: Final[dict[type, frozenset[str]]] = {
    str: _TEXT_METHODS,
    list: frozenset({"copy", "count", "index"}),
    tuple: frozenset({"count", "index"}),
    dict: frozenset({"copy", "get", "items", "keys", "values"}),
}
_UNBOUNDED: Final = {"comb", "dist", "fma", "lcm", "nextafter", "perm", "prod", "sumprod"}
"""Functions of `math` whose cost is not bounded by the size of their arguments, or that no launch file needs."""
CONSTANTS: Final[dict[str, object]] = {f"math.{name}": getattr(math, name) for name in ("e", "inf", "nan", "pi", "tau")}
_ARRANGED: Final[dict[str, Callable[..., object]]] = {
    "builtins.dict": dict,
    "builtins.enumerate": _listed(enumerate),
    "builtins.iter": list,
    "builtins.len": len,
    "builtins.list": list,
    "builtins.reversed": _listed(reversed),
    "builtins.tuple": tuple,
    "builtins.zip": _listed(zip),
}
ARRANGING: Final = frozenset(_ARRANGED)
"""Functions that only arrange items, which need not be known."""
FUNCTIONS: Final[dict[str, Callable[..., object]]] = {
    **{
        f"builtins.{function.__name__}": function
        for function in (abs, ascii, bin, chr, divmod, float, hex, int, max, min, oct, ord, repr, sorted, str, sum)
    },
    **{
        f"math.{name}": getattr(math, name)
        for name in dir(math)
        if name not in _UNBOUNDED and callable(getattr(math, name)) and not name.startswith("_")
    },
    **_ARRANGED,
    "math.factorial": _factorial,
    "builtins.round": _rounded,
    "builtins.range": _range,
    **dict.fromkeys(("builtins.set", "builtins.frozenset"), _distinct),
    **dict.fromkeys(("builtins.all", "builtins.any", "builtins.bool"), bool),
    **dict.fromkeys(("builtins.map", "builtins.filter"), _listed(map)),
}
"""Functions by their full names."""
