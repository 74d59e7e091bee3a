"""Values that are wholly known: Python's own operations compute with them, within bounds."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from kg.extract.launch.expressions.values import Items, Table

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from kg.extract.launch.expressions.values import Condition, Value

__all__ = [
    "MAX_BITS",
    "MAX_ITEMS",
    "MAX_TEXT",
    "ExpressionError",
    "UnsupportedError",
    "apply",
    "called",
    "encodable",
    "is_whole",
    "refuse_over",
]

MAX_ITEMS: Final = 5_000
"""So many items a list may have."""
MAX_TEXT: Final = 200_000
"""So many characters a text may have that operations make."""
MAX_BITS: Final = 8_192
"""So many bits an integer may have."""
_MAX_SIZE: Final = 20_000
"""So many values one value may contain."""
_PYTHON_ERRORS: Final = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError)


class ExpressionError(Exception):
    """Python raises an error when it evaluates the expression."""


class UnsupportedError(Exception):
    """The expression uses what is not evaluated here, or its values grow too large."""


def is_whole(value: Value) -> bool:
    """Tell whether a value is one of Python that is wholly known.

    Raises:
        UnsupportedError: if it is too large to compute with.
    """
    waiting: list[Value] = [value]
    count = characters = 0
    while waiting:
        one = waiting.pop()
        count += 1
        if isinstance(one, str):
            characters += len(one)
        elif isinstance(one, Items | tuple):
            waiting.extend(one)
        elif isinstance(one, Table):
            if one.rest is not None:
                return False
            waiting += [*one, *one.values()]
        elif one is not None and not isinstance(one, int | float):
            return False
        if count > _MAX_SIZE or characters > MAX_TEXT:
            raise UnsupportedError("a value grows too large")
    return True


def apply(
    function: Callable[..., Any],
    args: Sequence[Value],
    kwargs: Mapping[str, Value] | None = None,
    guards: tuple[Condition, ...] = (),
) -> Value:
    """Return what a function of Python gives for whole values; lists in it are made under `guards`.

    Raises:
        ExpressionError: if the function raises an error.
        UnsupportedError: if the result is too large, or of a type that is not evaluated.
    """
    return _taken(called(function, args, kwargs or {}), guards)


def called(function: Callable[..., Any], args: Sequence[Value], kwargs: Mapping[str, Value]) -> object:
    """Return what a function gives; `ExpressionError` for an error of Python's own that it raises."""
    try:
        return function(*args, **kwargs)
    except _PYTHON_ERRORS as error:
        raise ExpressionError(f"{type(error).__name__}: {error}"[:200]) from None


def _taken(found: object, guards: tuple[Condition, ...]) -> Value:
    """Return a result of Python as a value."""
    if isinstance(found, Items | Table) or found is None:
        return found
    if isinstance(found, str):
        refuse_over(len(found))
        return encodable(found)
    if isinstance(found, int | float):
        if isinstance(found, int) and found.bit_length() > MAX_BITS:
            raise UnsupportedError("a number grows too large")
        return found
    if isinstance(found, list):
        refuse_over(len(found), MAX_ITEMS)
        return Items((_taken(item, guards) for item in found), guards)
    if isinstance(found, tuple):
        return tuple(_taken(item, guards) for item in found)
    raise UnsupportedError(f"a value of the type {type(found).__name__} is not evaluated")


def encodable(text: str) -> str:
    """Return a text; `UnsupportedError` for one that no file can have: with a zero byte, or half of a character."""
    if "\0" in text or (not text.isascii() and any("\ud800" <= one <= "\udfff" for one in text)):
        raise UnsupportedError("a value has characters that are no text")
    return text


def refuse_over(size: int, most: int = MAX_TEXT) -> None:
    """Raise `UnsupportedError` where a value grows larger than a value may."""
    if size > most:
        raise UnsupportedError("a value grows too large")
