"""Abstract values: what an expression can be when the program runs, as far as its sources show.

Scalars and collections are immutable: nothing changes them after creation. They are not frozen, because frozen
dataclasses take three times as long to create. Objects have an identity, and the interpreter records writes to their
fields. A scalar that comes from a parameter carries the parameter's name, with the parameter's default as its value.
An unknown part is a hole in a text, or `Unknown` with its reason; nothing is guessed.
"""

from __future__ import annotations

import math
import re
import sys
from dataclasses import dataclass, field, replace
from itertools import islice, product, repeat
from operator import is_
from typing import TYPE_CHECKING, Final, TypeAlias, TypeGuard

from kg.facts import Qos, Resolution
from kg.holes import PARENT, SUBSTITUTIONS, Hole, label_of, written

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from kg.symbolic.form import Class, Function
    from kg.symbolic.state import Frame

Way: TypeAlias = "frozenset[tuple[object, int]]"
"""Choices, each with the option that was taken."""
MOST_ALTERNATIVES: Final = 12
MOST_ROWS: Final = 500
"""How many rows of alternatives are tried for those that choices allow."""
_ALWAYS: Final[Way] = frozenset()
_NAMELESS: Final = (Hole(),)
_ORDER: Final = {resolution: index for index, resolution in enumerate(Resolution)}
# The most frequent functions below compare classes by identity: that takes a fifth of the time of `isinstance`.


_GIVEN_NAME: Final = "name comes from outside"


@dataclass(unsafe_hash=True, slots=True)
class Text:
    """A string of known parts and holes; `parameter` names the parameter whose default this is.

    `own` is whether it is the value of the parameter itself, and not made of it; `unsure` whether it is empty unless
    something unknown fills it.
    """

    parts: tuple[str | Hole, ...]
    resolution: Resolution = Resolution.LITERAL
    parameter: str | None = None
    reason: str | None = None
    own: bool = field(default=False, compare=False)
    unsure: bool = field(default=False, compare=False)

    @classmethod
    def of(cls, text: str, resolution: Resolution = Resolution.LITERAL, parameter: str | None = None) -> Text:
        """Return the text whose every character is known."""
        return cls((text,), resolution, parameter)

    @classmethod
    def hole(cls, reason: str, label: str = "", parameter: str | None = None) -> Text:
        """Return a text of which nothing is known."""
        return cls((Hole(label_of(parameter or label)),), Resolution.PARTIAL, parameter, reason)

    @property
    def exact(self) -> str | None:
        """The string; None if it has a hole."""
        if len(self.parts) == 1:
            only = self.parts[0]
            return only if isinstance(only, str) else None
        if any(isinstance(part, Hole) for part in self.parts):
            return None
        return "".join(part for part in self.parts if isinstance(part, str))

    @property
    def shown(self) -> str:
        """The string as a name with holes, see `kg.holes`."""
        return written(self.parts)

    @property
    def given_name(self) -> bool:
        """Whether it is the name of something that code outside gives, such as that of a plugin: it is not empty."""
        return self.parameter is None and self.reason is not None and self.reason.endswith(_GIVEN_NAME)

    @property
    def wholly_unknown(self) -> bool:
        """Whether no letter of it is known."""
        return not any(
            part.label == PARENT if isinstance(part, Hole) else part.strip("/~._") for part in self.parts
        ) and any(isinstance(part, Hole) for part in self.parts)


@dataclass(unsafe_hash=True, slots=True)
class Number:
    """A number, as the source writes it; `parameter` and `own` as those of a text."""

    value: float
    written: str
    parameter: str | None = None
    own: bool = field(default=False, compare=False)

    @property
    def whole(self) -> int:
        """The number without its fraction, as an index or a count; infinity is larger than any, and no number is 0."""
        if math.isfinite(self.value):
            return int(self.value)
        return 0 if math.isnan(self.value) else int(math.copysign(sys.maxsize, self.value))

    @property
    def floating(self) -> bool:
        """Whether it is not a whole number by its type."""
        return not self.written.startswith(("0x", "0X")) and any(mark in self.written for mark in ".eEin")


