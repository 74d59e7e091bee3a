"""Functions that code outside of the sources calls later: callbacks, threads."""

from __future__ import annotations

from contextlib import contextmanager
from functools import partial
from typing import TYPE_CHECKING, Final, cast

from kg.extract.cpp.kinds import frame_of, this_of
from kg.extract.cpp.library import TEXTS
from kg.symbolic.form import Type
from kg.symbolic.operators import NULL
from kg.symbolic.state import Frame, Holder, decides
from kg.symbolic.values import (
    PLACEHOLDER,
    Bound,
    Closure,
    Either,
    Kind,
    Mapping,
    Number,
    Object,
    Sequence,
    Text,
    Truth,
    TypeValue,
    Unknown,
    Value,
    alternatives,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.extract.cpp.language import Cpp
    from kg.extract.cpp.units import CppClass
    from kg.symbolic.form import Class, Function, Parameter

_WITHOUT: Final = frozenset({Text, Number, Truth, Unknown, Sequence, Mapping, TypeValue})
"""Values that are not functions, nor objects with methods."""
_HELPERS: Final = frozenset({"std", "boost"})
"""Namespaces whose base classes add something to a class, and call nothing of it."""
_SET: Final = Unknown("a method of the object may have set it")
_OPEN: Final = TEXTS | {"auto", "char", "function"}
"""Types whose values can be names, or functions with effects."""
_MOST_PARTS: Final = 64
"""How many objects that belong to one are looked through for what a callback changes."""


def _holds_text(kind: Type) -> bool:
    """Check whether values of a type are texts, or contain some."""
    return kind.name in TEXTS or any(isinstance(one, Type) and _holds_text(one) for one in kind.arguments)


def _is_flag(value: object) -> bool:
    """Check whether a value is a truth value, not that of a parameter, or a null pointer."""
    return value == NULL or (isinstance(value, Truth) and value.parameter is None)


def closure_frame(called: Closure) -> Frame:
    """Return a new frame for a lambda, within the variables around it."""
    outer = called.frame
    return Frame(outer.unit, outer.scope, outer.this, parent=outer)


def _parts(of: Object) -> list[Object]:
    """Return an object of the sources, and those that it holds."""
    parts = [of]
    for one in parts:
        members = (value for value in one.fields.values() if isinstance(value, Object) and value.kind.cls is not None)
        parts += [value for value in dict.fromkeys(members) if value not in parts][: _MOST_PARTS - len(parts)]
    return parts


def _callables(of: Object) -> list[tuple[str, Closure | Bound]]:
    """Return the functions that an object and what it holds have, each with the name of the field."""
    callables: list[tuple[str, Closure | Bound]] = []
    seen = {id(of)}
    pending = [of]
    while pending and len(seen) < _MOST_PARTS:
        for name, field in pending.pop().fields.items():
            for value in _elements(field):
                if isinstance(value, Closure | Bound):
                    callables.append((name, value))
                elif isinstance(value, Object) and value.kind.cls is not None and id(value) not in seen:
                    seen.add(id(value))
                    pending.append(value)
    return callables


def _elements(value: object) -> Iterator[object]:
    """Yield a value and, of a container, the values in it."""
    if isinstance(value, Sequence | Either):
        for item in value.items:
            yield from _elements(item)
    elif isinstance(value, Mapping):
        for _, item in value.items:
            yield from _elements(item)
    else:
        yield value


def _calls_methods(language: Cpp, base: Kind, cls: Class | None) -> bool:
    """Return whether a base of a class may have virtual methods.

    That is no helper of the standard library, no template that gets the class instead, and none that is described.
    """
    gets = any(isinstance(one, TypeValue) and one.kind.cls is cls for one in base.arguments)
    plain = base.names[0] not in _HELPERS and not gets
    return plain and language.machine.framework.descriptions.class_named(base.names) is None


class Callbacks:
    """The functions of a program that are handed to code outside of it."""

    def __init__(self, language: Cpp) -> None:
        self._language = language
        self.changed: set[str] = set()
        """Names that callbacks change which were not run."""

    def escape(self, values: Iterable[Value]) -> None:
        """Schedule the functions among some values that are handed to code outside of the sources."""
        receivers: list[Object] = []
        method: Bound | None = None
        for value in values:
            if type(value) in _WITHOUT:
                continue
            for one in alternatives(value):
                if isinstance(one, Closure):
                    self._schedule(one)
                elif isinstance(one, Bound):
                    if isinstance(one.of, Object) or one.functions:
                        self._schedule(one)
                    else:
                        method = one
                elif isinstance(one, Object):
                    receivers.append(one)
        if method is None:
            return
        # The values may also have other objects, such as the period of a timer.
        for one in receivers:
            if self._language.methods(one.kind, method.name):
                self._schedule(Bound(method.name, one))
                return

    def hand_over(self, values: Iterable[Value]) -> None:
        """Schedule what code outside of the sources calls on objects of a base that only it knows.

        These are the methods that are marked as virtual. If none is, any public method can override one of the base.
        """
        language = self._language
        running = {id(site.this) for site in language.machine.stack}
        for one in values:
            if not isinstance(one, Object) or one.kind.cls is None or id(one) in running:
                continue
            chain, outside = language.chain(one.kind)
            unread = any(_calls_methods(language, base, one.kind.cls) for base in outside)
            if not unread or language.machine.framework.is_node(one):
                continue
            names = [
                name
                for cls, _ in chain
                for name, listed in (*cls.declared.items(), *language.linker.methods(cls).items())
                if not name.startswith("~") and any(function.virtual for function in listed)
            ]
            for name in dict.fromkeys(names or sorted(cast("CppClass", chain[0][0]).public)):
                if language.methods(one.kind, name) and name != one.kind.name:
                    self._schedule(Bound(name, one))

    def enter(self, called: Bound) -> None:
        """Schedule a method that code outside of the sources calls on an object of its own, whatever it reaches."""
        self._schedule(called, always=True)

    def _schedule(self, called: Closure | Bound, *, always: bool = False) -> None:
        machine = self._language.machine
        key: tuple[object, ...]
        if isinstance(called, Closure):
            key, configures = (id(called.function), id(this_of(called.frame)), called.captured), False
        else:
            key = (called.name, id(called.of), called.functions, called.given)
            configures = always or (called.name, id(called.of)) in machine.framework.called_later
        machine.schedule(key, partial(self._run, called, always=always), notes_conditions=configures)

    def spares(self, function: Function, this: Value | None, arguments: list[Value]) -> bool:
        """Check whether a call in a callback is not needed: it has no effect, and gives and stores no name.

        It is not run then, and what it changes becomes unknown.
        """
        handed = any(isinstance(one, Closure | Bound) for one in arguments)
        if handed or not self._gives_data(function) or self._has_effect(function, this):
            return False
        changed = self._language.linker.project.reach.changes(function)
        objects = [one for one in (this, *arguments) if isinstance(one, Object)] if changed else []
        if any(self._stores_text(one, changed) for one in objects):
            return False
        self._forget(changed, objects)
        return True

    def _gives_data(self, function: Function) -> bool:
        """Check whether what a function returns or fills is of no use for names and effects: numbers, messages."""
        if function.returns is None or function.template:
            return False
        types = [one.type for one in function.parameters if one.type is not None]
        if any(_holds_text(one) for one in types if (one.reference or one.pointer) and not one.constant):
            return False
        result = self._language.kinds.kind(function.returns, frame_of(function))
        return isinstance(result, Kind) and self._is_data(result)

    def _is_data(self, kind: Kind) -> bool:
        constructs = self._language.machine.framework.constructs
        if kind.cls is not None or kind.name in _OPEN or constructs(kind):
            return False
        return all(self._is_data(one.kind) for one in kind.arguments if isinstance(one, TypeValue))

    def _stores_text(self, of: Object, changed: frozenset[str]) -> bool:
        """Check whether one of some fields of an object holds texts."""
        chain = self._language.chain(of.kind)[0]
        types = [cls.fields[name].type for cls, _ in chain for name in changed & cls.fields.keys()]
        return any(one is not None and _holds_text(one) for one in types)

    def _is_idle(self, function: Function, this: Value | None) -> bool:
        """Check whether a callback reaches no effect. It is not run then, and what it changes becomes unknown."""
        if self._has_effect(function, this):
            return False
        self._forget(self._language.linker.project.reach.changes(function), [this] if isinstance(this, Object) else [])
        return True

    def _has_effect(self, function: Function, this: Value | None) -> bool:
        reaches = self._language.linker.project.reach.reaches(function)
        return reaches or (isinstance(this, Object) and self._runs_callable(function, this))

    def _forget(self, changed: frozenset[str], objects: Iterable[Object]) -> None:
        """Make unknown what code that is not run changes and that decides conditions: fields, and global variables."""
        machine = self._language.machine
        self.changed.update(changed)
        holders: list[Holder] = [part.fields for one in objects for part in _parts(one)] if changed else []
        holders += machine.globals.values()
        for variables in holders:
            for name in changed & variables.keys():
                if decides(variables[name]):
                    machine.write(variables, name, Unknown("a callback changes it"))

    @contextmanager
    def _others_ran(self, callback: Function, of: Value | None) -> Iterator[None]:
        """Run a callback as if other methods of its object, which it does not call itself, may have run before.

        The flags and null pointers that they set are unknown until it ends: they decide whether it goes on.
        """
        machine, linker = self._language.machine, self._language.linker
        if machine.notes_conditions or not isinstance(of, Object):
            yield
            return
        called = linker.project.called(callback)
        others = [
            function
            for cls, _ in self._language.chain(of.kind)[0]
            for name, functions in linker.methods(cls).items()
            for function in functions
            if name.lstrip("~") != cls.name and name not in called
        ]
        changed = frozenset[str]().union(*map(linker.project.assigned, others))
        before = {name: of.fields[name] for name in changed & of.fields.keys()}
        before = {name: value for name, value in before.items() if _is_flag(value)}
        for name in before:
            machine.write(of.fields, name, _SET)
        yield
        for name, value in before.items():
            if of.fields[name] is _SET:
                machine.write(of.fields, name, value)

    def _runs_callable(self, function: Function, this: Object) -> bool:
        """Check whether a callback can call a function that its object holds, and that reaches an effect."""
        reach = self._language.linker.project.reach
        names = {name for name, one in _callables(this) if any(map(reach.reaches, self._functions(one)))}
        return not names.isdisjoint(reach.uses([function])) if names else False

    def _functions(self, called: Closure | Bound) -> Iterable[Function]:
        if isinstance(called, Closure):
            return (called.function,)
        if isinstance(called.of, Object):
            return [function for function, _ in self._language.methods(called.of.kind, called.name)]
        return called.functions

    def _run(self, called: Closure | Bound, *, always: bool) -> None:
        """Call a function with arguments of its own types that come from outside."""
        machine = self._language.machine
        if isinstance(called, Closure):
            frame = closure_frame(called)
            if self._is_idle(called.function, this_of(frame)):
                return
            parameters = called.function.parameters[len(called.bound) :]
            with self._others_ran(called.function, this_of(frame)):
                machine.invoke(called.function, frame, [*called.bound, *self._unknown(parameters, frame)])
            return
        bound_values = {index: value for index, value in enumerate(called.given) if value != PLACEHOLDER}
        if isinstance(called.of, Object):
            overloads = [
                (function, bound, self._handed(called.of, function))
                for function, bound in self._language.methods(called.of.kind, called.name)
            ]
            # Of several overloads, a framework calls the one that takes the handles that it passes.
            reaches = self._language.reaches
            for function, bound, handles in sorted(overloads, key=lambda one: (not one[2], not reaches(one[0])))[:1]:
                if not always and (self._is_called(function, called) or self._is_idle(function, called.of)):
                    continue
                types = {**bound, **dict(zip(function.template, called.template, strict=False))}
                frame = frame_of(function, types, called.of)
                with self._others_ran(function, called.of):
                    machine.invoke(function, frame, self._unknown(function.parameters, frame, handles | bound_values))
        else:
            for function in called.functions[:1]:
                if self._is_idle(function, None):
                    continue
                frame = frame_of(function, dict(zip(function.template, called.template, strict=False)))
                machine.invoke(function, frame, self._unknown(function.parameters, frame, bound_values))

    def _is_called(self, function: Function, called: Bound) -> bool:
        """Check whether the code has itself called a method that a framework calls after construction."""
        machine, of = self._language.machine, id(called.of)
        return (called.name, of) in machine.framework.called_later and (id(function), of) in machine.executed

    def _handed(self, of: Object, function: Function) -> dict[int, Value]:
        """Return the node handles that a framework passes to a method, by the index of the parameter."""
        handles = self._language.machine.framework.handed(of, function.name, len(function.parameters))
        frame = Frame(function.unit, function.scope)
        types = [function.parameters[index].type for index in handles]
        kinds = [self._language.kind_of(one, frame) if one is not None else None for one in types]
        return handles if all(kind is not None and kind.name == "NodeHandle" for kind in kinds) else {}

    def _unknown(
        self, parameters: Iterable[Parameter], frame: Frame, given: dict[int, Value] | None = None
    ) -> list[Value]:
        """Return the arguments of a callback: those in `given` by index, the others unknown."""
        return [
            (given or {}).get(index) or self._language.unknown(parameter.type, frame, parameter.name)
            for index, parameter in enumerate(parameters)
            if not parameter.variadic
        ]
