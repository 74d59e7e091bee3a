"""What one side of a branch knows more: the alternatives that its condition leaves to variables."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, TypeVar

from kg.symbolic import form
from kg.symbolic.operators import compute
from kg.symbolic.values import Either, Truth, Value, Way, paths

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from kg.symbolic.form import Expression
    from kg.symbolic.machine import Machine
    from kg.symbolic.state import Frame, Journal, Written

_Result = TypeVar("_Result")
_PAIR: Final = 2
_OR: Final = ("||", "or")


def narrowed(machine: Machine, condition: Expression | None, frame: Frame) -> dict[str, Value]:
    """Return the variables of a frame of which a condition excludes alternatives, with those that it leaves.

    The condition compares a variable with values: what was chosen together with an excluded value is excluded, too.
    """
    ways = _ways(machine, condition, frame)
    if ways is None:
        return {}
    variables = {}
    for name, slot in frame.variables.items():
        if isinstance(slot, Either) and slot.ways:
            pairs = list(paths(slot))
            left = [pair for pair in pairs if any(_agree(pair[1], way) for way in ways)]
            if left and len(left) < len(pairs):
                variables[name] = _of(left)
    return variables


def attempt(
    journal: Journal, narrow: dict[str, Value], frame: Frame, run: Callable[[], _Result]
) -> tuple[Written, _Result]:
    """Run one side of a branch with variables that are narrower there; return what it wrote, and its result."""
    if not narrow:
        return journal.attempt(run)

    def inside() -> _Result:
        for name, value in narrow.items():
            journal.write(frame.variables, name, value)
        return run()

    written, result = journal.attempt(inside)
    for name, value in narrow.items():
        if written[id(frame.variables), name][2] is value:
            del written[id(frame.variables), name]
    return written, result


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