@dataclass(unsafe_hash=True, slots=True)
class Truth:
    """A boolean; one that is a parameter's default decides nothing, since the parameter may be set."""

    value: bool
    parameter: str | None = None


@dataclass(unsafe_hash=True, slots=True)
class Enumerator:
    """A constant of an enumeration of the sources, by its name; one that is a parameter's default decides nothing."""

    name: str
    parameter: str | None = None
    number: int | None = field(default=None, compare=False)


@dataclass(unsafe_hash=True, slots=True)
class Guard:
    """A condition on parameters, as a conjunction: `use_imu`, or `!use_imu`.

    One that is not `whole` also requires something that is unknown, so it may fail where all terms hold. One that is
    `any_of` is a disjunction, which something unknown may fulfil, too, if it is not whole.
    """

    terms: tuple[str, ...]
    whole: bool = True
    any_of: bool = False


@dataclass(unsafe_hash=True, slots=True)
class Sequence:
    """A list of known values; `open` where there may be more, `repeated` where each may be in it more than once."""

    items: tuple[Value, ...]
    open: bool = False
    parameter: str | None = None
    repeated: bool = False


@dataclass(unsafe_hash=True, slots=True)
class Mapping:
    """A dictionary or map; `open` where there may be more. `default` makes the values of keys that are missing."""

    items: tuple[tuple[Value, Value], ...]
    open: bool = False
    parameter: str | None = None
    default: Value | None = None


@dataclass(unsafe_hash=True, slots=True)
class Kind:
    """A resolved type: its qualified names, template arguments, and the class of the sources that it is, if any."""

    names: tuple[str, ...]
    arguments: tuple[Value, ...] = ()
    cls: Class | None = None

    @property
    def name(self) -> str:
        """The last name."""
        return self.names[-1] if self.names else ""


@dataclass(unsafe_hash=True, slots=True)
class TypeValue:
    """A type as a value: a template argument, or a class of Python."""

    kind: Kind


@dataclass(slots=True, eq=False)
class Object:
    """An instance of a class. `created` is False if it comes from outside: no code that was run creates it."""

    kind: Kind
    created: bool = True
    fields: dict[str, Value] = field(default_factory=dict)
    native: dict[str, Value] = field(default_factory=dict)
    """State of an object of a framework class, by the names that `kg.symbolic.effects` uses."""
    line: int = 0
    path: str = ""
    heap: bool = False
    """Whether `new` or `make_shared` made it, so that pointers hold it."""


@dataclass(slots=True, eq=False)
class Closure:
    """A function with the variables around it: a lambda, or a nested function."""

    function: Function
    frame: Frame
    bound: tuple[Value, ...] = ()
    named: tuple[tuple[str, Value], ...] = ()
    """Arguments by name that are already given."""
    captured: tuple[Value, ...] = ()
    """The values that it copied by name when it was made."""


@dataclass(slots=True, eq=False)
class Bound:
    """A method by its name, of a class (`of` a `Kind`) or of an object."""

    name: str
    of: Object | Kind | None
    functions: tuple[Function, ...] = ()
    given: tuple[Value, ...] = ()
    """The arguments that `bind` gave, with `PLACEHOLDER` for those of the caller; none if nothing was bound."""
    template: tuple[Value, ...] = ()

    @property
    def skip(self) -> int:
        """The index of the first parameter that the caller gives."""
        return self.given.index(PLACEHOLDER) if PLACEHOLDER in self.given else 0

    def filled(self, values: list[Value]) -> list[Value]:
        """Return the arguments of a call: those that were bound, with the caller's in their places."""
        rest = iter(values)
        missing = Unknown("it is not given")
        return [next(rest, missing) if one == PLACEHOLDER else one for one in self.given] if self.given else values


@dataclass(unsafe_hash=True, slots=True)
class Unknown:
    """An unknown value; `reason` completes "it is not known because ...".

    `label` is the name of the first variable that has it: None before any has, empty if it keeps no name.
    """

    reason: str
    parameter: str | None = None
    label: str | None = field(default=None, compare=False)


