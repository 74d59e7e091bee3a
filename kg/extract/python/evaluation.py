"""Expressions in texts of launch files: `$(eval)`, `PythonExpression`, `${}` of xacro, and angles of parameter files.

All of them are Python. The Python front end lowers them, and Python's own operators, functions and methods compute
their values, within bounds. A `Dialect` has what differs between the languages.

A text with holes can be joined and formatted, and is not empty if it has a letter. Anything else that depends on an
unknown value is unknown.
"""

from __future__ import annotations

import operator
import re
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import count
from string import Formatter
from typing import TYPE_CHECKING, Any, ClassVar, Final

from kg.extract.python.operations import (
    ARRANGING,
    BINARY,
    CONSTANTS,
    FUNCTIONS,
    METHODS,
    MOST_BITS,
    MOST_ITEMS,
    MOST_TEXT,
    PADDED,
    TOO_LARGE,
    UNARY,
    ExpressionError,
    UnsupportedError,
    called,
    refuse_over,
)
from kg.lazily import lazily
from kg.symbolic import form

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from kg.symbolic.form import Expression

with lazily():
    from kg.extract.python.expressions import expression_of

__all__ = [
    "HOLE",
    "MISSING",
    "Dialect",
    "ExpressionError",
    "UnknownValueError",
    "UnsupportedError",
    "evaluate_text",
    "failure",
    "is_builtin",
]

HOLE: Final = "\ue000"
"""Stands for an unknown part of a text while texts are computed; `{}` itself may be part of a text."""
MISSING: Final = object()
"""Is given for a name that a dialect does not bind."""
_MOST_SOURCE: Final = 20_000
_DEEPEST: Final = 60
_MOST_STEPS: Final = 60_000
_SIZE_OF_A_STEP: Final = 20
_MOST_VALUES: Final = 20_000
"""So many values one value may contain."""
_MOST_PADDED: Final = 1_000
_LONGEST_SHOWN: Final = 60
_PERCENT: Final = re.compile(
    r"%(?:\((?P<key>\w*)\))?(?P<spec>[-+ #0]*\d{0,3}(?:\.\d{0,3})?)(?P<kind>[sdifFeEgGxXorac%])"
)
_SPEC: Final = re.compile(r"(?:.?[<>=^])?[-+ ]?z?#?0?\d{0,3}[,_]?(?:\.\d{1,3})?[a-zA-Z%]?", re.DOTALL)
_CONVERSIONS: Final[dict[str, Callable[[object], object]]] = {
    "": lambda value: value,
    "s": str,
    "r": repr,
    "a": ascii,
}


class UnknownValueError(Exception):
    """The value depends on something that is not known, which whoever made it unknown has reported."""


class _Unknown:
    """An unknown value; as text it is a hole."""

    def __str__(self) -> str:
        return HOLE


_UNKNOWN: Final = _Unknown()


@dataclass(frozen=True, slots=True)
class _Reference:
    """A module or a function of Python or of the dialect, by its full name."""

    path: str


def failure(source: str, error: ExpressionError | UnsupportedError) -> str:
    """Return the problems of an expression, as a message."""
    shown = source if len(source) <= _LONGEST_SHOWN else f"{source[: _LONGEST_SHOWN - 3]}..."
    return f"`{shown}` cannot be evaluated: {error}"


def _nothing(_: str) -> object:
    return MISSING


@dataclass(frozen=True, slots=True)
class Dialect:
    """What a language adds to Python. Texts and results of its functions have a `HOLE` for each unknown part.

    `names` looks a name up before all others, `arguments` after those of `math` and before those of Python; both give
    `MISSING` for a name that they do not have. `functions` are called by name, which may have dots. `modules` are the
    names of modules with what they are in Python; names of `math` can be used without it. `member` gives `value.name`
    of an object of the language's own, else `MISSING`. All may raise `UnknownValueError`.
    """

    names: Callable[[str], object] = _nothing
    arguments: Callable[[str], object] = _nothing
    functions: Mapping[str, Callable[..., object]] = field(default_factory=dict)
    modules: Mapping[str, str] = field(default_factory=lambda: {"math": "math"})
    member: Callable[[object, str], object] = lambda _, __: MISSING


