"""Calls inside of the build: objects made, functions run, and the frames in which their bodies are evaluated."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.extract.python.arguments import Arguments, bind, read_arguments
from kg.extract.python.core import COMPUTED
from kg.extract.python.entities import (
    Bound,
    ClassRef,
    Dotted,
    FunctionRef,
    Instance,
    Nothing,
    Super,
)
from kg.extract.python.flow import with_arms
from kg.extract.python.library import Library
from kg.extract.python.syntax import argument_nodes, code
from kg.extract.values import Unknown

if TYPE_CHECKING:
    from collections.abc import Iterator

    from tree_sitter import Node

    from kg.extract.python.entities import Alternatives, Choice, Frame, Thing
    from kg.extract.python.program import Program
    from kg.extract.python.unit import CallSite, Scope

__all__ = ["Invocations"]

_NO_RESULT: Final = Unknown("the function that gives it returns nothing known")
_MAX_CALL_DEPTH: Final = 40
_MAX_FRAMES: Final = 24
_MAX_SEARCHES: Final = 300
_MAX_SEARCHES_NESTED: Final = 6


class Invocations(Library):
    """The part of the evaluator that runs functions and makes objects."""

    def __init__(self, program: Program) -> None:
        super().__init__(program)
        self.sites: dict[str, list[tuple[Scope, CallSite]]] = {}
        self.runs: dict[tuple[int, int], list[Frame]] = {}
        self.instances: dict[tuple[int, int, int], Instance] = {}
        self.objects: dict[int, list[Instance]] = {}
        self._calls: dict[tuple[int, int, int, int], Frame] = {}
        self._searching: set[tuple[int, int]] = set()
        self.searches = 0

    @abstractmethod
    def evaluate(self, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """Return what an expression can be."""

    def call(self, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """Return what a call gives."""
        called = node.child_by_field_name("function")
        if called is None:
            return [(COMPUTED, choice)]
        if called.type == "identifier" and code(called) == "super":
            return [(self.super_of(frame), choice)]
        found: Alternatives = []
        for value, after in self.evaluate(called, frame, choice):
            found.extend(self.result(value, node, frame, after))
        return found

    def super_of(self, frame: Frame) -> Thing:
        """Return the object of a method, seen from behind the method's class."""
        at: Frame | None = frame
        while at is not None and at.scope.owner is None:
            at = at.lexical
        if at is None or at.scope.owner is None:
            return COMPUTED
        if at.instance is None:
            at.instance = self.open_instance(at.scope.owner)
        return Super(at.instance, at.scope.owner)

    def result(self, value: Thing, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """Return what calling a value gives."""
        if isinstance(value, ClassRef):
            return [(self.instance(value.scope, node, frame), choice)]
        if isinstance(value, FunctionRef):
            return self.returned(value, node, frame, choice)
        if isinstance(value, Dotted | Bound):
            return self.library_call(value, node, frame, choice)
        return [(value if isinstance(value, Unknown) else COMPUTED, choice)]

    def instance(self, klass: Scope, call: Node, frame: Frame) -> Instance:
        """Return the object that a call of a class makes in a frame; the same call gives the same object."""
        key = (id(klass), call.start_byte, frame.id)
        if key not in self.instances:
            made = self.keep(key, Instance(klass, call, frame))
            init = self.initialiser(klass)
            if init is not None:
                made.frame = self.frame_for(FunctionRef(init, self.around(init), made), call, frame)
        return self.instances[key]

    def keep(self, key: tuple[int, int, int], made: Instance) -> Instance:
        """Remember an object, also as one of all its bases, and return it."""
        self.instances[key] = made
        for base in self.program.lineage(made.klass):
            if not isinstance(base, Dotted):
                self.objects.setdefault(id(base), []).append(made)
        return made

    def open_instance(self, klass: Scope) -> Instance:
        """Return an object of a class that was made nobody knows where; one that is known is preferred."""
        known = self.objects.get(id(klass))
        if known:
            return known[0]
        made = self.keep((id(klass), -1, -1), Instance(klass, None, None))
        init = self.initialiser(klass)
        if init is not None:
            made.frame = self.open_frame(init, made)
        return made

    def initialiser(self, klass: Scope) -> Scope | None:
        """Return the `__init__` that a class has or inherits inside of the build."""
        for base in self.program.lineage(klass):
            if isinstance(base, Dotted):
                return None
            if "__init__" in base.functions:
                return base.functions["__init__"]
        return None

    def around(self, scope: Scope) -> Frame:
        """Return a frame of what stands around a function, classes passed over."""
        parent = scope.parent
        while parent is not None and parent.kind == "class":
            parent = parent.parent
        return self.program.scope_frame(parent) if parent else self.program.module_frame(scope.unit)

    def open_frame(self, scope: Scope, instance: Instance | None) -> Frame:
        """Return, and keep, a run of a function whose caller is not known."""
        frame = self.program.new_frame(scope, self.around(scope))
        frame.open, frame.instance = True, instance
        self.runs.setdefault((id(scope), id(instance)), []).append(frame)
        return frame

    def frame_for(self, function: FunctionRef, call: Node | None, frame: Frame) -> Frame:
        """Return the run of a function that a call in a frame makes; the same call gives the same run."""
        given = call is not None and bool(argument_nodes(call))
        place = (call.start_byte, frame.id) if call is not None and given else (-1, 0)
        key = (id(function.scope), id(function.instance), *place)
        if key not in self._calls:
            made = self.program.new_frame(function.scope, function.lexical)
            made.caller, made.depth = frame, frame.depth + 1
            self._calls[key] = made
            self.fill(made, function, read_arguments(call, frame) if call is not None else Arguments())
            self.runs.setdefault((id(function.scope), id(made.instance)), []).append(made)
        return self._calls[key]

    def fill(self, made: Frame, function: FunctionRef, arguments: Arguments) -> None:
        """Bind the arguments; a method called through its class takes its object from the first of them."""
        scope = function.scope
        made.instance = function.instance
        skip = 1 if scope.receiver and function.instance is not None else 0
        if "classmethod" in scope.decorators:
            skip = 1
        elif scope.receiver and function.instance is None and arguments.positional:
            value = self.thunk(arguments.positional[0], {})[0][0]
            made.instance = value if isinstance(value, Instance) else None
        bind(arguments, scope, made, skip=skip)

    def returned(self, function: FunctionRef, call: Node | None, frame: Frame, choice: Choice) -> Alternatives:
        """Return what a call of a function of the build gives."""
        if frame.depth > _MAX_CALL_DEPTH:
            return [(COMPUTED, choice)]
        made = self.frame_for(function, call, frame)
        found: Alternatives = []
        for node, arms in function.scope.returns:
            after = with_arms(choice, made, arms)
            if after is not None and self.possible(arms, made, after):
                found.extend(self.evaluate(node, made, after))
        known = [row for row in found if not isinstance(row[0], Nothing)]
        return known or found or [(_NO_RESULT, choice)]

    def frames_of(self, scope: Scope, instance: Instance | None) -> list[Frame]:
        """Return the known runs of a function (on an object); an open one when none is known."""
        key = (id(scope), id(instance))
        if instance is not None and instance.frame is not None and instance.frame.scope is scope:
            return [instance.frame]
        if key not in self.runs and key not in self._searching and self.may_search():
            self._searching.add(key)
            self.searches += 1
            for function, call, caller in self.callers(scope, instance):
                made = self.frame_for(function, call.node, caller)
                made.choice = made.choice or with_arms(caller.choice, caller, call.arms) or {}
                if len(self.runs.get(key, ())) >= _MAX_FRAMES:
                    break
            self._searching.discard(key)
        closed = [frame for frame in self.runs.get(key, ()) if not frame.open]
        return closed or self.runs.get(key) or [self.open_frame(scope, instance)]

    def may_search(self) -> bool:
        """Tell whether another search for callers is within bounds, one within another and all together."""
        return len(self._searching) < _MAX_SEARCHES_NESTED and self.searches < _MAX_SEARCHES

    def callers(self, scope: Scope, instance: Instance | None) -> Iterator[tuple[FunctionRef, CallSite, Frame]]:
        """Yield the calls of a function in the code that was reached, with the frame that each is made in."""
        for around, call in self.sites.get(scope.name, ()):
            if around is scope:
                continue
            for frame in self.runs_around(around, instance):
                called = call.node.child_by_field_name("function")
                for value, _ in self.evaluate(called, frame, {}) if called is not None else ():
                    if isinstance(value, FunctionRef) and value.scope is scope:
                        same = instance is None or value.instance is None or value.instance is instance
                        if same:
                            yield replace(value, instance=instance or value.instance), call, frame

    def runs_around(self, scope: Scope, instance: Instance | None) -> list[Frame]:
        """Return the runs of a scope that can call methods of an object: on the object itself, or any."""
        if scope.kind != "function":
            return [self.program.scope_frame(scope)]
        if scope.owner is None:
            return self.frames_of(scope, None)
        others = self.objects.get(id(scope.owner), [])
        if instance is not None and instance in others:
            return self.frames_of(scope, instance)
        found: list[Frame] = []
        for other in others[:_MAX_FRAMES]:
            found.extend(self.frames_of(scope, other))
        return found[:_MAX_FRAMES]