OUTSIDE: Final = "is not in the sources that were read"
"""How the reason of a name or a function ends that is not in the build."""
_CONSTANT: Final = re.compile(rf"(?:\w+(?:::|\.))*(?:[A-Z]|k[A-Z])\w* {OUTSIDE}\Z")
"""The reason of a name outside of the build that is written as constants are: `VENDOR_IMU`, `Mode::kAuto`."""
LENGTH: Final = Unknown("a loop fills the list")
"""The length of a list that a loop fills as often as is not known; it can be any number."""


def is_foreign(value: Value) -> bool:
    """Check whether a value is a constant of code outside of the build, which its name tells from others."""
    return isinstance(value, Unknown) and _CONSTANT.match(value.reason) is not None


@dataclass(unsafe_hash=True, slots=True)
class Pack:
    """The arguments of a variadic parameter."""

    items: tuple[Value, ...]


@dataclass(unsafe_hash=True, slots=True)
class Profile:
    """A quality of service; None if any part of it is unknown."""

    qos: Qos | None


@dataclass(unsafe_hash=True, slots=True)
class Either:
    """One of several values. `ways` are the choices that lead to each, so that choices stay together."""

    items: tuple[Value, ...]
    ways: tuple[Way, ...] = field(default=(), compare=False)
    read: tuple[str, Either | None] | None = field(default=None, init=False, compare=False, repr=False)
    """What `read_back` last gave, by the name it was given; None in it is this value itself."""


ABSENT: Final = Unknown("it is not given")
"""An argument that a call leaves out before others."""
PLACEHOLDER: Final = Unknown("it is given when the function is called")
"""An argument that the caller of a bound function supplies: `_1`."""


Scalar: TypeAlias = Text | Number | Truth | Enumerator | Guard | Unknown | Profile
Value: TypeAlias = Scalar | Sequence | Mapping | TypeValue | Object | Closure | Bound | Pack | Either


def alternatives(value: Value) -> tuple[Value, ...]:
    """Return the values that a value can be."""
    if type(value) is not Either:
        return (value,)
    return tuple(_unique(value.items)) if value.ways else value.items


def _unique(items: Iterable[Value]) -> list[Value]:
    unique: list[Value] = []
    for item in items:
        if item not in unique:
            unique.append(item)
    return unique


def paths(value: Value) -> Iterable[tuple[Value, Way]]:
    """Return the values that a value can be, each with the choices that lead to it."""
    if not isinstance(value, Either):
        return ((value, _ALWAYS),)
    return zip(value.items, value.ways or repeat(_ALWAYS), strict=False)


def options(values: Iterable[Value], choice: object) -> Value:
    """Return one of several values, of which a choice takes one: the same wherever the choice is the same."""
    values = tuple(values)
    first = values[0]
    if type(first) is not Either:
        for value in values:
            if value is not first and value != first:
                break
        else:
            return first
    solid = [value for value in values if type(value) is not Unknown or value.parameter is not None]
    if len(solid) == 1 and type(solid[0]) not in _DECISIVE and not _is_nothing(solid[0]):
        return _or_unknown(solid[0])  # as `_any_of`, which leaves out what is not known
    pairs: list[tuple[Value, Way]] = []
    for index, value in enumerate(values):
        option = frozenset([(choice, index)])
        if isinstance(value, Either):
            pairs += [(item, way | option) for item, way in paths(value)]
        else:
            pairs.append((value, option))
    return _any_of(pairs)


def rows(values: tuple[Value, ...], most: int) -> Iterator[tuple[tuple[Value, ...], Way]]:
    """Yield the rows of alternatives that no choice excludes, with their choices."""
    count = 0
    for pairs in islice(product(*map(paths, values)), MOST_ROWS):
        way: dict[object, int] = {}
        if all(way.setdefault(choice, option) == option for _, one in pairs for choice, option in one):
            count += 1
            yield tuple(item for item, _ in pairs), frozenset(way.items())
        if count >= most:
            return


def combinations(values: Iterable[Value], most: int = MOST_ALTERNATIVES) -> Iterator[tuple[Value, ...]]:
    """Yield the rows of alternatives of some values, at most `most` of them."""
    values = tuple(values)
    if not any(isinstance(value, Either) for value in values):
        yield values
        return
    for row, _ in rows(values, most):
        yield row


