"""What code a node can run at all: everything named, from its root on, and which part of that can declare anything.

Names decide here, so the answer errs on the large side; which of it is really called is found by
`kg.extract.python.walk`, which runs only what is relevant.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.extract.python.api import API_NAMES, METHOD_NAMES, find_api
from kg.extract.python.entities import Dotted
from kg.extract.python.naming import named_scopes

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.extract.python.program import Program
    from kg.extract.python.unit import CallSite, Scope, Unit

__all__ = ["Reach", "reach"]


class Reach:
    """The scopes that are named from the roots on; `relevant` are those that can lead to a declaration."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.scopes: dict[int, Scope] = {}
        self.callers: dict[int, set[int]] = {}
        self.relevant: set[int] = set()
        self.units: dict[int, Unit] = {}
        self.methods: dict[str, list[Scope]] = {}
        self.done: list[Scope] = []
        self.deferred: dict[int, list[tuple[Scope, Scope]]] = {}
        self.pending: list[Scope] = []

    def grow(self, roots: Iterable[Scope]) -> None:
        """Add everything that is named from the roots on."""
        for root in roots:
            self.add(root, None)
        while self.pending:
            self.follow(self.pending.pop())
        self.mark_relevant()

    def add(self, scope: Scope, source: Scope | None) -> None:
        """Add a scope that `source` names; a method waits until its class is named."""
        owner = scope.owner
        if owner is not None and id(owner) not in self.scopes and source is not None:
            self.deferred.setdefault(id(owner), []).append((scope, source))
            return
        if id(scope) not in self.scopes:
            self.scopes[id(scope)] = scope
            self.pending.append(scope)
            for method, namer in self.deferred.pop(id(scope), ()):
                self.add(method, namer)
        if source is not None:
            self.callers.setdefault(id(scope), set()).add(id(source))

    def enter(self, unit: Unit) -> None:
        """Learn the methods of a file; those that were named before it was known are reached now."""
        if id(unit) in self.units:
            return
        self.units[id(unit)] = unit
        fresh: dict[str, list[Scope]] = {}
        for klass in unit.classes:
            for name, method in klass.functions.items():
                fresh.setdefault(name, []).append(method)
        for name, methods in fresh.items():
            self.methods.setdefault(name, []).extend(methods)
        for source in list(self.done):
            for name in sorted(source.words & fresh.keys()):
                for method in fresh[name]:
                    self.add(method, source)

    def follow(self, scope: Scope) -> None:
        """Add all that a scope names."""
        self.enter(scope.unit)
        self.done.append(scope)
        for target in named_scopes(self.program, scope):
            self.enter(target.unit)
            self.add(target, scope)
        for name in sorted(scope.words & self.methods.keys()):
            for method in self.methods[name]:
                self.add(method, scope)

    def mark_relevant(self) -> None:
        """Find the scopes that call something of the tables, and all that name them, directly or not."""
        pending = [
            key for key, scope in self.scopes.items() if key not in self.relevant and _declares(self.program, scope)
        ]
        while pending:
            key = pending.pop()
            if key not in self.relevant:
                self.relevant.add(key)
                pending.extend(self.callers.get(key, ()))

    def sites(self) -> dict[str, list[tuple[Scope, CallSite]]]:
        """Return all calls in the code that was reached, by the last word of what is called."""
        found: dict[str, list[tuple[Scope, CallSite]]] = {}
        for scope in self.scopes.values():
            for call in scope.calls:
                found.setdefault(call.name, []).append((scope, call))
        return found


def reach(program: Program, roots: Iterable[Scope]) -> Reach:
    """Return what is reached from the roots."""
    found = Reach(program)
    found.grow(roots)
    return found


def _declares(program: Program, scope: Scope) -> bool:
    """Tell whether a scope itself calls something of the tables, as far as names tell."""
    imports = scope.unit.imports
    for call in scope.calls:
        alias = imports.get(call.name)
        named = call.name in API_NAMES or (alias is not None and alias.attribute in API_NAMES)
        if named and _calls_api(program, scope, call):
            return True
    return scope.owner is not None and scope.name == "__init__" and _has_declaring_base(program, scope.owner)


def _calls_api(program: Program, scope: Scope, call: CallSite) -> bool:
    called = call.node.child_by_field_name("function")
    value = program.static(called, scope) if called is not None else None
    if isinstance(value, Dotted):
        if find_api(value.path, bound=False) is not None:
            return True
        local = called is not None and called.type == "attribute"
        return local and call.name in METHOD_NAMES
    if value is None:
        return call.name in METHOD_NAMES or (called is not None and called.type == "identifier")
    return False


def _has_declaring_base(program: Program, klass: Scope) -> bool:
    bases = program.lineage(klass)
    return any(isinstance(base, Dotted) and find_api(base.path, bound=False) is not None for base in bases)
