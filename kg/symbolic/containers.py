"""Containers of abstract values: their elements, and what a change of an element makes of them."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final, TypeGuard

from kg.facts import Resolution
from kg.holes import Hole, fits, label_of
from kg.symbolic import form
from kg.symbolic.letters import letters, with_letter
from kg.symbolic.names import OWN_NAMESPACE, PARENT_NAMESPACE
from kg.symbolic.parameters import with_parameter
from kg.symbolic.values import (
    Either,
    Enumerator,
    Mapping,
    Number,
    Object,
    Sequence,
    Text,
    Unknown,
    Value,
    is_foreign,
    join,
    options,
    over,
)

if TYPE_CHECKING:
    from kg.symbolic.form import Expression
    from kg.symbolic.state import Holder, Written

_NAMESPACES: Final = (OWN_NAMESPACE, PARENT_NAMESPACE)
"""What begins with a slash."""
COMMAND_LINE: Final = Sequence((), open=True, parameter="argv")
"""The arguments of the program, the program itself first."""


def elements(of: Value) -> list[Value]:
    """Return the elements of a container, or one that represents all of them."""
    if is_unset(of):
        one = part_of(f"{of.parameter}[]")
        return [one if isinstance(of, Sequence) else Sequence((key_of(of.parameter), one))]
    if isinstance(of, Sequence):
        items = of.items if of.parameter is None else [with_parameter(item, f"{of.parameter}[]") for item in of.items]
        return [*items, *([_some(of)] if of.open else [])]
    if isinstance(of, Mapping):
        return [Sequence(pair) for pair in of.items] + ([_some(of)] if of.open else [])
    known = letters(of)
    if known is not None:
        return known
    if is_unknown_parameter(of):
        return [part_of(f"{of.parameter}[]")]
    if isinstance(of, Object) and not of.created:
        return [Unknown("it is an element of a container from outside the sources")]
    return [Unknown("it is an element of an unknown container")]


def _argument_at(index: Value) -> Value:
    """Return one of the arguments of the program, as the parameter `argv[1]`."""
    if isinstance(index, Number) and index.value == 0:
        return Text.hole("it is the name of the program")
    name = f"argv[{index.whole}]" if isinstance(index, Number) else "argv[]"
    return Text(
        (Hole(label_of(name)),), Resolution.LAUNCH_ARGUMENT, name, f"it is the argument {name} of the command line"
    )


def is_unknown_parameter(of: Value) -> TypeGuard[Text | Unknown]:
    """Check whether a value is a parameter of which no default is known."""
    return isinstance(of, Text | Unknown) and of.parameter is not None and (isinstance(of, Unknown) or of.exact is None)


def is_unset(of: Value) -> TypeGuard[Sequence | Mapping]:
    """Check whether a value is a parameter that is empty by default: its elements are those that a launch file sets.

    ROS 2 takes the type of a list from its elements, so that one empty text stands for a list without any.
    """
    if not isinstance(of, Sequence | Mapping) or of.parameter in (None, "argv"):
        return False
    return not of.items or (len(of.items) == 1 and isinstance(of.items[0], Text) and of.items[0].exact == "")


def key_of(parameter: str | None) -> Text:
    """Return a key of a parameter that is a map."""
    return Text.hole(f"it is a key of a parameter: {parameter}", parameter=f"{parameter}[key]")


def part_of(name: str) -> Text:
    """Return an element of a parameter that is a list or a map."""
    return Text.hole(f"it is part of a parameter: {name}", parameter=name)


def _some(of: Sequence | Mapping) -> Value:
    if of.parameter is not None:
        return part_of(f"{of.parameter}[]")
    return Unknown("it is an element that was added when the program runs")


def element(of: Value, key: Value) -> Value:
    """Return the element of a container at a key, or what any of them can be."""
    if isinstance(of, Sequence) and of.parameter == "argv":
        return _argument_at(key)
    if is_unset(of):
        of = Unknown("it is a parameter", of.parameter)
    if isinstance(of, Sequence):
        if isinstance(key, Number):
            index = key.whole
            if 0 <= index < len(of.items) or of.parameter is None:
                return of.items[index] if 0 <= index < len(of.items) else Unknown("the list has no such element")
        if of.parameter is not None:
            return join(*elements(of)) if of.items else _some(of)
        if not of.items:
            return _some(of) if of.open else Unknown("the list is empty")
        return join(*of.items)
    if isinstance(of, Mapping):
        same = [(_same(key, own), value) for own, value in of.items]
        values = [value for equal, value in same if equal]
        plain = isinstance(key, Number) or (isinstance(key, Text) and key.exact is not None)
        if not values and not plain and any(equal is None for equal, _ in same):
            values = [value for equal, value in same if equal is None]
            choice = (tuple(own for own, _ in of.items), key) if getattr(key, "parameter", None) else object()
            return options(values, choice)
        return join(*values) if values else Unknown("the map has no such key")
    if isinstance(of, Text) and of.parts[0] in _NAMESPACES and isinstance(key, Number) and key.value == 0:
        return Text.of("/")
    if isinstance(key, Number) and (known := letters(of)) is not None and 0 <= key.whole < len(known):
        return known[key.whole]
    if is_unknown_parameter(of):
        part = f".{key.exact}" if isinstance(key, Text) and key.exact is not None else "[]"
        return part_of(f"{of.parameter}{part}")
    return Unknown("the elements of the container are unknown")


def _same(key: Value, own: Value) -> bool | None:
    """Check whether two keys of a map are equal; None if they can be."""
    if isinstance(key, Sequence) and isinstance(own, Sequence) and not key.open and not own.open:
        parts = [_same(one, other) for one, other in zip(key.items, own.items, strict=False)]
        if False in parts or len(key.items) != len(own.items):
            return False
        return None if None in parts else True
    if isinstance(key, Text) and isinstance(own, Text):
        if own.exact is None:
            return None
        if key.exact is not None:
            return key.exact == own.exact
        return None if fits(key.shown, own.exact, ".*") else False
    if isinstance(key, Number) and isinstance(own, Number):
        return key.value == own.value
    if isinstance(key, Enumerator) and isinstance(own, Enumerator):
        return key.name == own.name
    if is_foreign(key) and is_foreign(own):
        return key == own
    return False if {type(key), type(own)} == {Text, Number} else None


def _is_key(key: Value, own: Value) -> bool:
    """Check whether a key of a map is surely another one. Two that are unknown for one reason can differ."""
    equal = _same(key, own)
    return equal if equal is not None else own == key and not isinstance(key, Unknown | Text | Sequence)


def with_element(of: Value, key: Value, value: Value) -> Value:
    """Return a container with an element set."""
    if isinstance(of, Sequence) and isinstance(key, Number) and 0 <= key.whole < len(of.items):
        items = list(of.items)
        items[key.whole] = value
        return replace(of, items=tuple(items))
    if isinstance(of, Sequence) and of.repeated and not isinstance(key, Number):
        return replace(of, items=(*of.items, value) if value not in of.items else of.items)
    if isinstance(of, Mapping):
        same = [_is_key(key, own) for own, _ in of.items]
        pairs = tuple((key, value) if equal else pair for equal, pair in zip(same, of.items, strict=True))
        added = () if True in same or (key, value) in pairs else ((key, value),)
        return replace(of, items=(*pairs, *added), parameter=None)
    if isinstance(of, Sequence) and not of.items:
        return Mapping(((key, value),))
    return with_letter(of, key, value) if isinstance(of, Text) and isinstance(key, Number | Unknown) else of


def moved(of: Sequence | Mapping, name: str, steps: list[Value]) -> Value | None:
    """Return the elements from an iterator on, for the iterator: `names.begin() + 1`, `names.end() - 1`."""
    begins = "begin" in name
    if not steps:
        return of if begins else None
    step = steps[0].whole if isinstance(steps[0], Number) else -1
    if not isinstance(of, Sequence) or of.repeated or step < 0 or (of.open and not begins):
        return None
    if step > len(of.items) and not of.open:
        return None
    return replace(of, items=of.items[step if begins else len(of.items) - step :])


def between(first: Sequence, last: Value) -> Sequence:
    """Return the elements between two iterators, each given as the elements from it on."""
    end = len(first.items) - len(last.items) if isinstance(last, Sequence) else 0
    return replace(first, items=first.items[:end], open=False) if end > 0 else first


def is_finite(of: Value) -> bool:
    """Check whether all elements of a container are known."""
    if isinstance(of, (Sequence, Mapping)):
        return not of.open and not is_unset(of)
    return letters(of) is not None


def grown(written: Written) -> Written:
    """Return what one turn of a loop wrote, where more turns can follow: lists that grew can grow further."""
    result = dict(written)
    for key, (holder, name, value) in written.items():
        before = holder.get(name)
        lists = before.items if isinstance(before, Either) else (before,)
        lengths = [len(one.items) for one in lists if isinstance(one, Sequence)]
        if isinstance(value, Sequence | Either) and lengths:
            result[key] = (holder, name, over((value,), partial(_longer, min(lengths))))
    return result


def counted_by(written: Written) -> list[tuple[Holder, str]]:
    """Return the variables and fields that one turn of a loop counted up or down."""
    counters: list[tuple[Holder, str]] = []
    for holder, name, value in written.values():
        before = holder.get(name)
        after = value.items if isinstance(value, Either) else (value,)
        if isinstance(before, Number):
            steps = {one.value - before.value for one in after if isinstance(one, Number)} - {0}
            if steps and steps <= {1, -1}:
                counters.append((holder, name))
    return counters


def _longer(length: int, of: Value) -> Value:
    """Return a list that has more than some elements as one that can grow further."""
    return replace(of, repeated=True) if isinstance(of, Sequence) and len(of.items) > length else of


def counted(loop: form.Loop) -> list[Expression]:
    """Return the variables that the body or the step of a loop increments."""
    targets: list[Expression] = []
    pending: list[object] = [loop.step, loop.body]
    while pending:
        one = pending.pop()
        if isinstance(one, form.Unary):
            if one.sign in ("++", "--"):
                targets.append(one.operand)
            pending.append(one.operand)
        elif isinstance(one, form.Assign):
            if one.sign in ("+", "-") or _counts(one):
                targets.append(one.target)
            pending.append(one.value)
        elif isinstance(one, form.Block):
            pending += one.body
        elif isinstance(one, form.Step):
            pending.append(one.value)
        elif isinstance(one, form.Binary):
            pending += one.operands
        elif isinstance(one, form.Call):
            pending += one.arguments
        elif isinstance(one, form.Branch):
            pending += [body for _, body in one.arms]
        elif isinstance(one, form.Try):
            pending += [one.body, *one.handlers]
    return targets


def _counts(assign: form.Assign) -> bool:
    """Check for `i = i + 1`."""
    value, target = assign.value, assign.target
    if not (isinstance(value, form.Binary) and value.sign in ("+", "-") and isinstance(target, form.Name)):
        return False
    first, *rest = value.operands
    steps = all(isinstance(one, form.Literal) and isinstance(one.value, float) for one in rest)
    return steps and isinstance(first, form.Name) and first.names == target.names
