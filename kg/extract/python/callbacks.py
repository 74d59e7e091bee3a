"""What callbacks of Python can have changed where a program waits for them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Final

from kg.symbolic.state import decides
from kg.symbolic.values import Closure, Object, Unknown

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.symbolic.form import Function
    from kg.symbolic.machine import Machine
    from kg.symbolic.state import Frame

WAITING: Final = frozenset(
    {"spin_once", "spin_until_future_complete", "sleep", "wait", "wait_for_service", "wait_for_server"}
)
"""Functions and methods during which callbacks run."""
_ASSIGNED: Final = re.compile(rb"\b(\w+)\.(\w+)\s*(?:[-+*/|&]|//)?=(?!=)")
_FILLED: Final = re.compile(rb"\b(\w+)\.(\w+)\.(?:append|appendleft|extend|insert|add|update|put)\(")
_OUTER: Final = re.compile(rb"\b(?:nonlocal|global)\s+(\w+(?:\s*,\s*\w+)*)")
_CHANGED: Final = Unknown("a callback changes it")


class Callbacks:
    """What the functions of a program that a framework calls can change, as far as they were registered."""

    def __init__(self) -> None:
        self._changes: dict[Function, tuple[list[tuple[str, str]], list[str]]] = {}
        """The attributes and the variables around it that a function assigns or fills."""
        self._fields: dict[tuple[int, str], dict[str, Any]] = {}
        """The fields of objects that functions are bound to, by the identity of these and the name of the field."""
        self._around: dict[tuple[int, int], tuple[Frame, list[tuple[str, str]], list[str]]] = {}
        """The same for objects and variables around functions, which are looked up each time."""

    def register(self, called: Closure) -> None:
        """Add a function."""
        attributes, variables = self._assigned(called.function)
        own = {one.name: value for one, value in zip(called.function.parameters, called.bound, strict=False)}
        outer: list[tuple[str, str]] = []
        for of, name in attributes:
            instance = own.get(of)
            if isinstance(instance, Object):
                self._fields[id(instance.fields), name] = instance.fields
            elif of not in own:
                outer.append((of, name))
        if outer or variables:
            self._around[id(called.function), id(called.frame)] = (called.frame, outer, variables)

    def run(self, machine: Machine) -> None:
        """Make unknown what the functions can have changed and what decides conditions."""
        for holder, name in [*((holder, name) for (_, name), holder in self._fields.items()), *self._variables()]:
            value = holder.get(name)
            if value is not None and value is not _CHANGED and decides(value):
                machine.write(holder, name, _CHANGED)

    def _assigned(self, function: Function) -> tuple[list[tuple[str, str]], list[str]]:
        """Return the attributes and the variables around it that a function assigns or fills."""
        if function not in self._changes:
            text = getattr(function.source, "text", None) or b""
            found = (*_ASSIGNED.findall(text), *_FILLED.findall(text))
            attributes = [(of.decode(), name.decode()) for of, name in found]
            variables = [name.strip().decode() for names in _OUTER.findall(text) for name in names.split(b",")]
            self._changes[function] = (attributes, variables)
        return self._changes[function]

    def _variables(self) -> Iterator[tuple[dict[str, Any], str]]:
        """Yield the fields of objects around functions, and the variables around them, each with a name among them."""
        for frame, attributes, variables in self._around.values():
            for of, name in attributes:
                holder = frame.holder(of)
                instance = holder[of] if holder is not None else None
                if isinstance(instance, Object):
                    yield instance.fields, name
            for name in variables:
                holder = frame.holder(name)
                if holder is not None:
                    yield holder, name
