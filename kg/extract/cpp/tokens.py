"""Functions of C++ that take texts apart or change them in place: `>>`, `std::getline`, `boost::split`, `replace`."""

from __future__ import annotations

import re
import string
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final

from kg.symbolic.binding import put
from kg.symbolic.containers import elements, is_finite, part_of
from kg.symbolic.form import Call, Member, Name
from kg.symbolic.letters import mapped
from kg.symbolic.operators import compute
from kg.symbolic.parameters import with_parameter
from kg.symbolic.state import Arguments
from kg.symbolic.values import Object, Sequence, Text, Truth, Unknown, Value, over

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.cpp.language import Cpp
    from kg.symbolic.form import Expression
    from kg.symbolic.state import Frame

STREAMS: Final = frozenset({"stringstream", "istringstream", "ostringstream", "basic_stringstream"})
_READ: Final = "it is read when the program runs"
_SPACE: Final = r"\s+"


def call(language: Cpp, names: tuple[str, ...], given: Arguments) -> Value | None:
    """Return the result of a function that takes texts apart; None for other functions."""
    name, values = names[-1], given.values
    if name == "operator>>" and len(values) > 1:
        stream = values[0]
        if not isinstance(stream, Object | Unknown):
            return compute(">>", tuple(values))
        for target in given.written[1:]:
            stream = _next(language, stream, target, _SPACE, given)
        return stream
    if name == "getline" and len(values) > 1:
        return _next(language, values[0], given.written[1], _separator(values[2:]) or "\n", given)
    if name == "split" and names[0] in ("boost", "algorithm") and values[2:] and given.frame is not None:
        pieces = _pieces(values[1], _separator(values[2:]))
        put(language.machine, given.written[0], pieces, given.frame)
        return pieces
    if name == "transform" and values and given.frame is not None:
        return _transformed(language, given, given.frame)
    if name == "is_any_of" and values:
        return values[0]
    if name in _TESTS and len(values) == 1:
        return over((values[0],), _TESTS[name])
    return _changed(language, names, given) if name in _CHANGES else None


def _changed(language: Cpp, names: tuple[str, ...], given: Arguments) -> Value | None:
    """Change the text in the first argument, or whose characters the first two span; None for other functions."""
    first, frame = given.written[0], given.frame
    spanned = _spanned(first)
    if frame is None or not (spanned is not None or names[0] in ("boost", "algorithm")):
        return None
    target = first if spanned is None else spanned
    texts = [one.exact for one in given.values[1 if spanned is None else 2 :] if isinstance(one, Text)]
    known = [one for one in texts if one is not None]
    count, change = _CHANGES[names[-1]]

    def changed(value: Value) -> Value:
        if not isinstance(value, Text):
            return value
        if len(known) != count:
            return Text.hole("it is changed when the program runs")
        return replace(value, parts=tuple(change(one, *known) if isinstance(one, str) else one for one in value.parts))

    put(language.machine, target, over((language.machine.value(target, frame),), changed), frame)
    return Unknown("it returns nothing")


_BEGINNINGS: Final = ("begin", "cbegin")
_ONE_RANGE: Final = 4
"""How many arguments `std::transform` has that reads one range."""
CASES: Final[dict[str, Callable[[str], str]]] = {
    **dict.fromkeys(("to_lower_copy", "tolower"), str.lower),
    **dict.fromkeys(("to_upper_copy", "toupper"), str.upper),
}
"""Functions that return a text in small or capital letters."""


def _tested(one: Value, test: Callable[[str], bool]) -> Value:
    exact = one.exact if isinstance(one, Text) and one.parameter is None and not one.unsure else None
    return Truth(exact.isascii() and test(exact)) if exact else Unknown("the letter is not known")


_TESTS: Final[dict[str, Callable[[Value], Value]]] = {
    "isupper": partial(_tested, test=str.isupper),
    "islower": partial(_tested, test=str.islower),
    "isalpha": partial(_tested, test=str.isalpha),
    "isdigit": partial(_tested, test=str.isdigit),
    "isalnum": partial(_tested, test=str.isalnum),
    "isspace": partial(_tested, test=str.isspace),
    "ispunct": partial(_tested, test=lambda letter: letter in string.punctuation),
}
"""Functions of C that test a letter."""
_CHANGES: Final[dict[str, tuple[int, Callable[..., str]]]] = {
    "replace": (2, str.replace),
    "replace_all": (2, str.replace),
    "replace_first": (2, lambda text, old, new: text.replace(old, new, 1)),
    "erase_all": (1, lambda text, old: text.replace(old, "")),
    "erase_first": (1, lambda text, old: text.replace(old, "", 1)),
    "to_lower": (0, str.lower),
    "to_upper": (0, str.upper),
    "trim": (0, str.strip),
}
"""Functions that change a text in place: how many other texts they get, and what they make of all."""