def evaluate_text(source: str, dialect: Dialect) -> object:
    """Return the value of an expression; texts in it have holes for unknown parts.

    Raises:
        ExpressionError: if the text is not an expression, or Python raises an error.
        UnsupportedError: if the expression uses what is not evaluated here, or grows too large.
        UnknownValueError: if the value depends on an unknown value.
    """
    if len(source) > _MOST_SOURCE:
        raise UnsupportedError(f"the expression is longer than {_MOST_SOURCE} characters")
    evaluation = _Evaluation(dialect)
    try:
        lowered = _lowered(source.strip())
        if isinstance(lowered, form.Opaque):
            raise ExpressionError("it is not an expression")
        value = evaluation.value(lowered)
        if not evaluation.is_known(value, holes=True):
            raise UnknownValueError
    except RecursionError:
        raise UnsupportedError("the expression takes too long") from None
    return value


@lru_cache(maxsize=1024)
def _lowered(source: str) -> Expression:
    return expression_of(source)


def is_builtin(name: str) -> bool:
    """Check whether a name is that of a function of Python which is evaluated."""
    return f"builtins.{name}" in FUNCTIONS


class _Evaluation:
    """The evaluation of one expression."""

    def __init__(self, dialect: Dialect) -> None:
        self._dialect = dialect
        self._modules = {name.partition(".")[0]: name.partition(".")[0] for name in dialect.functions}
        self._modules |= dialect.modules
        self._depth = 0
        self._steps = 0

    def value(self, expression: Expression) -> object:
        """Return the value of an expression."""
        self._depth += 1
        if self._depth > _DEEPEST:
            raise UnsupportedError("the expression is nested too deeply")
        self._count()
        evaluate = self._evaluators.get(type(expression))
        if evaluate is None:
            text = getattr(expression, "text", type(expression).__name__.lower())
            raise UnsupportedError(f"`{text}` is not understood")
        value = evaluate(self, expression)
        self._depth -= 1
        return value

    # What is known, and bounds

    def is_known(self, value: object, *, holes: bool = False) -> bool:
        """Check whether a value has no unknown part; `holes` allows those of texts.

        Raises:
            UnsupportedError: if it is too large, or no value of Python.
        """
        waiting, count, characters = [value], 0, 0
        known = True
        while waiting:
            one = waiting.pop()
            count += 1
            if isinstance(one, str):
                characters += len(one)
                known = known and (holes or HOLE not in one)
            elif isinstance(one, list | tuple):
                waiting += one
            elif isinstance(one, dict):
                waiting += [*one, *one.values()]
            elif one is _UNKNOWN:
                known = False
            elif one is not None and not isinstance(one, int | float):
                raise UnsupportedError(f"a value of the type {type(one).__name__.lstrip('_').lower()} is not evaluated")
            if count > _MOST_VALUES or characters > MOST_TEXT:
                raise UnsupportedError(TOO_LARGE)
        self._count(count)
        return known

    def _is_container(self, value: object) -> bool:
        """Check whether the items of a value are at hand, known or not, or it is not a container at all."""
        complete = not isinstance(value, str) or HOLE not in value
        return complete if isinstance(value, str | list | tuple | dict) else self.is_known(value)

    def _count(self, size: int = 0) -> None:
        self._steps += 1 + size // _SIZE_OF_A_STEP
        if self._steps > _MOST_STEPS:
            raise UnsupportedError("the expression takes too long")

    def _checked(self, value: object) -> object:
        """Return a value that Python computed, if it is of a size and a type that expressions may have."""
        if isinstance(value, str):
            refuse_over(len(value))
            if "\0" in value or (not value.isascii() and any("\ud800" <= one <= "\udfff" for one in value)):
                raise UnsupportedError("a value has characters that are not text")
        elif isinstance(value, list | tuple | dict):
            refuse_over(len(value), MOST_ITEMS)
        elif isinstance(value, int):
            refuse_over(value.bit_length(), MOST_BITS)
        elif value is not None and not isinstance(value, float):
            raise UnsupportedError(f"a value of the type {type(value).__name__} is not evaluated")
        self._count(len(value) if isinstance(value, str | list | tuple | dict) else 0)
        return value

    def _applied(
        self,
        function: Callable[..., object],
        args: list[Any],
        named: Mapping[str, object] | None = None,
        *,
        shallow: bool = False,
    ) -> object:
        """Return the result of a function of Python for known values; `shallow` if items need not be known."""
        is_enough = self._is_container if shallow else self.is_known
        if not all(map(is_enough, (*args, *(named or {}).values()))):
            return _UNKNOWN
        return self._checked(called(function, args, named or {}))

    def _given(
        self, function: Callable[..., object], args: list[Any], named: Mapping[str, Any] | None = None
    ) -> object:
        """Return the result of a function of the dialect."""
        try:
            return called(function, args, named or {})
        except UnknownValueError:
            return _UNKNOWN

    @staticmethod
    def _truth(value: object) -> bool | None:
        """Return whether a value is true; None if that is not known."""
        if isinstance(value, str) and HOLE in value:
            return True if value.strip(HOLE) else None
        return None if value is _UNKNOWN else bool(value)

    # Names, literals and operators

    def _literal(self, expression: form.Literal) -> object:
        if type(expression.value) is float:
            try:
                return self._checked(int(expression.written, 0))
            except ValueError:
                return expression.value
        return self._checked(expression.value)

    def _name(self, expression: form.Name) -> object:
        name = expression.names[-1]
        value = self._given(self._dialect.names, [name])
        if value is MISSING and name in self._modules:
            return _Reference(self._modules[name])
        if value is MISSING:
            value = _referred(f"math.{name}")
        if value is MISSING:
            value = self._given(self._dialect.arguments, [name])
        if value is MISSING:
            value = _referred(f"builtins.{name}")
        if value is MISSING:
            raise ExpressionError(f"NameError: name '{name}' is not defined")
        return value

    def _member(self, expression: form.Member) -> object:
        of = self.value(expression.of)
        if isinstance(of, _Reference):
            path = f"{of.path}.{expression.name}"
            return CONSTANTS.get(path, _Reference(path))
        given = self._given(self._dialect.member, [of, expression.name])
        if given is MISSING and of is not _UNKNOWN:
            raise UnsupportedError(f"the attribute `{expression.name}` is not evaluated")
        return _UNKNOWN if given is MISSING else given

    def _unary(self, expression: form.Unary) -> object:
        operand = self.value(expression.operand)
        if expression.sign != "not":
            return self._applied(UNARY[expression.sign], [operand])
        truth = self._truth(operand)
        return _UNKNOWN if truth is None else not truth

    def _binary(self, expression: form.Binary) -> object:
        sign = expression.sign
        if sign in ("and", "or"):
            return self._either(sign == "or", expression.operands)
        result, *others = map(self.value, expression.operands)
        for other in others:
            result = self._operated(sign, result, other)
        return result

    def _either(self, ends_at: bool, operands: tuple[Expression, ...]) -> object:  # noqa: FBT001 - `or`, or `and`
        """Return `a and b`, `a or b`."""
        value: object = None
        unsure = False
        for operand in operands:
            value = self.value(operand)
            truth = self._truth(value)
            unsure = unsure or truth is None
            if truth is ends_at:
                return value if not unsure or isinstance(value, bool) else _UNKNOWN
        return _UNKNOWN if unsure else value

    def _operated(self, sign: str, left: object, right: object) -> object:
        """Return `left SIGN right`."""
        operate = BINARY.get(sign)
        if operate is None:
            raise UnsupportedError(f"the operator `{sign}` is not evaluated")
        texts = isinstance(left, str), isinstance(right, str)
        if (
            sign == "+"
            and any(texts)
            and all(one or two is _UNKNOWN for one, two in zip(texts, (left, right), strict=True))
        ):
            return self._checked(f"{left}{right}")
        if sign == "%" and isinstance(left, str):
            return self._percent(left, right)
        if sign in ("==", "!=") and any(texts) and (left is None or right is None):
            return sign == "!="
        return self._applied(operate, [left, right], shallow=sign in ("+", "|"))

    def _choice(self, expression: form.Choice) -> object:
        condition = self._truth(self.value(expression.condition))
        if condition is not None:
            return self.value(expression.then if condition else expression.otherwise)
        one, other = self.value(expression.then), self.value(expression.otherwise)
        return one if type(one) is type(other) and one == other else _UNKNOWN

    # Lists and dictionaries

    def _items(self, value: object) -> list[object] | None:
        """Return the items of an iterable; None if they are unknown."""
        if not self._is_container(value):
            return None
        items: list[object] = called(list, [value], {})
        self._count(len(items))
        return items

    def _values(self, expressions: tuple[Expression, ...]) -> list[object] | None:
        """Return the values of items or arguments; None if it is not known how many there are."""
        values: list[object] = []
        for one in expressions:
            items = self._items(self.value(one.of)) if isinstance(one, form.Spread) else [self.value(one)]
            if items is None:
                return None
            values += items
        return values

    def _display(self, expression: form.Display) -> object:
        values = self._values(expression.items)
        if values is None:
            return _UNKNOWN
        if expression.kind == "set":
            return self._applied(FUNCTIONS["builtins.set"], [values])
        return self._checked(tuple(values) if expression.kind == "tuple" else values)

    def _pairs(self, expression: form.Pairs) -> object:
        pairs = [(self.value(key), self.value(value)) for key, value in expression.items]
        if not self.is_known([key for key, _ in pairs]):
            return _UNKNOWN
        return self._checked(called(dict, [pairs], {}))

    def _index(self, expression: form.Index) -> object:
        of, key = self.value(expression.of), self.value(expression.key)
        is_known = self.is_known(key) and self._is_container(of)
        return called(operator.getitem, [of, key], {}) if is_known else _UNKNOWN

    # Calls

    def _call(self, expression: form.Call) -> object:
        written = expression.function
        of = self.value(written.of) if isinstance(written, form.Member) else None
        function = self.value(written) if not isinstance(of, str | list | tuple | dict) else None
        args = self._values(expression.arguments)
        named: dict[str, object] = {}
        for name, one in expression.keywords:
            value = self.value(one)
            if name == "**" and value is not _UNKNOWN:
                named.update(called(dict, [value], {}))
            else:
                named[name] = value
        if args is None or "**" in named or function is _UNKNOWN:
            return _UNKNOWN
        if function is None and isinstance(written, form.Member):
            return self._method(of, written.name, args, named)
        return self._invoked(function, args, named)

    def _invoked(self, function: object, args: list[Any], named: Mapping[str, Any]) -> object:
        path = function.path if isinstance(function, _Reference) else ""
        own = self._dialect.functions.get(path)
        if own is not None:
            is_known = self.is_known([*args, *named.values()])
            return self._given(own, args, named) if is_known else _UNKNOWN
        if path == "builtins.str" and len(args) == 1 and not named:
            is_text = isinstance(args[0], str) or self.is_known(args[0])
            return self._formatted(args[0], "", "") if is_text else _UNKNOWN
        if path in ("builtins.bool", "builtins.any", "builtins.all") and len(args) == 1:
            return self._decided(path, args[0])
        if path not in FUNCTIONS:
            raise UnsupportedError("the function is not evaluated")
        return self._applied(FUNCTIONS[path], args, named, shallow=path in ARRANGING)

    def _decided(self, path: str, value: object) -> object:
        """Return `bool(value)`, or `all` or `any` of its items, which one item may decide."""
        items = [value] if path == "builtins.bool" else self._items(value)
        truths = {self._truth(item) for item in items} if items is not None else {None}
        ends_at = path != "builtins.all"
        return ends_at if ends_at in truths else _UNKNOWN if None in truths else not ends_at

    def _method(self, of: object, name: str, args: list[Any], named: Mapping[str, Any]) -> object:
        """Return the result of a method of a text, list, tuple or dictionary that does not change it."""
        if name == "<slice>":
            known = self.is_known(args) and self._is_container(of)
            return called(operator.getitem, [of, slice(*args)], {}) if known else _UNKNOWN
        if isinstance(of, str) and name == "join" and len(args) == 1:
            items = self._items(args[0])
            if items is None:
                return _UNKNOWN
            texts = [HOLE if item is _UNKNOWN else item for item in items]
            refuse_over(sum(len(text) for text in texts if isinstance(text, str)) + len(of) * len(texts))
            return self._checked(called(of.join, [texts], {}))
        if isinstance(of, str) and name == "format":
            return self._braces(of, args, named) if self.is_known(of) else _UNKNOWN
        kind = type(of)
        if name not in METHODS[kind]:
            raise UnsupportedError(f"`{kind.__name__}.{name}` is not read")
        read = getattr(kind, name)
        if kind is dict:
            known = self.is_known([*args, *named.values()])
            result: Any = called(read, [of, *args], named) if known else _UNKNOWN
            return list(result) if known and name in ("items", "keys", "values") else result
        if (
            name == "replace"
            and isinstance(of, str)
            and len(args) > 1
            and all(isinstance(one, str) for one in args[:2])
        ):
            refuse_over(len(of) + of.count(args[0]) * len(args[1]))
        elif name in PADDED and args and isinstance(args[0], int):
            refuse_over(args[0], _MOST_PADDED)
        return self._applied(read, [of, *args], named)

    # Formats

    def _formatted(self, value: object, spec: str, conversion: str) -> str:
        """Return the text of a replacement field for a value."""
        if isinstance(value, str | _Unknown) and not spec and conversion in ("", "s"):
            return str(value)
        if not self.is_known(value):
            return HOLE
        if not _SPEC.fullmatch(spec):
            raise UnsupportedError("the format of a text is not evaluated")
        return str(self._checked(called(format, [_CONVERSIONS[conversion](value), spec], {})))

    def _braces(self, template: str, args: list[Any], named: Mapping[str, Any]) -> object:
        """Return `template.format(*args, **named)`."""
        automatic = count()
        text = ""
        for literal, name, spec, conversion in called(lambda: list(Formatter().parse(template)), [], {}):
            text += literal
            if name is None:
                continue
            if not re.fullmatch(r"\w*", name) or "{" in spec or (conversion or "") not in _CONVERSIONS:
                raise UnsupportedError("the format of a text is not evaluated")
            key = name or str(next(automatic))
            given = args if key.isdecimal() else named
            value = called(operator.getitem, [given, int(key) if key.isdecimal() else key], {})
            text += self._formatted(value, spec, conversion or "")
            refuse_over(len(text))
        return self._checked(text)

    def _percent(self, template: str, operand: object) -> object:
        """Return `template % operand`."""
        if HOLE in template:
            return _UNKNOWN
        if "%" in _PERCENT.sub("", template):
            raise UnsupportedError("the format of a text is not evaluated")
        if not self.is_known(operand):
            return _UNKNOWN
        values = operand if isinstance(operand, tuple) else (operand,)
        given = operand.values() if isinstance(operand, dict) else values
        longest = max((len(str(value)) for value in given), default=0)
        refuse_over(len(template) + (1 + longest) * template.count("%"))
        return self._checked(called(operator.mod, [template, operand], {}))

    _evaluators: ClassVar[dict[type, Callable[..., object]]] = {
        form.Literal: _literal,
        form.Name: _name,
        form.Member: _member,
        form.Call: _call,
        form.Unary: _unary,
        form.Binary: _binary,
        form.Choice: _choice,
        form.Index: _index,
        form.Display: _display,
        form.Pairs: _pairs,
    }


def _referred(path: str) -> object:
    supported = path in FUNCTIONS or path in CONSTANTS
    return CONSTANTS.get(path, _Reference(path)) if supported else MISSING