def over(values: Iterable[Value], apply: Callable[..., Value]) -> Value:
    """Apply a function to each row of alternatives of some values, and join the results."""
    values = tuple(values)
    for value in values:
        if type(value) is Either:
            break
    else:
        return apply(*values)
    results: list[Value] = []
    for row, way in rows(values, MOST_ALTERNATIVES):
        result = apply(*row)
        pairs = list(paths(result))
        results.append(Either(tuple(item for item, _ in pairs), tuple(own | way for _, own in pairs)))
    # A single value is joined with itself, as `join` would leave it alone, and its alternatives can be alike.
    return join(*results, results[0]) if results else Unknown("its parts exclude each other")


_READ_BACK: Final = frozenset({Text, Sequence, Either})
"""Elements that `read_back` changes."""


UNASSIGNED: Final = Text(("",), reason="nothing assigns it in the code that was run")
"""A text that a declaration leaves empty."""
UNSURE: Final = "only something unknown fills it"
"""Why a text is not known that is empty unless something unknown fills it."""


def read_back(value: Value, name: str = "") -> Value:
    """Return a value as read from a variable rather than written in place; `name` labels it if it is unknown."""
    if type(value) is Unknown:
        if value.label is None and name:
            return Unknown(value.reason, value.parameter, label_of(name) or None)
    elif type(value) is Text:
        if value.resolution is Resolution.LITERAL:
            return Text(value.parts, Resolution.CONSTANT, value.parameter, value.reason, unsure=value.unsure)
        if value.parts == _NAMELESS and label_of(name):
            return Text((Hole(label_of(name)),), value.resolution, value.parameter, value.reason)
    elif type(value) is Either:
        if value.read is None or value.read[0] != name:
            items = tuple([read_back(item, name) for item in value.items])
            same = all(map(is_, items, value.items))
            value.read = (name, None if same else Either(items, value.ways))
        return value.read[1] or value
    elif type(value) is Sequence and not _READ_BACK.isdisjoint(map(type, value.items)):
        return Sequence(tuple([read_back(item) for item in value.items]), value.open, value.parameter, value.repeated)
    return value


def labelled(result: Value, function: str, arguments: list[Value]) -> Value:
    """Return the result of a function; its name labels an unknown one if no argument tells calls apart."""
    return result if arguments else read_back(result, function)


def outside(function: str, arguments: list[Value], reason: str | None = None) -> Value:
    """Return the result of a function that no source defines; by default that is the reason why it is unknown."""
    return labelled(Unknown(reason or f"{function}() {OUTSIDE}"), function, arguments)


def whole_parameter(value: Value) -> bool:
    """Check whether a value is exactly the value of a parameter without default."""
    if isinstance(value, Unknown):
        return value.parameter is not None
    return isinstance(value, Text) and value.parameter is not None and len(value.parts) == 1 and value.exact is None


def join(*values: Value) -> Value:
    """Return a value that is any of some values.

    A parameter without default that falls back to another value has that value as its default. Unknown values leave
    the others, but a truth value or number that can also be unknown is unknown, since both sides of a branch on it can
    run.
    """
    if len(values) == 1:
        return values[0]
    pairs: list[tuple[Value, Way]] = []
    for value in values:
        pairs += [pair for pair in paths(value) if pair not in pairs]
        if len(pairs) > MOST_ROWS:
            break
    return _any_of(pairs)


