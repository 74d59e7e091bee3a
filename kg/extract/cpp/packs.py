"""Expansions of parameter packs in C++: `f(names)...` and the fold `(add<Types>(), ...)`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.symbolic import form
from kg.symbolic.state import Frame
from kg.symbolic.values import Pack, Unknown, Value, number

if TYPE_CHECKING:
    from kg.extract.cpp.language import Cpp


def expand(language: Cpp, spread: form.Spread, frame: Frame) -> Value:
    """Return the values of an expression for each element of the packs in it, and perform the effects of each."""
    variables: dict[str, Pack] = {}
    types: dict[str, Pack] = {}
    for name in _names(spread.of):
        holder = frame.holder(name)
        value, bound = holder[name] if holder is not None else None, frame.bound_type(name)
        if isinstance(value, Pack):
            variables[name] = value
        elif isinstance(bound, Pack):
            types[name] = bound
    packs = [*variables.values(), *types.values()]
    if not packs:
        return language.machine.value(spread.of, frame)
    values: list[Value] = []
    for index in range(min(len(pack.items) for pack in packs)):
        inner = Frame(frame.unit, frame.scope, frame.this, parent=frame)
        inner.variables |= {name: pack.items[index] for name, pack in variables.items()}
        inner.types |= {name: pack.items[index] for name, pack in types.items()}
        values.append(language.machine.value(spread.of, inner))
    return Pack(tuple(values))


def count(frame: Frame, name: str) -> Value:
    """Return how many elements a pack has: `sizeof...(name)`."""
    holder = frame.holder(name)
    pack = holder[name] if holder is not None else frame.bound_type(name)
    if pack is None:
        return Unknown("the number of arguments is not known")
    return number(float(len(pack.items) if isinstance(pack, Pack) else 1))


def _names(of: object) -> set[str]:
    """Return the names of variables and types in an expression."""
    names: set[str] = set()
    pending = [of]
    while pending:
        one = pending.pop()
        if isinstance(one, tuple):
            pending += one
        elif isinstance(one, form.Name | form.Type):
            names.update(one.names[:1])
        if not isinstance(one, (str, float, form.Function)) and hasattr(one, "__slots__"):
            pending += [getattr(one, slot) for slot in one.__slots__]
    return names
