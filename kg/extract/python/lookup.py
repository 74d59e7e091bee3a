"""What names and attributes mean: bindings that reach a place, parameters and callers, objects and their classes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.python.arguments import read_arguments
from kg.extract.python.containers import Containers, unpacked
from kg.extract.python.core import COMPUTED
from kg.extract.python.entities import (
    ArgumentsParsed,
    Bound,
    ClassRef,
    Dotted,
    FunctionRef,
    Instance,
    Items,
    Made,
    ModuleRef,
    Nothing,
    ParameterRead,
    Super,
    Table,
)
from kg.extract.python.flow import END, agreeing, reaching
from kg.extract.python.syntax import code
from kg.extract.python.unit import MODULE
from kg.extract.values import Number, Text, Truth, Unknown, concatenate

if TYPE_CHECKING:
    from collections.abc import Sequence

    from tree_sitter import Node

    from kg.extract.python.entities import Alternatives, Choice, Frame, Thing
    from kg.extract.python.unit import Binding, Scope

__all__ = ["Lookups"]

_NOT_BOUND: Final = Unknown("nothing in the code gives it a value")
_NO_CALLER: Final = Unknown("it is a parameter of a function whose callers are not known")
_MAX_BINDINGS: Final = 12
_NAME_FIELDS: Final = frozenset({"resolved_name", "name"})
_NAMED: Final = frozenset({"Publisher", "Subscriber", "ServiceProxy", "Service"})
_PARAMETER_FIELDS: Final = frozenset(
    {"value", "string_value", "integer_value", "double_value", "bool_value", "string_array_value", "double_array_value",
     "integer_array_value", "bool_array_value"}
)  # fmt: skip


class Lookups(Containers):
    """The part of the evaluator that finds out what names and attributes mean."""

    def name(self, name: str, position: int, frame: Frame, choice: Choice) -> Alternatives:
        """Return what a name means at a place in a frame, looking outwards through the scopes around it."""
        at: Frame | None = frame
        while at is not None:
            if not (at.scope.kind == "class" and at is not frame) and name not in at.scope.globals:
                found = self.local(name, position, at, choice)
                if found:
                    return found
            position, at = END, at.lexical
        return self.module_name(name, frame, choice)

    def module_name(self, name: str, frame: Frame, choice: Choice) -> Alternatives:
        """Return what a name means that no scope around the frame binds as a variable."""
        unit = frame.scope.unit
        static = self.program.global_name(unit, name)
        if static is not None:
            return [(static, choice)]
        module = self.program.module_frame(unit)
        found = self.local(name, END, module, choice) if frame is not module else []
        found = found or self.assigned_globally(name, module, choice)
        if found:
            return found
        for other in self.program.star_modules(unit):
            starred = self.local(name, END, self.program.module_frame(other), choice)
            if starred:
                return starred
        return [(self.outside_name(name, frame), choice)]

    def outside_name(self, name: str, frame: Frame) -> Thing:
        """Return a name that comes from `from package import *` outside of the build, or a builtin."""
        stars = [
            module for module in frame.scope.unit.stars if self.program.find_module(module, frame.scope.unit) is None
        ]
        return Dotted(self.program.starred_path(name, stars) or f"builtins.{name}")

    def assigned_globally(self, name: str, module: Frame, choice: Choice) -> Alternatives:
        """Return what functions assign to a name that they declare `global`."""
        found: Alternatives = []
        for scope in module.scope.unit.scopes:
            if name in scope.globals and name in scope.bindings:
                for frame in self.frames_of(scope, None):
                    found.extend(self.bound(scope.bindings[name], END, frame, choice)[0])
        return found

    def local(self, name: str, position: int, frame: Frame, choice: Choice) -> Alternatives:
        """Return what the frame's own scope gives to a name; nothing when it does not bind it."""
        scope = frame.scope
        found, certain = self.bound(scope.bindings.get(name, ()), position, frame, choice)
        if certain:
            return found
        if scope.kind == "function" and (name in scope.parameters.positional or self._is_rest(name, scope)):
            return found + self.parameter(name, frame, choice)
        if name in scope.functions:
            return [*found, (FunctionRef(scope.functions[name], frame), choice)]
        if name in scope.classes:
            return [*found, (ClassRef(scope.classes[name]), choice)]
        if not found and scope.bindings.get(name) and scope.name != MODULE:
            return self.bound(scope.bindings[name], END, frame, choice)[0]
        return found

    def _is_rest(self, name: str, scope: Scope) -> bool:
        return name in (scope.parameters.rest, scope.parameters.keywords)

    def bound(
        self, bindings: Sequence[Binding], position: int, frame: Frame, choice: Choice
    ) -> tuple[Alternatives, bool]:
        """Return what bindings that reach a place give, and whether one of them must hold there."""
        reached, certain = reaching(bindings, position, frame, choice)
        found: Alternatives = []
        for binding, after in reached[:_MAX_BINDINGS]:
            if self.possible(binding.arms, frame, choice):
                found.extend(self.binding(binding, frame, after))
        return found, certain

    def binding(self, binding: Binding, frame: Frame, choice: Choice) -> Alternatives:
        """Return what one binding gives to its name."""
        if binding.value is None:
            return [(COMPUTED, choice)]
        if binding.kind == "augment":
            values = self.augmented(binding, frame, choice)
        else:
            values = self.evaluate(binding.value, frame, choice)
        if binding.kind == "assign" and not binding.path:
            values = [(self.completed(value, binding, frame), after) for value, after in values]
        if binding.kind == "for":
            values = [row for value, after in values for row in self.each_round(binding, value, frame, after)]
        return [(_through(unpacked(value, binding.path)), after) for value, after in values]

    def augmented(self, binding: Binding, frame: Frame, choice: Choice) -> Alternatives:
        """Return what `name += value` leaves."""
        node = binding.value
        left = node.child_by_field_name("left") if node is not None else None
        right = node.child_by_field_name("right") if node is not None else None
        if node is None or left is None or right is None or code(node.child_by_field_name("operator")) != "+=":
            return [(COMPUTED, choice)]
        rows = self.combined((left, right), frame, choice)
        return [(_sum(values[0], values[1]), after) for values, after in rows]

    def parameter(self, name: str, frame: Frame, choice: Choice) -> Alternatives:
        """Return what a parameter of the frame's function can be."""
        scope = frame.scope
        if name == scope.receiver and name not in frame.arguments:
            return [(self._receiver(frame), choice)]
        if name == scope.parameters.rest:
            return [(Items(tuple(values)), after) for values, after in self.combined(frame.rest, frame, choice)]
        if name == scope.parameters.keywords:
            rows = self.combined(frame.keywords.values(), frame, choice)
            return [
                (Table(tuple(zip(map(Text.of, frame.keywords), values, strict=True))), after) for values, after in rows
            ]
        if name in frame.arguments:
            return [(_through(value), after) for value, after in self.thunk(frame.arguments[name], choice)]
        if frame.open:
            return self.from_callers(name, frame, choice)
        return self.default(name, frame, choice)

    def _receiver(self, frame: Frame) -> Thing:
        owner = frame.scope.owner
        if frame.instance is None and owner is not None and "classmethod" in frame.scope.decorators:
            return ClassRef(owner)
        if frame.instance is None and owner is not None:
            frame.instance = self.open_instance(owner)
        return frame.instance or _NO_CALLER

    def default(self, name: str, frame: Frame, choice: Choice) -> Alternatives:
        """Return the default value of a parameter that no argument was given for."""
        node = frame.scope.parameters.defaults.get(name)
        if node is None:
            return [(_NO_CALLER, choice)]
        around = frame.lexical or self.program.module_frame(frame.scope.unit)
        return [(_through(value), after) for value, after in self.evaluate(node, around, choice)]

    def from_callers(self, name: str, frame: Frame, choice: Choice) -> Alternatives:
        """Return what the calls of a function pass for a parameter, when its frame stands for all of them."""
        known = [other for other in self.frames_of(frame.scope, frame.instance) if not other.open]
        key = (frame.id, -1)
        found: Alternatives = []
        for index, other in enumerate(known):
            if choice.get(key, index) == index:
                found.extend(self.parameter(name, other, {**choice, key: index}))
        return found or self.default(name, frame, choice)

    def assigned_here(self, node: Node, frame: Frame, choice: Choice) -> Alternatives | None:
        """Return what `self.name` was given earlier in the same function, where it must have been."""
        bindings = frame.scope.bindings.get(code(node)) if frame.scope.bindings else None
        if not bindings:
            return None
        found, certain = self.bound(bindings, node.start_byte, frame, choice)
        return found if certain and found else None

    def member(self, value: Thing, name: str, frame: Frame, choice: Choice) -> Alternatives:
        """Return the attribute `name` of a value."""
        if isinstance(value, Instance):
            return self.instance_member(value, name, self.program.lineage(value.klass), choice)
        if isinstance(value, Super):
            lineage = self.program.lineage(value.instance.klass)
            rest = lineage[lineage.index(value.after) + 1 :] if value.after in lineage else lineage[1:]
            return self.instance_member(value.instance, name, rest, choice)
        if isinstance(value, ClassRef):
            return self.class_member(value.scope, name, choice)
        if isinstance(value, ModuleRef):
            return self.module_member(value, name, choice)
        if isinstance(value, ArgumentsParsed):
            return [(self.option(value, name), choice)]
        return [(self.outside_member(value, name, frame), choice)]

    def outside_member(self, value: Thing, name: str, frame: Frame) -> Thing:
        """Return an attribute of something that is not made in the build."""
        if isinstance(value, Dotted):
            return self.program.static_member(value, name, frame.scope.unit) or COMPUTED
        if isinstance(value, ParameterRead):
            return value.value if name in _PARAMETER_FIELDS else Bound(f"parameter.{name}", value)
        if isinstance(value, Made) and name in _NAME_FIELDS and value.path.rpartition(".")[2] in _NAMED:
            first = read_arguments(value.call, value.frame).get(0, "name")
            return self.thunk(first, {})[0][0] if first is not None else COMPUTED
        if isinstance(value, Made):
            return Bound(f"{value.path}.{name}", value)
        for kind, prefix in ((Text, "str"), (Items, "list"), (Table, "dict")):
            if isinstance(value, kind):
                return Bound(f"{prefix}.{name}", value)
        return Bound(f"?.{name}", value)

    def module_member(self, value: ModuleRef, name: str, choice: Choice) -> Alternatives:
        """Return a name of a module of the build."""
        static = self.program.static_member(value, name, value.unit)
        if static is not None:
            return [(static, choice)]
        return self.name(name, END, self.program.module_frame(value.unit), choice)

    def class_member(self, klass: Scope, name: str, choice: Choice) -> Alternatives:
        """Return an attribute of a class, from itself or the nearest base that has it."""
        for base in self.program.lineage(klass):
            if isinstance(base, Dotted):
                return [(Dotted(f"{base.path}.{name}"), choice)]
            around = self.program.scope_frame(base.parent) if base.parent else self.program.module_frame(base.unit)
            if name in base.functions:
                return [(FunctionRef(base.functions[name], around), choice)]
            if name in base.classes:
                return [(ClassRef(base.classes[name]), choice)]
            found = self.class_variable(base, name, choice)
            if found:
                return found
        return [(_NOT_BOUND, choice)]

    def class_variable(self, klass: Scope, name: str, choice: Choice) -> Alternatives:
        """Return what the body of a class gives to a name."""
        if name not in klass.bindings:
            return []
        around = self.program.scope_frame(klass.parent) if klass.parent else None
        return self.bound(klass.bindings[name], END, self.program.new_frame(klass, around), choice)[0]

    def instance_member(
        self, instance: Instance, name: str, lineage: list[Scope | Dotted], choice: Choice
    ) -> Alternatives:
        """Return an attribute of an object: a method, what methods assign to it, or a class variable."""
        outside = None
        for base in lineage:
            if isinstance(base, Dotted):
                outside = outside or base
            elif name in base.functions:
                return self.method(base.functions[name], instance, choice)
        found = self.assigned(instance, name, choice)
        for base in lineage:
            if not found and not isinstance(base, Dotted):
                found = self.class_variable(base, name, choice)
        if found:
            return found
        return [(Bound(f"{outside.path}.{name}", instance) if outside else _NOT_BOUND, choice)]

    def method(self, scope: Scope, instance: Instance, choice: Choice) -> Alternatives:
        """Return a method bound to its object, or what a property gives."""
        around = self.program.scope_frame(scope.parent.parent) if scope.parent and scope.parent.parent else None
        function = FunctionRef(scope, around or self.program.module_frame(scope.unit), instance)
        if any(name.endswith("property") for name in scope.decorators):
            return self.returned(function, None, self.program.module_frame(scope.unit), choice)
        return [(function, choice)]

    def assigned(self, instance: Instance, name: str, choice: Choice) -> Alternatives:
        """Return what the methods of an object's classes assign to its attribute."""
        key = ((id(instance), hash(name)), frozenset(choice.items()))
        if key not in self.memory:
            cuts = self.cuts
            found = self._assigned(instance, name, choice)
            if cuts != self.cuts and self.active:
                return found
            self.memory[key] = found
        return self.memory[key]

    def _assigned(self, instance: Instance, name: str, choice: Choice) -> Alternatives:
        found: Alternatives = []
        for klass in self.program.lineage(instance.klass):
            for method in self.setters(klass).get(name, ()) if not isinstance(klass, Dotted) else ():
                bindings = method.bindings[f"{method.receiver}.{name}"]
                for frame in self.frames_of(method, instance):
                    merged = agreeing(choice, frame.choice)
                    if merged is not None and len(found) < _MAX_BINDINGS:
                        found.extend(self.bound(bindings, END, frame, merged)[0])
        known = [row for row in found if not isinstance(row[0], Nothing | Unknown)]
        return known or found

    def setters(self, klass: Scope) -> dict[str, list[Scope]]:
        """Return, for each attribute of its objects, the methods of a class that assign it."""
        key = id(klass)
        if key not in self._setters:
            found: dict[str, list[Scope]] = {}
            for method in klass.functions.values():
                prefix = f"{method.receiver}."
                for bound_name in method.bindings:
                    if bound_name.startswith(prefix) and not bound_name.endswith("[]"):
                        found.setdefault(bound_name.removeprefix(prefix), []).append(method)
            self._setters[key] = found
        return self._setters[key]


def _through(value: Thing) -> Thing:
    return value.through_constant() if isinstance(value, Text) else value


def _sum(left: Thing, right: Thing) -> Thing:
    if isinstance(left, Items) and isinstance(right, Items):
        return Items(left.items + right.items)
    if isinstance(left, Text):
        return concatenate(left, right if isinstance(right, Text | Number | Truth | Unknown) else COMPUTED)
    return COMPUTED
