"""Reading a stream or splitting a text in C++, piece by piece: `>>`, `std::getline`, `boost::split`."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.symbolic.binding import put
from kg.symbolic.containers import part_of
from kg.symbolic.operators import compute
from kg.symbolic.parameters import with_parameter
from kg.symbolic.values import Object, Sequence, Text, Truth, Unknown, Value

if TYPE_CHECKING:
    from kg.extract.cpp.language import Cpp
    from kg.symbolic.form import Expression
    from kg.symbolic.state import Arguments

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
    if name == "is_any_of" and values:
        return values[0]
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
