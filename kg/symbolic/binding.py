"""Binding of values to variables: parameters of functions, and targets of loops."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final, cast

from kg.symbolic import form
from kg.symbolic.values import (
    Either,
    Mapping,
    Number,
    Object,
    Pack,
    Sequence,
    Text,
    Truth,
    Unknown,
    Value,
    alternatives,
    join,
    number,
)

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.symbolic.form import Expression, Function, Parameter
    from kg.symbolic.language import Language
    from kg.symbolic.machine import Machine
    from kg.symbolic.state import Frame

_AWAITED: Final = Unknown("a loop waits until other code changes it")
_ASSIGNING: Final = (form.Assign, form.Unary, form.Loop, form.Try)
_FIRST: Final = form.Literal(0, 0.0, "0")
_HANDED: Final = frozenset({Text, Number, Truth, Sequence, Mapping, Either})
"""Values that a function gives back through references; objects are the same ones already."""


def bind(
    machine: Machine, function: Function, frame: Frame, arguments: list[Value], given: tuple[Expression, ...] = ()
) -> None:
    """Set the parameters of a function to arguments, to their defaults, or to unknown values.

    Those that have a value already keep it. `given` are the arguments as expressions.
    """
    for index, parameter in enumerate(function.parameters):
        if parameter.name in frame.variables:
            continue
        if parameter.variadic:
            frame.variables[parameter.name] = Pack(tuple(arguments[index:]))
            return
        if not parameter.name:
            continue
        kind = parameter.type
        if kind is not None:
            frame.declared[parameter.name] = kind
        if index < len(arguments) and not parameter.named:
            plain = kind is not None and kind.name != "auto" and kind.name not in function.template
            written = given[index] if plain and len(given) == len(arguments) else None
            frame.variables[parameter.name] = machine.language.converted(arguments[index], kind, written, frame)
        elif parameter.default is not None:
            default = machine.value(parameter.default, frame)
            frame.variables[parameter.name] = machine.language.converted(default, kind, None, frame)
        else:
            frame.variables[parameter.name] = machine.language.unknown(kind, frame, parameter.name)


def hand_back(
    machine: Machine, rows: Iterable[tuple[Parameter, Expression, Value]], frame: Frame, caller: Frame
) -> bool:
    """Write what a function left in its reference parameters to the arguments of its caller.

    `rows` has for each parameter its argument as an expression, and the value that this had. Return whether a text is
    among what was written.
    """
    text = False
    for parameter, expression, before in rows:
        kind = parameter.type
        if not parameter.name or kind is None or not (kind.reference or kind.pointer) or kind.constant:
            continue
        value = frame.variables.get(parameter.name)
        unknown = isinstance(value, Unknown) and not kind.pointer and (isinstance(before, Text) or value.parameter)
        if type(value) in _HANDED or unknown:
            put(machine, expression, cast("Value", value), caller)
            text = text or (type(value) is Text and value is not before)
    return text


def leave_open(machine: Machine, rows: Iterable[tuple[Parameter, Expression, Value]], caller: Frame) -> None:
    """Make unknown what a function that does not run may fill for its caller: conditions, empty containers and texts.

    `rows` are as those of `hand_back`.
    """
    for parameter, expression, value in rows:
        kind = parameter.type
        if kind is None or not kind.reference or kind.constant:
            continue
        if isinstance(value, (Number, Truth)) and value.parameter is None:
            put(machine, expression, Unknown("a function that was not run may change it"), caller)
        elif isinstance(value, (Sequence, Mapping)) and not value.items and value.parameter is None:
            put(machine, expression, replace(value, open=True), caller)
        elif isinstance(value, Text) and value.exact == "" and value.parameter is None:
            put(machine, expression, replace(value, unsure=True), caller)


def write_back(machine: Machine, loop: form.Loop, index: int, frame: Frame) -> None:
    """Write a target that is a reference to the element that it means."""
    kind, over = loop.declared, loop.over
    if kind is None or not kind.reference or kind.constant or len(loop.targets) != 1:
        return
    value = frame.variables.get(loop.targets[0])
    if isinstance(over, (form.Name, form.Member)) and isinstance(value, (Text, Number, Truth, Sequence, Mapping)):
        machine.assign(form.Index(loop.line, over, form.Literal(loop.line, float(index), str(index))), value, frame)


def bind_targets(machine: Machine, loop: form.Loop, item: Value, frame: Frame) -> None:
    """Set the variables of a loop over a collection to an element."""
    if len(loop.targets) == 1:
        name, kind = loop.targets[0], loop.declared
        if kind is not None and loop.over is not None:
            frame.declared[name] = kind
            item = machine.language.converted(item, kind, form.Index(loop.line, loop.over, _FIRST), frame)
        machine.write(frame.variables, name, item)
        return
    parts = machine.language.elements(item)
    for index, name in enumerate(loop.targets):
        value = parts[index] if len(parts) == len(loop.targets) else Unknown("it is a part of an unknown value")
        machine.write(frame.variables, name, value)


def unpack(machine: Machine, targets: tuple[Expression, ...], value: Value, frame: Frame) -> None:
    """Set several targets to the elements of a collection."""
    count = len(targets)
    star = next((index for index, one in enumerate(targets) if isinstance(one, form.Spread)), None)
    for index, target in enumerate(targets):
        if isinstance(target, form.Spread):
            part = partial(_rest_of, index, count - 1)
            target = target.of  # noqa: PLW2901 - what takes the rest
        elif star is not None:
            part = partial(_part_at, machine.language, number(index if index < star else index - count), None)
        else:
            part = partial(_part_at, machine.language, number(index), count)
        machine.assign(target, machine.over((value,), part), frame)


def _part_at(language: Language, index: Number, count: int | None, of: Value) -> Value:
    """Return an element of a collection that is unpacked into `count` targets."""
    row = language.elements(of)
    return row[index.whole] if len(row) == count else language.element(of, index)


def _rest_of(before: int, others: int, of: Value) -> Value:
    """Return the elements of a collection that `others` targets leave, of which some are before."""
    if not isinstance(of, Sequence) or of.open or len(of.items) < others:
        return Unknown("it is the rest of a collection")
    return Sequence(of.items[before : len(of.items) - others + before])


def forget_awaited(machine: Machine, loop: form.Loop, condition: Expression, frame: Frame) -> None:
    """Forget the flags in the condition of a loop that assigns nothing: other code, such as a callback, ends it."""
    flags: list[form.Name | form.Member] = []
    pending = [condition] if _assigns_nothing(loop.body) else []
    while pending:
        one = pending.pop()
        if isinstance(one, form.Unary):
            pending.append(one.operand)
        elif isinstance(one, form.Binary):
            pending += one.operands
        elif isinstance(one, (form.Name, form.Member)):
            value = machine.value(one, frame)
            flags += [one] if isinstance(value, Truth) and value.parameter is None else []
    holds = machine.holds(condition, frame) if flags else Truth(False)
    if not isinstance(holds, Truth) or holds.value:
        for flag in flags:
            machine.assign(flag, _AWAITED, frame)


def _assigns_nothing(body: form.Statement) -> bool:
    """Check whether a body only calls functions, under conditions or not."""
    pending: list[object] = [body]
    while pending:
        one = pending.pop()
        if isinstance(one, form.Block):
            pending += one.body
        elif isinstance(one, form.Branch):
            pending += [inner for _, inner in one.arms]
        elif isinstance(one.value if isinstance(one, form.Step) else one, _ASSIGNING):
            return False
    return True


def put(machine: Machine, expression: Expression, value: Value, frame: Frame) -> None:
    """Write a value to the variable that is passed as an output argument."""
    while isinstance(expression, form.Unary) and expression.sign in ("&", "*"):
        expression = expression.operand
    if isinstance(expression, (form.Name, form.Member, form.Index)):
        machine.assign(expression, value, frame)


def assign_member(machine: Machine, target: form.Member, value: Value, frame: Frame) -> None:
    """Set a member of an object or class, or of the alternatives that an expression stands for."""
    owners = alternatives(machine.value(target.of, frame))
    for of in owners:
        fields = of.fields if isinstance(of, Object) else machine.language.static_fields(of)
        if fields is not None:
            before = fields.get(target.name, value)
            machine.write(fields, target.name, value if len(owners) == 1 else join(before, value))
        if fields is None or (isinstance(of, Object) and of.kind.cls is None):
            machine.language.escape([value])  # code outside of the sources calls what its objects hold
