"""Expressions that are texts: `$(eval ...)` of XML and YAML, `PythonExpression`, and `${...}` of xacro.

A `Dialect` has what differs between these languages. All else is the evaluator's: an expression of a dialect is one of
Python, without functions of its own.
"""

from __future__ import annotations

import ast
import warnings
from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Final

from kg.corpus.files import FilePath
from kg.extract.launch.expressions.call import Call
from kg.extract.launch.expressions.containers import Halt
from kg.extract.launch.expressions.evaluate import Evaluator
from kg.extract.launch.expressions.functions import CONSTANTS, FUNCTIONS, is_builtin
from kg.extract.launch.expressions.methods import method
from kg.extract.launch.expressions.texts import reason_of, words
from kg.extract.launch.expressions.values import (
    Choice,
    Frame,
    Items,
    Library,
    Method,
    Module,
    Scope,
    Table,
    Unknown,
    Words,
)
from kg.extract.launch.expressions.whole import ExpressionError, UnsupportedError, called, is_whole
from kg.facts import Location

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from kg.extract.launch.expressions.values import Value

__all__ = ["MISSING", "Dialect", "ExpressionError", "NotKnownError", "UnsupportedError", "evaluate_text", "failure"]

_MAX_SOURCE: Final = 20_000
_MAX_DEPTH: Final = 60
_MAX_SHOWN: Final = 60
_REASON: Final = "it is not known"
_NOWHERE: Final = Location("", 1)
_MODULE: Final = Module(FilePath("", ""), "")
MISSING: Final = object()
"""Is given for a name that a dialect does not bind."""


class NotKnownError(Exception):
    """The value depends on something that is not known, which whoever made it unknown has reported."""


def failure(source: str, error: ExpressionError | UnsupportedError) -> str:
    """Return what is wrong with an expression, as a message."""
    shown = source if len(source) <= _MAX_SHOWN else f"{source[: _MAX_SHOWN - 3]}..."
    return f"`{shown}` cannot be evaluated: {error}"


def _nothing(_: str) -> object:
    return MISSING


@dataclass(frozen=True, slots=True)
class Dialect:
    """What a language adds to Python. Texts and results of its functions have `hole` for parts that are not known.

    `names` looks a name up before all others, `arguments` after those of `math` and before those of Python; both give
    `MISSING` for a name that they do not have. `functions` are called by name, which may have dots. `modules` are the
    names of modules with what they are in Python; names of `math` can be used without it. `member` gives `value.name`
    of an object of the language's own, else `MISSING`. All may raise `NotKnownError`.
    """

    hole: str
    names: Callable[[str], object] = _nothing
    arguments: Callable[[str], object] = _nothing
    functions: Mapping[str, Callable[..., object]] = field(default_factory=dict)
    modules: Mapping[str, str] = field(default_factory=lambda: {"math": "math"})
    member: Callable[[object, str], object] = lambda _, __: MISSING


def evaluate_text(source: str, dialect: Dialect) -> object:
    """Return the value of an expression; texts in it have holes for parts that are not known.

    Raises:
        ExpressionError: if the text is no expression, or Python raises an error.
        UnsupportedError: if the expression uses what is not evaluated here, or grows too large.
        NotKnownError: if the value depends on what is not known.
    """
    if len(source) > _MAX_SOURCE:
        raise UnsupportedError(f"the expression is longer than {_MAX_SOURCE} characters")
    evaluator = _TextEvaluator(dialect)
    try:
        value = evaluator.evaluate(_parsed(source), Frame(_MODULE, Scope()))
        return evaluator.result(value)
    except (Halt, RecursionError):
        raise UnsupportedError("the expression takes too long") from None


