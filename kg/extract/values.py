"""What an expression of a program can be at run time, as far as it can be known without running it.

The evaluators of C++ and Python share this algebra. An expression evaluates to a few alternatives
(`kg.extract.cpp` and `kg.extract.python` say how they are kept apart); each is one `Value`:

* `Text`: a string; parts that are not known are `HOLE`s, so `"camera/" + x` is `camera/{}`.
* `Number`, `Truth`: other literals that matter (queue depths, defaults of parameters).
* `Sequence` and `Mapping`: literal lists and dictionaries, for loops over them.
* `Handle`: a node or node handle, with the namespace that it puts before names.
* `Unknown`: anything else, with the reason, which ends in the fact that could not be resolved.

What is not known stays a hole or an `Unknown`. An evaluator that misses an alternative says nothing of it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final, TypeAlias

from kg.facts import Resolution

__all__ = [
    "COMMAND_LINE",
    "HOLE",
    "OWN_NAMESPACE",
    "Handle",
    "Mapping",
    "Number",
    "Sequence",
    "Text",
    "Truth",
    "Unknown",
    "Value",
    "argument_at",
    "concatenate",
    "in_own_namespace",
    "is_whole_parameter",
    "keys_of_parameter",
    "part_of_parameter",
    "worse",
]

HOLE: Final = None
"""A part of a text that is not known."""

OWN_NAMESPACE: Final = "."
"""What a text begins with that the node's namespace stands in front of; no name of ROS can begin so."""

_ORDER: Final = tuple(Resolution)


@dataclass(frozen=True, slots=True)
class Text:
    """A string; `parts` alternate freely between known text and `HOLE`.

    `parameter` names the parameter whose default this is, as the code asks for it (`~/scan_topic`).
    """

    parts: tuple[str | None, ...]
    resolution: Resolution = Resolution.LITERAL
    parameter: str | None = None
    reason: str | None = None

    @classmethod
    def of(cls, text: str, resolution: Resolution = Resolution.LITERAL, parameter: str | None = None) -> Text:
        """Return the text whose every character is known."""
        return cls((text,), resolution, parameter)

    @property
    def known(self) -> str | None:
        """The string if there is no hole in it."""
        return None if HOLE in self.parts else "".join(part for part in self.parts if part is not None)

    @property
    def pattern(self) -> str | None:
        """The string with `{}` for each hole; None when nothing but slashes is known."""
        if not any(part and part.strip("/~.") for part in self.parts):
            return self.known if HOLE not in self.parts else None
        return "".join("{}" if part is None else part for part in self.parts)

    def through_constant(self) -> Text:
        """Return the same text as read from a variable rather than written in place."""
        return replace(self, resolution=worse(self.resolution, Resolution.CONSTANT))


@dataclass(frozen=True, slots=True)
class Number:
    """A number as written, so that defaults of parameters keep their form."""

    value: float
    written: str


@dataclass(frozen=True, slots=True)
class Truth:
    """A boolean."""

    value: bool


@dataclass(frozen=True, slots=True)
class Sequence:
    """A list, tuple, array or initialiser list whose elements are known."""

    items: tuple[Value, ...]


@dataclass(frozen=True, slots=True)
class Mapping:
    """A dictionary or map whose keys are known."""

    items: tuple[tuple[Value, Value], ...]


@dataclass(frozen=True, slots=True)
class Handle:
    """A node or node handle: `namespace` is what it puts before relative names (``, `camera`, `~`, `~/sub`, `/abs`)."""

    namespace: Text = Text(("",))
    node_name: Text | None = None


@dataclass(frozen=True, slots=True)
class Unknown:
    """A value that cannot be known; `reason` completes the sentence "the name is not known because ..."."""

    reason: str


Value: TypeAlias = "Text | Number | Truth | Sequence | Mapping | Handle | Unknown"


COMMAND_LINE: Final = Text((HOLE,), Resolution.LAUNCH_ARGUMENT, reason="the whole command line gives it")
"""The arguments of the program, the program itself first."""


def argument_at(index: object) -> Text:
    """Return one of the arguments of the program: `argv[1]` stands for its parameter."""
    if not isinstance(index, Number) or index.value < 1:
        return replace(COMMAND_LINE, reason="it is given on the command line")
    name = f"argv[{int(index.value)}]"
    return replace(COMMAND_LINE, parameter=name, reason=f"it is the argument {name} of the command line")


def part_of_parameter(whole: Text, key: Value) -> Text:
    """Return an element of a list, or a member of a struct, that is the value of a parameter without default.

    `~/topics[]` is an element of the list `~/topics`, whichever; `~/topics[].name` its member. Of a dictionary it is
    what one of its keys stands for.
    """
    member = key.known if isinstance(key, Text) else None
    return _part(whole, f".{member}" if member is not None else "[]")


def keys_of_parameter(whole: Text) -> Text:
    """Return a key of a dictionary that is the value of a parameter without default: `~/topics[key]`."""
    return _part(whole, "[key]")


def is_whole_parameter(value: object) -> bool:
    """Tell whether a value is that of a parameter without default, or of a part of one, with nothing joined to it."""
    named = isinstance(value, Text) and value.parts == (HOLE,) and value.parameter is not None
    return named and isinstance(value, Text) and value.resolution is not Resolution.LAUNCH_ARGUMENT


def _part(whole: Text, which: str) -> Text:
    name = f"{whole.parameter}{which}"
    return replace(whole, parameter=name, reason=f"it is part of a parameter: {name}")


def in_own_namespace(pattern: str) -> str | None:
    """Return the relative name that a name with the node's namespace in front is; None where that is not in front."""
    return pattern[1:].lstrip("/") if pattern.startswith(OWN_NAMESPACE) else None


def worse(one: Resolution, other: Resolution) -> Resolution:
    """Return the less certain of two resolutions."""
    return max(one, other, key=_ORDER.index)


def concatenate(*values: Value) -> Text:
    """Return the text of all values in a row; what is not known becomes a hole."""
    parts: list[str | None] = []
    resolution, parameter, reason = Resolution.LITERAL, None, None
    for value in values:
        piece = value if isinstance(value, Text) else _as_text(value)
        resolution = worse(resolution, piece.resolution)
        parameter = parameter or piece.parameter
        reason = reason or piece.reason
        for part in piece.parts:
            if part is not None and parts and parts[-1] is not None:
                parts[-1] += part
            elif part is not None or not parts or parts[-1] is not None:
                parts.append(part)
    return Text(tuple(parts), resolution, parameter, reason)


def _as_text(value: Value) -> Text:
    if isinstance(value, Number):
        return Text((value.written,))
    reason = value.reason if isinstance(value, Unknown) else None
    return Text((HOLE,), Resolution.PARTIAL, reason=reason)
