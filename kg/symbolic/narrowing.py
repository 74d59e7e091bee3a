"""What one side of a branch knows more: the alternatives that its condition leaves to variables, texts that are set."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, TypeAlias, TypeVar

from kg.facts import HOLDS
from kg.symbolic import form
from kg.symbolic.operators import compute, opposite_terms, terms_of, under
from kg.symbolic.state import Alias
from kg.symbolic.values import Either, Guard, Object, Text, Truth, Value, Way, paths

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from kg.symbolic.form import Expression, Statement
    from kg.symbolic.machine import Machine
    from kg.symbolic.state import Frame, Holder, Journal, Written

_Result = TypeVar("_Result")
Arm: TypeAlias = "tuple[Expression | None, Statement]"
"""A condition of a branch, and what runs under it."""
Slots: TypeAlias = "list[tuple[Holder, str, Value]]"
"""Variables with the values that they have on one side of a branch."""
_PAIR: Final = 2
_OR: Final = ("||", "or")
_AND: Final = ("&&", "and")
_NOT: Final = ("!", "not")
_SIZES: Final = ("len", "size", "length")
_POSITIVE: Final = {(">", 0), ("!=", 0), (">=", 1)}
_ZERO: Final = {("==", 0), ("<=", 0), ("<", 1)}
"""Comparisons of a size that say that it is zero."""


def narrowed(machine: Machine, arms: Sequence[Arm], frame: Frame) -> Slots:
    """Return the variables that are narrower in the last of some arms of a branch, with their values there.

    A condition that compares a variable with values leaves some of its alternatives: what was chosen together with an
    excluded value is excluded, too. A parameter whose default is empty has no default where a condition says it is set.
    """
    conditions = [(condition, False) for condition, _ in arms[:-1]]
    slots = _set(machine, [*conditions, (arms[-1][0], True)], frame)
    ways = _ways(machine, arms[-1][0], frame)
    for name, slot in frame.variables.items() if ways is not None else ():
        if isinstance(slot, Either) and slot.ways:
            pairs = list(paths(slot))
            left = [pair for pair in pairs if any(_agree(pair[1], way) for way in ways or ())]
            if left and len(left) < len(pairs):
                slots.append((frame.variables, name, _of(left)))
    return slots


def conditions_at(
    branch: form.Branch, condition: Expression | None, holds: Value, frame: Frame, before: tuple[str, ...]
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the term of a side of a branch that something other than parameters decides, and that of later sides.

    Either is empty where parameters decide. `before` is what the side before gives to later ones.
    """
    if before:
        return before, before
    if isinstance(holds, Truth):
        return (), ()
    line = branch.line if condition is None or isinstance(condition, form.Type) else condition.line
    term = f"{frame.unit.key.path}:{line} {HOLDS}"
    whole = isinstance(holds, Guard) and holds.whole
    return () if whole and terms_of(holds) else (term,), () if whole and opposite_terms(holds) else (f"!{term}",)


def exclude(machine: Machine, journal: Journal, arms: Sequence[Arm], ends: Sequence[str | None], frame: Frame) -> None:
    """Write what the conditions of arms leave to variables after a branch, as these arms were left before its end."""
    left = [(condition, False) for (condition, _), end in zip(arms, ends, strict=False) if end is not None]
    for holder, name, value in _set(machine, left, frame):
        journal.write(holder, name, value)


def attempt(journal: Journal, narrow: Slots, run: Callable[[], _Result]) -> tuple[Written, _Result]:
    """Run one side of a branch with variables that are narrower there; return what it wrote, and its result."""
    if not narrow:
        return journal.attempt(run)

    def inside() -> _Result:
        for holder, name, value in narrow:
            journal.write(holder, name, value)
        return run()

    written, result = journal.attempt(inside)
    for holder, name, value in narrow:
        if written[id(holder), name][2] is value:
            del written[id(holder), name]
    return written, result