def _transformed(language: Cpp, given: Arguments, frame: Frame) -> Value:
    """Call a function with each element of a range, and write the results to a container or a text."""
    function, written, machine = given.values[-1], given.written, language.machine
    named = CASES.get(written[-1].names[-1]) if isinstance(written[-1], Name) else None

    def change(one: Value) -> Value:
        if named is not None and isinstance(one, Text) and one.exact is not None:
            return Text.of(named(one.exact))
        return language.calls.value(function, Arguments([one], frame=frame))

    def changed(of: Value) -> Value:
        if isinstance(of, Text):
            return mapped(of, change)
        results = tuple(change(one) for one in elements(of))
        return Sequence(results) if is_finite(of) else Unknown(_READ)

    range_of, target = _spanned(written[0]), _spanned(written[2]) if len(written) == _ONE_RANGE else None
    result = over((machine.value(range_of or written[0], frame),), changed)
    if target is not None:
        put(machine, target, result, frame)
    elif isinstance(added := written[2] if len(written) == _ONE_RANGE else None, Call) and added.arguments:
        before = machine.value(added.arguments[0], frame)
        put(machine, added.arguments[0], over((before, result), lambda *row: compute("+", row)), frame)
    return Unknown("it returns the end of what it wrote")


def _spanned(expression: Expression) -> Expression | None:
    """Return the container or text of which an expression is the begin; None for others."""
    if isinstance(expression, Call) and isinstance(expression.function, Member):
        return expression.function.of if expression.function.name in _BEGINNINGS else None
    if isinstance(expression, Call) and isinstance(expression.function, Name) and len(expression.arguments) == 1:
        return expression.arguments[0] if expression.function.names[-1] in _BEGINNINGS else None
    return None


def _next(language: Cpp, stream: Value, target: Expression, separator: str, given: Arguments) -> Value:
    """Move the next piece of a stream to a variable; return the stream, or false at its end."""
    machine, frame = language.machine, given.frame
    if frame is None or (isinstance(stream, Truth) and not stream.value):
        return stream
    text = stream.native.get("text") if isinstance(stream, Object) and stream.kind.name in STREAMS else None
    parameter = text.parameter if isinstance(text, Text) else None
    if not isinstance(stream, Object) or not isinstance(text, Text) or text.exact is None:
        read = part_of(f"{parameter}[]") if parameter is not None else Text.hole(_READ)
        put(machine, target, read, frame)
        return Unknown(_READ)
    if not text.exact.strip():
        if parameter is None or "taken" in stream.native:
            return Truth(False)
        # The default is empty, and what a launch file sets is not.
        put(machine, target, part_of(f"{parameter}[]"), frame)
        return Unknown("it depends on a parameter", parameter)
    piece, *rest = re.split(separator, text.exact.lstrip() if separator == _SPACE else text.exact, maxsplit=1)
    put(machine, target, _part(text, piece), frame)
    machine.write(stream.native, "text", replace(text, parts=tuple(rest)))
    machine.write(stream.native, "taken", Truth(True))
    return stream


def _pieces(text: Value, separator: str | None) -> Value:
    if not isinstance(text, Text) or text.exact is None or separator is None:
        parameter = text.parameter if isinstance(text, Text | Unknown) else None
        return Unknown(_READ, parameter)
    pieces = [piece for piece in re.split(separator, text.exact) if piece]
    return Sequence(tuple(_part(text, piece) for piece in pieces), parameter=text.parameter)


def _part(whole: Text, piece: str) -> Value:
    part = Text((piece,), whole.resolution)
    return part if whole.parameter is None else with_parameter(part, f"{whole.parameter}[]")


def _separator(values: list[Value]) -> str | None:
    """Return the pattern of the characters that separate pieces; None if they are not known."""
    exact = values[0].exact if values and isinstance(values[0], Text) else None
    return f"[{re.escape(exact)}]" if exact else None
