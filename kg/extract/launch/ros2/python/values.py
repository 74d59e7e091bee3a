"""What launch files add to the values of the interpreter: objects of launch, substitutions in texts, and conditions.

An alternative carries the conditions that lead to it: `Fork`s in the ways of `Either`. An `Either` of one alternative
is there only under its conditions.
"""

from __future__ import annotations

import ast
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from kg.extract.launch.ros2.texts import Condition, Substitution, join, unknown_text
from kg.holes import Hole
from kg.symbolic import form
from kg.symbolic.operators import NULL, plain
from kg.symbolic.spelling import spelled
from kg.symbolic.values import (
    Either,
    Mapping,
    Number,
    Object,
    Sequence,
    Text,
    Truth,
    Unknown,
    Value,
    concatenate,
    paths,
)

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.extract.launch.ros2.texts import Part
    from kg.extract.launch.ros2.texts import Text as LaunchText
    from kg.facts import Location
    from kg.symbolic.form import Expression, Unit
    from kg.symbolic.state import Arguments

__all__ = [
    "MARK",
    "Fork",
    "Later",
    "Made",
    "condition_of",
    "entries_of",
    "guarded",
    "later",
    "launch_text",
    "options",
    "pair_of",
    "reason_of",
    "terms_of_way",
    "text_of",
    "words",
]

_MOST_PARTS: Final = 2_000
_LONGEST: Final = 200
_PLACED: Final = (
    form.Literal, form.Name, form.Member, form.Call, form.Unary, form.Binary, form.Choice, form.Index, form.Display,
    form.Pairs, form.Lambda, form.Assign, form.Opaque, form.Spread,
)  # fmt: skip
MARK: Final = "?"
"""Begins the term of a condition that cannot be known: the words of the file follow."""


@dataclass(frozen=True, slots=True, eq=False)
class Later(Hole):
    """A part of a text that is known only when an action is executed."""

    part: Substitution = Substitution("unknown")  # noqa: RUF009 - it is immutable

    __eq__ = object.__eq__
    __hash__ = object.__hash__


@dataclass(frozen=True, slots=True, eq=False)
class Fork:
    """A choice of which it is not known what is taken: the terms of each side. Outer ones have higher numbers."""

    number: int
    terms: tuple[tuple[str, ...], ...]


@dataclass(slots=True, eq=False, kw_only=True)
class Made(Object):
    """An object of a class of launch: its arguments by name in `fields`, and the call that made it."""

    given: Arguments
    location: Location
    names: tuple[str, ...] = ()
    """The names of its parameters in order."""
    substituted: LaunchText | None = None
    """What it gives when it is substituted, once that was read."""

    @property
    def name(self) -> str:
        """The name of its class."""
        return self.kind.name

    def value(self, name: str) -> Value | None:
        """Return an argument; None if it is not given or None."""
        held = self.fields.get(name)
        return None if held == NULL else held

    def first(self, *names: str) -> Value | None:
        """Return the argument given by one of several names; None if there is none."""
        return next((held for name in names if (held := self.value(name)) is not None), None)

    def text(self, name: str) -> LaunchText | None:
        """Return an argument as a text; None if it is not given."""
        held = self.value(name)
        return None if held is None else launch_text(held)

    def expression(self, name: str) -> Expression | None:
        """Return the expression of an argument; None if it is not written at the call itself."""
        call = self.given.call
        if call is None:
            return None
        index = self.names.index(name) if name in self.names else len(call.arguments)
        return dict(call.keywords).get(name, call.arguments[index] if index < len(call.arguments) else None)

    def place(self, name: str) -> Location:
        """Return where an argument stands; the call itself if that is not known."""
        found = self.expression(name)
        return replace(self.location, line=found.line) if isinstance(found, _PLACED) else self.location

    def words(self, name: str) -> str:
        """Return an argument, or the call, in the words of the file."""
        frame, found = self.given.frame, self.expression(name) or self.given.call
        return words(found, frame.unit) if found is not None and frame is not None else ""


def words(element: object, unit: Unit) -> str:
    """Return an element of the form in the words of the file, in one line."""
    sources = getattr(unit, "sources", None) or {}
    node = sources.get(element)
    if node is None:
        return spelled(element) if isinstance(element, _PLACED) else ""
    text = node.text.decode("utf-8", "replace")
    with suppress(SyntaxError, ValueError, RecursionError):
        text = ast.unparse(ast.parse(f"({text}\n)", mode="eval"))
    return " ".join(text.split())[:_LONGEST]


def terms_of_way(way: Iterable[tuple[object, int]]) -> tuple[str, ...]:
    """Return the terms of an alternative, those of outer branches first."""
    forks = sorted(((fork, side) for fork, side in way if isinstance(fork, Fork)), key=lambda one: -one[0].number)
    return tuple(dict.fromkeys(term for fork, side in forks for term in fork.terms[side]))