def _any_of(pairs: list[tuple[Value, Way]]) -> Value:
    """Return a value that is any of some values, each with the choices that lead to it."""
    if len(pairs) > MOST_ROWS:
        return Unknown(f"it has more than {MOST_ALTERNATIVES} possible values")
    items = _unique(item for item, _ in pairs)
    defaulted = _with_defaults(items) if len(items) > 1 else items
    if defaulted is not items:
        pairs, items = [], defaulted
    if LENGTH in items:
        return LENGTH
    if {type(item) for item in items} in ({Truth, Unknown}, {Number, Unknown}):
        return next(item for item in items if isinstance(item, Unknown))
    if any(map(_is_nothing, items)):
        filled = [one for one in items if not _is_nothing(one) and one not in _NEVER_FILLED]
        if filled and all(type(one) is Unknown for one in filled):
            return filled[0]  # what it may hold decides whether loops run
    if len(items) > 1 and any(not isinstance(item, Unknown) for item in items):
        items = [item for item in items if not isinstance(item, Unknown) or item.parameter is not None] or items
        if len(items) == 1:
            return _or_unknown(items[0])
    elif len(items) > 1:
        plain = [one for one in items if _is_plain(one)]
        pairs = [(plain[0] if item in plain else item, way) for item, way in pairs]
        items = [one for one in items if one not in plain[1:]]
    united = _united(items) if len(items) > _MOST_CONTAINERS else None
    if united is not None:
        return united
    if len(items) > MOST_ALTERNATIVES:
        items = _one_of_each_place(items)
    if len(items) > MOST_ALTERNATIVES:
        return Unknown(f"it has more than {MOST_ALTERNATIVES} possible values")
    if len(items) == 1:
        return items[0]
    kept = [pair for pair in pairs if pair[0] in items]
    if len(kept) > MOST_ALTERNATIVES or not any(way for _, way in kept):
        return Either(tuple(items))
    return Either(tuple(item for item, _ in kept), tuple(way for _, way in kept))


def _one_of_each_place(items: list[Value]) -> list[Value]:
    """Return the first of the objects that each line creates, such as one in a loop, and the other values."""
    places = [(one.kind, one.path, one.line) if isinstance(one, Object) and one.line else id(one) for one in items]
    return list(dict(zip(reversed(places), reversed(items), strict=True)).values())[::-1]


def _is_plain(value: Value) -> bool:
    """Check whether a value is unknown and differs from others in its reason only, which decides no condition."""
    unknown = isinstance(value, Unknown) and value.parameter is None
    return unknown and value not in _NEVER_FILLED and not is_foreign(value)


def _or_unknown(value: Value) -> Value:
    """Return a value that can also be unknown: comparisons with a text that is empty at first decide nothing."""
    return replace(value, unsure=True) if is_empty_text(value) else value


def is_empty_text(value: Value) -> TypeGuard[Text]:
    """Check whether a value is an empty text, not that of a parameter."""
    return isinstance(value, Text) and value.exact == "" and value.parameter is None


def _is_nothing(value: Value) -> bool:
    """Check whether a value is a container without elements that no parameter gives."""
    return isinstance(value, Sequence | Mapping) and value in _NOTHING


_NOTHING: Final = (Sequence(()), Mapping(()))
_NEVER_FILLED: Final = (Unknown("it is null"), Unknown("it has no value"))
_DECISIVE: Final = frozenset({Truth, Number, Either})
"""Values that are not taken alone where they may also be unknown: conditions depend on them, or they are several."""
_MOST_CONTAINERS: Final = 4
"""How many lists or maps are told apart: each branch that adds to one would double them."""
_MOST_UNITED: Final = 32
"""How many elements each container has at most of those whose elements are taken together."""


def _united(values: list[Value]) -> Value | None:
    """Return a container with the elements of all of some that grew differently; unknown if they have many elements.

    None if not all are lists or maps. Those of one length are rows, such as pairs, which stay apart unless they are too
    many and have objects only.
    """
    containers = [one for one in values if isinstance(one, Sequence | Mapping) and one.parameter is None]
    kinds, lengths = {type(one) for one in containers}, {len(one.items) for one in containers}
    if len(containers) < len(values) or len(kinds) > 1:
        return None
    if len(lengths) == 1 and not (
        len(values) > MOST_ALTERNATIVES and all(type(item) is Object for one in containers for item in one.items)
    ):
        return None
    longest = max(containers, key=lambda one: len(one.items))
    if len(longest.items) > _MOST_UNITED:
        return Unknown(f"it has more than {_MOST_CONTAINERS} possible values")
    more = any(one.open for one in containers)
    if isinstance(longest, Sequence):
        items = dict.fromkeys(item for one in containers if isinstance(one, Sequence) for item in one.items)
        return Sequence(tuple(items), more, repeated=True)
    pairs = dict.fromkeys(pair for one in containers if isinstance(one, Mapping) for pair in one.items)
    return replace(longest, items=tuple(pairs), open=more)


