"""What code a node can run at all: everything named, from its root on, and which part of that can declare anything.

Names decide here, so the answer errs on the large side; which of it is really called is found by
`kg.extract.python.walk`, which runs only what is relevant.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.extract.python.api import API_NAMES, METHOD_NAMES, find_api
from kg.extract.python.entities import ClassRef, Dotted, FunctionRef, ModuleRef
from kg.extract.python.program import mentions_ros

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.extract.python.entities import Thing
    from kg.extract.python.program import Program
    from kg.extract.python.unit import CallSite, Scope, Unit

__all__ = ["Reach", "reach"]

_PLAIN_BASES = frozenset({"builtins.object", "rclpy.node.Node", "enum.Enum", "builtins.Exception"})


class Reach:
    """The scopes that are named from the roots on; `relevant` are those that can lead to a declaration."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.scopes: dict[int, Scope] = {}
        self.callers: dict[int, set[int]] = {}
        self.relevant: set[int] = set()
        self.units: dict[int, Unit] = {}
        self.methods: dict[str, list[Scope]] = {}
        self.waiting: dict[str, set[int]] = {}
        self.deferred: dict[int, list[tuple[Scope, Scope]]] = {}
        self.pending: list[Scope] = []

    def grow(self, roots: Iterable[Scope]) -> None:
        """Add everything that is named from the roots on."""
        for root in roots:
            self.add(root, None)
        while self.pending:
            scope = self.pending.pop()
            self.enter(scope.unit)
            for target in self.targets(scope):
                self.add(target, scope)
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
        for klass in unit.classes:
            for name, method in klass.functions.items():
                self.methods.setdefault(name, []).append(method)
                for source in self.waiting.get(name, ()):
                    self.add(method, self.scopes[source])

    def targets(self, scope: Scope) -> Iterator[Scope]:
        """Yield the scopes that a scope names or, as a class or module, brings with it.

        Code that looks names up in `globals()` names every class of its file.
        """
        words = {word.decode("utf-8", "replace") for word in scope.words}
        if scope.kind == "class":
            yield from self.of_class(scope)
        elif scope.kind == "module":
            yield from self.of_module(scope.unit)
        around: Scope | None = scope
        while around is not None:
            yield from (inner for name, inner in around.functions.items() if name in words and around.kind != "class")
            yield from (inner for name, inner in around.classes.items() if name in words)
            around = around.parent
        if "globals" in words:
            yield from scope.unit.module.classes.values()
        yield from self.through_imports(scope.unit, words)
        for word in words:
            self.waiting.setdefault(word, set()).add(id(scope))
            yield from self.methods.get(word, ())

    def of_class(self, klass: Scope) -> Iterator[Scope]:
        """Yield what a class runs without being asked by name: its special methods and what a base outside calls."""
        lineage = self.program.lineage(klass)
        foreign = any(isinstance(base, Dotted) and base.path not in _PLAIN_BASES for base in lineage)
        for base in lineage:
            if isinstance(base, Dotted):
                continue
            if base is not klass:
                self.enter(base.unit)
                yield base
            for name, method in base.functions.items():
                if foreign or name.startswith("__"):
                    yield method

    def of_module(self, unit: Unit) -> Iterator[Scope]:
        """Yield the modules that a module imports, as far as they can declare anything."""
        for name in list(unit.imports):
            value = self.program.global_name(unit, name)
            other = _unit_of(value)
            if other is not None and mentions_ros(other.source):
                yield other.module
        for other in self.program.star_modules(unit):
            if mentions_ros(other.source):
                yield other.module

    def through_imports(self, unit: Unit, words: set[str]) -> Iterator[Scope]:
        """Yield functions and classes that are named through imports."""
        for name in words & unit.imports.keys():
            value = self.program.global_name(unit, name)
            if isinstance(value, ClassRef | FunctionRef):
                yield value.scope
            elif isinstance(value, ModuleRef):
                yield from self.members(value.unit, words)
        for other in self.program.star_modules(unit):
            yield from self.members(other, words)

    def members(self, unit: Unit, words: set[str], depth: int = 3) -> Iterator[Scope]:
        """Yield what is named of a module: its functions and classes, what it imports, modules below it."""
        for word in words:
            value = self.program.global_name(unit, word) or self.program.submodule(unit, word)
            if isinstance(value, ClassRef | FunctionRef):
                yield value.scope
            elif isinstance(value, ModuleRef) and depth and value.unit is not unit:
                yield from self.members(value.unit, words, depth - 1)

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


def _unit_of(value: Thing | None) -> Unit | None:
    if isinstance(value, ModuleRef):
        return value.unit
    return value.scope.unit if isinstance(value, ClassRef | FunctionRef) else None