def condition_of(terms: tuple[str, ...]) -> Condition | None:
    """Return terms as a condition that cannot be known; None for no terms."""
    conditions = [Condition(None, term.startswith("!"), term.lstrip(f"!{MARK}")) for term in terms]
    if len(conditions) > 1:
        return Condition(None, written=" and ".join(condition.words for condition in conditions))
    return conditions[0] if conditions else None


def options(value: Value) -> list[tuple[Condition | None, Value]]:
    """Return the alternatives of a value, each with its condition."""
    return [(condition_of(terms_of_way(way)), item) for item, way in paths(value)]


def guarded(item: Value) -> tuple[Value, tuple[str, ...]]:
    """Return an item of a list that may be there only under conditions, and their terms."""
    if isinstance(item, Either) and len(item.items) == 1:
        return item.items[0], terms_of_way(item.ways[0] if item.ways else ())
    return item, ()


def reason_of(value: Value | None) -> str:
    """Return why a value cannot be used as what it should be."""
    if isinstance(value, Either):
        written = next((one.written for one, _ in options(value) if one is not None), "")
        return f"it depends on `{written}`"
    if isinstance(value, Unknown):
        return value.reason
    if isinstance(value, Made):
        parts = [part for part in launch_text(value) if isinstance(part, Substitution)]
        return _why(parts[0]) if parts else f"a `{value.name}` cannot stand here"
    if isinstance(value, Text):
        found = next((part for part in value.parts if isinstance(part, Later)), None)
        return _why(found.part) if found is not None else value.reason or "a text cannot stand here"
    return f"a value of the type {type(value).__name__.lower()} cannot stand here"


def _why(part: Substitution) -> str:
    return part.reason or f"a substitution `{part.kind}` is known only when it is executed"


def later(kind: str, *arguments: LaunchText) -> Text:
    """Return a text that is one substitution."""
    return Text((Later(part=Substitution(kind, arguments)),))


def text_of(parts: Iterable[Part]) -> Text:
    """Return a text of launch as a value."""
    pieces = (Text((part,)) if isinstance(part, str) else Text((Later(part=part),)) for part in parts)
    made = concatenate(*pieces)
    return made if isinstance(made, Text) else Text(("",))


def launch_text(value: Value) -> LaunchText:
    """Return a value as the text that launch makes of it: a text, a substitution, or a list of both to be joined."""
    from kg.extract.launch.ros2.python.substitutions import substituted  # noqa: PLC0415 - each needs the other

    if isinstance(value, Text):
        reason = value.reason or "it is not known"
        parts: list[Part] = []
        for part in value.parts:
            if isinstance(part, Later):
                parts.append(part.part)
            else:
                parts.append(part if isinstance(part, str) else Substitution("unknown", reason=reason))
        return join(parts)
    if isinstance(value, Made):
        if value.substituted is None:
            value.substituted = substituted(value)
        return value.substituted
    if isinstance(value, Either):
        return _common(value)
    if isinstance(value, Number | Truth):
        return (str(plain(value)),)
    if isinstance(value, Sequence):
        return join([part for item in value.items[:_MOST_PARTS] for part in launch_text(item)])
    return unknown_text(reason_of(value))


def _common(value: Either) -> LaunchText:
    """Return what several texts begin and end with, and between that what is not known."""
    texts = [item.known or "" for item in value.items if isinstance(item, Text) and item.known is not None]
    if len(texts) < len(value.items) or len(texts) == 1:
        return unknown_text(reason_of(value))
    first = _shared(texts)
    last = _shared([text[len(first) :][::-1] for text in texts])[::-1]
    return join([first, *unknown_text(reason_of(value)), last])


def _shared(texts: list[str]) -> str:
    """Return what all texts begin with, up to the end of a word."""
    columns = enumerate(zip(*texts, strict=False))
    end = next((index for index, letters in columns if len(set(letters)) > 1), min(map(len, texts)))
    while end and texts[0][end - 1].isalnum() and any(text[end : end + 1].isalnum() for text in texts):
        end -= 1
    return texts[0][:end]


def pair_of(value: Value) -> tuple[Value, Value] | None:
    """Return the two items of a list of two; None for all else."""
    if isinstance(value, Sequence) and len(value.items) == 2 and not value.open:  # noqa: PLR2004 - a pair
        return value.items[0], value.items[1]
    return None


def entries_of(value: Value | None) -> list[tuple[Value, Value]]:
    """Return the entries of a dictionary; none of other values."""
    return list(value.items) if isinstance(value, Mapping) else []