@lru_cache(maxsize=1024)
def _parsed(source: str) -> ast.expr:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about escapes, which are the launch file's own
            return ast.parse(source.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise ExpressionError(getattr(error, "msg", None) or "the expression cannot be parsed") from None


class _TextEvaluator(Evaluator):
    """The evaluator at work on one text; an error of Python ends it."""

    def __init__(self, dialect: Dialect) -> None:
        super().__init__()
        self._dialect = dialect
        self._modules = {name.partition(".")[0]: name.partition(".")[0] for name in dialect.functions}
        self._modules |= dialect.modules
        self._reported = False
        self._depth = 0

    def failed(self, error: ExpressionError | UnsupportedError) -> Value:
        raise error

    def evaluate(self, node: ast.expr, frame: Frame) -> Value:
        self._depth += 1
        if self._depth > _MAX_DEPTH:
            raise UnsupportedError("the expression is nested too deeply")
        value = super().evaluate(node, frame)
        self._depth -= 1
        return value

    def location(self, node: ast.AST, frame: Frame) -> Location:
        del node, frame
        return _NOWHERE

    def unresolved(self, reason: str, location: Location, subject: str | None = None) -> Unknown:
        del location, subject
        return Unknown(reason)

    def made(self, table: Table) -> Value:
        raise UnsupportedError(f"an entry of a {type(table).__name__.lower()} is not evaluated")

    def unbound(self, name: str) -> Value:
        given = self._given(self._dialect.names, name)
        if given is not MISSING:
            return given
        if name in self._modules:
            return Library(self._modules[name])
        path = f"math.{name}"
        if path in FUNCTIONS or path in CONSTANTS:
            return CONSTANTS.get(path, Library(path))
        given = self._given(self._dialect.arguments, name)
        if given is not MISSING:
            return given
        if is_builtin(name):
            return Library(f"builtins.{name}")
        raise ExpressionError(f"NameError: name '{name}' is not defined")

    def attribute(self, receiver: Value, name: str) -> Value:
        if isinstance(receiver, Library):
            path = f"{receiver.path}.{name}"
            return CONSTANTS.get(path, Library(path))
        given = self._given(self._dialect.member, receiver, name)
        if given is not MISSING:
            return given
        if isinstance(receiver, str | Words | Items | Table | tuple):
            return Method(receiver, name)
        if isinstance(receiver, Unknown | Choice):
            return receiver
        raise UnsupportedError(f"the attribute `{name}` is not evaluated")

    def invoke(
        self, function: Value, args: Sequence[Value], kwargs: Mapping[str, Value], node: ast.expr, frame: Frame
    ) -> Value:
        path = function.path if isinstance(function, Library) else ""
        call = Call(self, path, node, frame, list(args), dict(kwargs))
        if isinstance(function, Method) and isinstance(function.receiver, str | Words | Items | Table | tuple):
            return method(call, function.receiver, function.name)
        if isinstance(function, Unknown | Choice):
            return Unknown(function.reason)
        own = self._dialect.functions.get(path)
        if own is not None:
            unknown = next((value for value in (*args, *kwargs.values()) if not is_whole(value)), MISSING)
            return self._given(own, *args, **kwargs) if unknown is MISSING else Unknown(reason_of(unknown))
        known = FUNCTIONS.get(path)
        if known is None:
            raise UnsupportedError("the function is not evaluated")
        return known(call)

    def _given(self, function: Callable[..., object], *args: Value, **kwargs: Value) -> Value:
        """Return what a function of the dialect gives."""
        try:
            return self._taken(called(function, args, kwargs))
        except NotKnownError:
            self._reported = True
            return Unknown(_REASON)

    def _taken(self, given: Any) -> Value:
        """Return a value of the dialect as one of the evaluator."""
        if isinstance(given, str) and self._dialect.hole in given:
            self._reported = True
            return words(given, _REASON, self._dialect.hole)
        if isinstance(given, list):
            return self.items(map(self._taken, given))
        if isinstance(given, dict):
            table = self.table()
            for key, value in given.items():
                table.put(key, self._taken(value), None)
            return table
        return given

    def result(self, value: Value) -> object:
        """Return a value as one of the dialect: texts with holes, lists and dictionaries of Python."""
        self.step()
        if isinstance(value, Items):
            return [self.result(item) for item in value]
        if isinstance(value, tuple):
            return tuple(self.result(item) for item in value)
        if isinstance(value, Table) and value.rest is None:
            return {key: self.result(item) for key, item in value.items()}
        if isinstance(value, Words) and self._reported:
            return "".join(part if isinstance(part, str) else self._dialect.hole for part in value.parts)
        if isinstance(value, Choice):
            options = [self.result(option) for _, option in value.options]
            if all(type(one) is type(options[0]) and one == options[0] for one in options):
                return options[0]
        elif is_whole(value):
            return value
        if self._reported:
            raise NotKnownError
        raise UnsupportedError(reason_of(value))