def _with_defaults(items: list[Value]) -> list[Value]:
    """Return alternatives in which a parameter without default takes the other alternatives as defaults."""
    unset = next((item for item in items if whole_parameter(item)), None)
    if unset is None:
        return items
    parameter = unset.parameter if isinstance(unset, (Text, Unknown)) else None
    result: list[Value] = []
    others: list[Value] = []
    for item in items:
        if isinstance(item, Text) and item.parameter is None and item.exact is not None:
            if item.exact:
                resolution = worse(item.resolution, Resolution.PARAMETER_DEFAULT)
                result.append(replace(item, parameter=parameter, resolution=resolution))
        elif isinstance(item, (Number, Truth, Sequence, Mapping)) and item.parameter is None:
            result.append(replace(item, parameter=parameter))
        elif not isinstance(item, Unknown) and not whole_parameter(item):
            others.append(item)
    return [*result, *others] if result else [unset, *others]


def worse(one: Resolution, other: Resolution) -> Resolution:
    """Return the less certain of two resolutions."""
    return one if _ORDER[one] >= _ORDER[other] else other


def without_default(parameter: str) -> Unknown:
    """Return the value of a parameter whose default is not known."""
    return Unknown(f"it is the parameter {parameter}, which has no default here", parameter)


def number(value: float, parameter: str | None = None) -> Number:
    """Return a number that was computed."""
    whole = math.isfinite(value) and value == int(value)
    return Number(value, str(int(value)) if whole else repr(value), parameter)


def concatenate(*values: Value) -> Value:
    """Return the text of all values in a row; an unknown value becomes a hole.

    So does a text after others that is empty unless something unknown fills it: else nobody would put it there. If
    nothing but holes is left, the parameter is one of theirs, not one that is empty.
    """
    if any(isinstance(value, Either) for value in values):
        return over(values, concatenate)
    parts: list[str | Hole] = []
    reasons: dict[str, str | None] = {}
    resolution, parameter, reason, open_parameter = Resolution.LITERAL, None, None, None
    for value in values:
        piece = as_text(value)
        if piece.reason == UNASSIGNED.reason or (piece.unsure and piece.exact == ""):
            if not parts:
                continue
            piece = Text.hole(piece.reason or UNSURE)
        resolution = worse(resolution, piece.resolution)
        parameter = parameter or piece.parameter
        reason = reason or piece.reason
        for part in piece.parts:
            if isinstance(part, Hole):
                open_parameter = open_parameter or piece.parameter
                same = reasons.setdefault(part.label, piece.reason) == piece.reason or part.label in SUBSTITUTIONS
                hole = part if same else Hole()
                if hole.label or not parts or parts[-1] != hole:
                    parts.append(hole)
            elif part and parts and isinstance(parts[-1], str):
                parts[-1] += part
            elif part:
                parts.append(part)
    if parts and all(isinstance(part, Hole) for part in parts):
        parameter = open_parameter
    return Text(tuple(parts) or ("",), resolution, parameter, reason)


def as_text(value: Value) -> Text:
    """Return a value as text; a value without text is a hole."""
    if isinstance(value, Text):
        return value
    if isinstance(value, Number):
        return Text((value.written,), Resolution.LITERAL, value.parameter)
    if isinstance(value, Truth) and value.parameter is None:
        return Text(("1" if value.value else "0",))
    if isinstance(value, Unknown):
        return Text.hole(value.reason, value.label or "", value.parameter)
    return Text.hole("it is computed when the program runs")


def bound_call(arguments: list[Value]) -> Value:
    """Return a function with some of its arguments, as `std::bind` gives it; the function is the first argument."""
    first, *rest = arguments
    if isinstance(first, Bound) and first.of is None and first.functions:
        return replace(first, given=tuple(rest))
    if isinstance(first, Bound):
        if isinstance(first.of, Object):
            return replace(first, functions=(), given=tuple(rest))
        objects = (one for value in rest for one in alternatives(value) if isinstance(one, Object))
        return replace(first, of=next(objects, first.of), functions=(), given=tuple(rest[1:]))
    if isinstance(first, Closure):
        bound = tuple(value for value in rest if not isinstance(value, Unknown))
        return Closure(first.function, first.frame, bound, captured=first.captured)
    return first
