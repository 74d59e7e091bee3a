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

WAITING: Final = frozenset(
    {"spin_once", "spin_until_future_complete", "sleep", "wait", "wait_for_service", "wait_for_server"}
)
"""Functions and methods during which callbacks run."""
_ASSIGNED: Final = re.compile(rb"\b(\w+)\.(\w+)\s*(?:[-+*/|&]|//)?=(?!=)")
_FILLED: Final = re.compile(rb"\b(\w+)\.(\w+)\.(?:append|appendleft|extend|insert|add|update|put)\(")
_OUTER: Final = re.compile(rb"\b(?:nonlocal|global)\s+(\w+(?:\s*,\s*\w+)*)")
_CHANGED: Final = Unknown("a callback changes it")


class Callbacks:
    """The functions of a program that a framework calls, as far as they were registered."""

    def __init__(self) -> None:
        self._registered: dict[tuple[int, ...], Closure] = {}
        self._changes: dict[Function, tuple[list[tuple[str, str]], list[str]]] = {}
        """The attributes and the variables around it that a function assigns or fills."""

    def register(self, called: Closure) -> None:
        """Add a function."""
        self._registered[id(called.function), *map(id, called.bound)] = called

    def run(self, machine: Machine) -> None:
        """Make unknown what the functions can have changed and what decides conditions."""
        for called in self._registered.values():
            for holder, name in self._changed(called):
                if name in holder and decides(holder[name]):
                    machine.write(holder, name, _CHANGED)

    def _changed(self, called: Closure) -> Iterator[tuple[dict[str, Any], str]]:
        """Yield what a function assigns outside of it: the variables of an object or a frame, and a name among them."""
        function = called.function
        if function not in self._changes:
            text = getattr(function.source, "text", None) or b""
            found = (*_ASSIGNED.findall(text), *_FILLED.findall(text))
            attributes = [(of.decode(), name.decode()) for of, name in found]
            variables = [name.strip().decode() for names in _OUTER.findall(text) for name in names.split(b",")]
            self._changes[function] = (attributes, variables)
        attributes, variables = self._changes[function]
        own = {one.name: value for one, value in zip(function.parameters, called.bound, strict=False)}
        for of, name in attributes:
            holder = called.frame.holder(of)
            instance = own.get(of) or (holder[of] if holder is not None else None)
            if isinstance(instance, Object):
                yield instance.fields, name
        for name in variables:
            holder = called.frame.holder(name)
            if holder is not None:
                yield holder, name