def _set(machine: Machine, conditions: Iterable[tuple[Expression | None, bool]], frame: Frame) -> Slots:
    """Return the parameters with an empty default that are set under conditions that hold or not, without default."""
    slots: Slots = []
    for condition, holds in conditions:
        for one in _filled(condition, holds=holds):
            holder, name = _slot(machine, one, frame)
            value = holder.get(name)
            if isinstance(value, Text) and value.exact == "" and value.parameter is not None:
                slots.append((holder, name, under(value, (value.parameter,))))
    return slots


def _filled(condition: Expression | None, *, holds: bool) -> Iterator[Expression]:
    """Yield the variables whose texts are not empty if a condition holds, or does not."""
    if isinstance(condition, form.Unary) and condition.sign in _NOT:
        yield from _filled(condition.operand, holds=not holds)
    elif isinstance(condition, form.Binary) and condition.sign in (_AND if holds else _OR):
        for one in condition.operands:
            yield from _filled(one, holds=holds)
    elif isinstance(condition, form.Binary) and len(condition.operands) == _PAIR:
        measured, other = condition.operands
        limit = other.value if isinstance(other, form.Literal) else None
        if limit == "" and condition.sign == ("!=" if holds else "=="):
            yield measured
        elif (condition.sign, limit) in (_POSITIVE if holds else _ZERO) and (of := _measured(measured, _SIZES)):
            yield of
    elif isinstance(condition, form.Call) and not holds and (of := _measured(condition, ("empty",))):
        yield of
    elif isinstance(condition, form.Name | form.Member) and holds:
        yield condition


def _measured(call: Expression, names: tuple[str, ...]) -> Expression | None:
    """Return the variable of which a call of some name gives the size; None for others."""
    if not isinstance(call, form.Call):
        return None
    if isinstance(call.function, form.Member) and call.function.name in names and not call.arguments:
        return call.function.of
    named = isinstance(call.function, form.Name) and call.function.names[-1] in names
    return call.arguments[0] if named and len(call.arguments) == 1 else None


def _slot(machine: Machine, variable: Expression, frame: Frame) -> tuple[Holder, str]:
    """Return where the value of a variable, or of a member of an object, is stored."""
    if isinstance(variable, form.Name) and len(variable.names) == 1:
        name = variable.names[0]
        holder = frame.holder(name)
        if holder is not None:
            slot = holder[name]
            return _slot(machine, slot.target, slot.frame) if isinstance(slot, Alias) else (holder, name)
        this = next((one.this for one in frame.outward() if one.this is not None), None)
        return (this.fields if isinstance(this, Object) else {}), name
    if isinstance(variable, form.Member) and isinstance(variable.of, form.Name | form.Member):
        of = machine.value(variable.of, frame)
        return (of.fields if isinstance(of, Object) else {}), variable.name
    return {}, ""


def _ways(machine: Machine, condition: Expression | None, frame: Frame) -> list[Way] | None:
    """Return the choices under which a condition can hold; None if it excludes none."""
    if not isinstance(condition, form.Binary):
        return None
    if condition.sign in _OR:
        listed = [_ways(machine, one, frame) for one in condition.operands]
        return [way for ways in listed for way in ways or ()] if None not in listed else None
    names = [one for one in condition.operands if isinstance(one, form.Name) and len(one.names) == 1]
    if condition.sign != "==" or len(condition.operands) != _PAIR or not names:
        return None
    values = [machine.value(one, frame) for one in condition.operands]
    either = next((one for one in values if isinstance(one, Either) and one.ways), None)
    if either is None:
        return None
    other = values[1] if values[0] is either else values[0]
    if isinstance(other, Either):
        return None
    pairs = list(paths(either))
    ways = [way for item, way in pairs if compute("==", (item, other)) != Truth(False)]
    return ways if len(ways) < len(pairs) else None


def _agree(one: Way, other: Way) -> bool:
    """Return whether two ways take the same option of each choice that both have."""
    options = dict(other)
    return all(options.get(choice, option) == option for choice, option in one)


def _of(pairs: Iterable[tuple[Value, Way]]) -> Value:
    items, ways = zip(*pairs, strict=True)
    return items[0] if len(items) == 1 else Either(items, ways)
