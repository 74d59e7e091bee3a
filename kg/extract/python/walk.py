"""Running a node's code in outline: from its root through all calls that can lead to a declaration.

Every call of a relevant function makes a frame; what remains unreached though it is named (callbacks, methods
that a framework calls) is run at the end, on the objects there are, with parameters that its callers decide.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.extract.python.api import API_NAMES, Api, find_api
from kg.extract.python.entities import Bound, ClassRef, Dotted, FunctionRef, Instance
from kg.extract.python.flow import agreeing, with_arms
from kg.extract.python.syntax import argument_nodes, code

if TYPE_CHECKING:
    from tree_sitter import Node

    from kg.extract.python.entities import Choice, Frame, Thing
    from kg.extract.python.evaluate import Evaluator
    from kg.extract.python.reach import Reach
    from kg.extract.python.unit import CallSite, Scope

__all__ = ["Site", "Walk"]

_MAX_DEPTH: Final = 24
_MAX_FRAMES: Final = 1_500
_MAX_FRAMES_OF_ONE: Final = 32
_MAX_OBJECTS: Final = 8
_STEPS_FOR_A_CALL: Final = 150
_STEPS_FOR_A_NODE: Final = 6_000
_STEPS_WHEN_SPENT: Final = 40


@dataclass(frozen=True, slots=True)
class Site:
    """A call that declares something, in one frame; `skip` counts leading arguments that are the object itself."""

    api: Api
    call: Node
    frame: Frame
    choice: Choice
    receiver: Thing | None
    skip: int = 0


@dataclass(frozen=True, slots=True)
class _Called:
    """Something outside of the build that is called; `skip` counts arguments in front that are the object itself."""

    path: str
    receiver: Thing | None
    skip: int = 0
    bound: bool = False


class Walk:
    """Collects the sites of one root."""

    def __init__(self, evaluator: Evaluator, found: Reach) -> None:
        self.evaluator = evaluator
        self.program = evaluator.program
        self.reach = found
        self.sites: list[Site] = []
        self.visited: set[int] = set()
        self.queued: set[int] = set()
        self.counts: dict[int, int] = {}
        self.pending: list[Frame] = []
        self.spent = 0
        self.names = API_NAMES | {found.scopes[key].name for key in found.relevant}

    def run(self, roots: list[Frame]) -> None:
        """Walk from the root's frames until nothing new is reached."""
        self.pending.extend(reversed(roots))
        for frame in self.module_frames():
            self.pending.insert(0, frame)
        self.drain()
        self.evaluator.memory.clear()
        while self.open_rest():
            self.drain()

    def module_frames(self) -> list[Frame]:
        """Return the top levels of the modules that are imported."""
        return [
            self.program.module_frame(scope.unit)
            for key, scope in self.reach.scopes.items()
            if scope.kind == "module" and key in self.reach.relevant
        ]

    def drain(self) -> None:
        """Run the frames that are waiting, the latest first."""
        while self.pending and len(self.visited) < _MAX_FRAMES:
            frame = self.pending.pop()
            if frame.id not in self.visited:
                self.visited.add(frame.id)
                self.counts[id(frame.scope)] = self.counts.get(id(frame.scope), 0) + 1
                self.visit(frame)

    def visit(self, frame: Frame) -> None:
        """Follow the calls of one frame, in the order of the text."""
        imports = frame.scope.unit.imports
        before = len(self.pending)
        for call in frame.scope.calls:
            imported = imports.get(call.name)
            if call.name in self.names or (imported is not None and imported.attribute in self.names):
                self.follow(call, frame)
        self.pending[before:] = reversed(self.pending[before:])
        if frame.scope.kind == "module":
            for klass in frame.scope.classes.values():
                if id(klass) in self.reach.relevant and klass.calls:
                    self.pending.append(self.program.new_frame(klass, frame))

    def follow(self, call: CallSite, frame: Frame) -> None:
        """Follow one call to what it declares or to the functions it runs."""
        choice = with_arms(frame.choice, frame, call.arms)
        called = call.node.child_by_field_name("function")
        if choice is None or called is None or not self.evaluator.possible(call.arms, frame, choice):
            return
        self.spent += self.evaluator.steps
        self.evaluator.steps = 0
        self.evaluator.limit = _STEPS_FOR_A_CALL if self.spent < _STEPS_FOR_A_NODE else _STEPS_WHEN_SPENT
        seen = []
        on_self = _root_name(called) == frame.scope.receiver
        for value, after in self.evaluator.evaluate(called, frame, {} if on_self else choice):
            merged = agreeing(choice, after)
            if value not in seen and merged is not None:
                seen.append(value)
                self.reached(value, call.node, frame, merged)

    def reached(self, value: Thing, call: Node, frame: Frame, choice: Choice) -> None:
        """Note what a call reaches."""
        if isinstance(value, Dotted):
            explicit = value.path.endswith(".__init__")
            receiver = self.first_argument(call, frame) if explicit else None
            self.declare(_Called(value.path, receiver, int(explicit)), call, frame, choice)
        elif isinstance(value, Bound):
            if not self.declare(_Called(value.path, value.receiver, bound=True), call, frame, choice):
                self.by_name(value, call, frame, choice)
        elif isinstance(value, ClassRef):
            self.construct(value.scope, call, frame, choice)
        elif isinstance(value, FunctionRef):
            self.enqueue(self.evaluator.frame_for(value, call, frame), choice)

    def first_argument(self, call: Node, frame: Frame) -> Thing | None:
        """Return the object of `Base.__init__(self, ...)`."""
        given = argument_nodes(call)
        return self.evaluator.evaluate(given[0], frame, {})[0][0] if given else None

    def by_name(self, value: Bound, call: Node, frame: Frame, choice: Choice) -> None:
        """Follow a method of an object that is not known to the only class that has a method of this name."""
        first, _, name = value.path.rpartition(".")
        methods = [method for method in self.reach.methods.get(name, ()) if id(method) in self.reach.relevant]
        if first != "?" or len(methods) != 1 or self.counts.get(id(methods[0]), 0) >= _MAX_OBJECTS:
            return
        for instance in self.objects_of(methods[0])[:_MAX_OBJECTS]:
            function = FunctionRef(methods[0], self.evaluator.around(methods[0]), instance)
            self.enqueue(self.evaluator.frame_for(function, call, frame), choice)

    def declare(self, called: _Called, call: Node, frame: Frame, choice: Choice) -> bool:
        """Note a call of something outside of the build when it declares anything, and tell whether it does."""
        given = [node for node in argument_nodes(call) if node.type != "keyword_argument"]
        api = find_api(called.path, bound=called.bound, arguments=len(given) - called.skip)
        if api is not None:
            self.sites.append(Site(api, call, frame, choice, called.receiver, called.skip))
        return api is not None

    def construct(self, klass: Scope, call: Node, frame: Frame, choice: Choice) -> None:
        """Follow the making of an object: its `__init__`, or the one of a base outside of the build."""
        instance = self.evaluator.instance(klass, call, frame)
        if instance.frame is not None:
            self.enqueue(instance.frame, choice)
            return
        for base in self.program.lineage(klass):
            if isinstance(base, Dotted):
                self.declare(_Called(base.path, instance), call, frame, choice)
                return

    def enqueue(self, frame: Frame, choice: Choice) -> None:
        """Let a frame be run, if it can lead to anything and is not one too many."""
        scope = frame.scope
        relevant = id(scope) in self.reach.relevant
        if relevant and frame.depth <= _MAX_DEPTH and self.counts.get(id(scope), 0) < _MAX_FRAMES_OF_ONE:
            if frame.id in self.visited or frame.id in self.queued:
                return
            frame.choice = choice
            self.queued.add(frame.id)
            self.pending.append(frame)

    def open_rest(self) -> bool:
        """Queue relevant functions that are named but were never called; tell whether there were any.

        Methods of objects that exist come first, then functions, then classes that nobody makes objects of,
        those first that no call names: what one of them runs may call the others.
        """
        rest = [scope for key, scope in self.reach.scopes.items() if self.is_rest(key, scope)]
        for scope in rest:
            for instance in self.objects_of(scope) if scope.owner else ():
                self.queue_open(scope, instance)
        if not self.pending:
            self.open_functions([scope for scope in rest if scope.owner is None])
        if not self.pending:
            self.open_class([scope for scope in rest if scope.owner is not None and self.is_leaf(scope.owner)])
        return bool(self.pending) and len(self.visited) < _MAX_FRAMES

    def is_rest(self, key: int, scope: Scope) -> bool:
        """Tell whether a scope is a relevant function that was never run."""
        return scope.kind == "function" and key in self.reach.relevant and key not in self.counts

    def queue_open(self, scope: Scope, instance: Instance | None) -> None:
        """Queue a function that nobody calls."""
        self.counts[id(scope)] = 0
        self.evaluator.steps = 0
        self.pending.extend(self.evaluator.frames_of(scope, instance))

    def open_functions(self, scopes: list[Scope]) -> None:
        """Queue functions without an object: those that no call names, else all."""
        uncalled = [scope for scope in scopes if scope.name not in self.evaluator.sites]
        for scope in uncalled or scopes:
            self.queue_open(scope, None)

    def open_class(self, methods: list[Scope]) -> None:
        """Make an object of one class that nobody makes objects of, and queue its methods."""
        owners = [method.owner for method in methods if method.owner is not None]
        owner = min(owners, key=lambda klass: klass.name in self.evaluator.sites, default=None)
        if owner is not None:
            self.evaluator.steps = 0
            instance = self.evaluator.open_instance(owner)
            for method in methods:
                if method.owner is owner:
                    self.queue_open(method, instance)

    def objects_of(self, scope: Scope) -> list[Instance]:
        """Return the objects whose class has this very method, neither overridden nor of another class."""
        return [
            instance
            for instance in self.evaluator.objects.get(id(scope.owner), [])
            if self.method_of(instance.klass, scope.name) is scope
        ]

    def method_of(self, klass: Scope, name: str) -> Scope | None:
        """Return the method that objects of a class have under a name."""
        lineage = self.program.lineage(klass)
        return next(
            (base.functions[name] for base in lineage if not isinstance(base, Dotted) and name in base.functions), None
        )

    def is_leaf(self, klass: Scope) -> bool:
        """Tell whether a class was named by the code that runs and no object is of a class derived from it."""
        return id(klass) in self.reach.scopes and not self.evaluator.objects.get(id(klass))


_HOLDERS: Final = {"attribute": "object", "subscript": "value", "call": "function"}


def _root_name(called: Node) -> str | None:
    """Return the first name of `a.b[c].d`; None for anything else."""
    node: Node | None = called
    while node is not None and node.type in _HOLDERS:
        node = node.child_by_field_name(_HOLDERS[node.type])
    return code(node) if node is not None and node.type == "identifier" and node is not called else None
