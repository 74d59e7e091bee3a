"""Calls in Python: functions, methods, constructions, and functions that code outside of the sources calls later."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final

from kg.extract.python import library
from kg.extract.python.callbacks import WAITING, Callbacks
from kg.extract.python.modules import PLAIN
from kg.extract.python.statements import DECORATED
from kg.symbolic import form
from kg.symbolic.binding import bind
from kg.symbolic.state import Alias, Arguments, Frame
from kg.symbolic.values import (
    Bound,
    Closure,
    Either,
    Kind,
    Mapping,
    Object,
    Sequence,
    Text,
    TypeValue,
    Unknown,
    Value,
    alternatives,
    outside,
)

if TYPE_CHECKING:
    from collections.abc import Iterable
    from collections.abc import Mapping as Names

    from kg.extract.python.language import Python
    from kg.symbolic.form import Expression, Function

_DEEPEST: Final = 60
_MOST_REPEATS: Final = 2
CLASS: Final = "__class__"
"""The name under which the frame of a method has the class that defines it."""
_TYPES: Final = ("msg_type", "srv_type")
"""The names of the first parameter of methods of nodes that create interfaces."""
_PUBLIC: Final[dict[tuple[str, ...], tuple[str, ...]]] = {("rclpy", "lifecycle", "Node"): ("rclpy", "LifecycleNode")}
_SEVERAL: Final = {"py_trees_ros": frozenset({"ToBlackboard", "FromBlackboard", "FromConstant"})}
"""Classes whose names several modules of a package give, so that the module is a part of the name."""


def public(names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the name of a class or function by its package and its own name: `rclpy.Node` of `rclpy.node.Node`."""
    if len(names) < 2 or names[-1] in _SEVERAL.get(names[0], ()):  # noqa: PLR2004 - a package and a name
        return names
    return _PUBLIC.get(names, (names[0], names[-1]))


class Calls:
    """The calls of a program."""

    def __init__(self, language: Python) -> None:
        self._language = language
        self._callbacks = Callbacks()

    # Calls as written

    def call(self, expression: form.Call, frame: Frame) -> Value:
        """Run a call and return its value."""
        function, machine = expression.function, self._language.machine
        if isinstance(function, form.Name | form.Member) and _last(function) in WAITING:
            self._callbacks.run(machine)
        if isinstance(function, form.Name):
            if function.names[0] == DECORATED:
                return self._decorated(expression, frame)
            if function.names[0] == "super":
                return _super(machine.arguments(expression.arguments, frame), frame)
        if isinstance(function, form.Member):
            of = machine.value(function.of, frame)
            given = self._given(expression, frame)
            return machine.over((of,), lambda one: self.method(one, function.name, given, function.of))
        called = machine.value(function, frame)
        return self.value(called, self._given(expression, frame))

    def _given(self, expression: form.Call, frame: Frame) -> Arguments:
        machine = self._language.machine
        values = machine.arguments(expression.arguments, frame)
        named: dict[str, Value] = {}
        for name, written in expression.keywords:
            value = machine.value(written, frame)
            if name != "**":
                named[name] = value
            elif isinstance(value, Mapping):
                named.update((key.exact, item) for key, item in value.items if isinstance(key, Text) and key.exact)
        return Arguments(values, (), expression, frame, named)

    def _decorated(self, expression: form.Call, frame: Frame) -> Value:
        """Return a function or class as a decorator makes it; decorators outside of the sources leave it as it is.

        Those that are a method of an object outside, such as `@server.tool()`, call the function later.
        """
        machine = self._language.machine
        decorator, function = (machine.value(one, frame) for one in expression.arguments)
        if not isinstance(decorator, Closure):
            if self._registers(expression.arguments[0], frame):
                self.escape([one for one in (function,) if isinstance(one, Closure) and one.function.owner is None])
            return function
        decorated = self.value(decorator, Arguments([function]))
        return decorated if isinstance(decorated, Closure | TypeValue | Object) else function

    def _registers(self, decorator: form.Expression, frame: Frame) -> bool:
        """Check whether a decorator of a function is what a method of an object outside gives."""
        called = decorator.function if isinstance(decorator, form.Call) else None
        if not isinstance(called, form.Member):
            return False
        return isinstance(self._language.machine.value(called.of, frame), Object | Unknown)

    def construct_expression(self, expression: form.Construct, frame: Frame) -> Value:
        """Return an unknown value, since Python constructs by calls."""
        self._language.machine.arguments(expression.arguments, frame)
        return Unknown("it is not constructed")

    # Calls of values

    def value(self, called: Value, given: Arguments | None = None) -> Value:
        """Call a value: a function, a method, a class."""
        given = given if given is not None else Arguments([])
        if isinstance(called, Either):
            return self._language.machine.over((called,), lambda one: self.value(one, given))
        if isinstance(called, Closure):
            return self._invoke(called, given)
        if isinstance(called, Bound) and isinstance(called.of, Object):
            return self.outside_method(called.of, called.name, given)
        if isinstance(called, TypeValue):
            return self.construct(called.kind, given) if called.kind.cls is not None else self.outside(called, given)
        if isinstance(called, Object):
            method = self._language.of_object(called, "__call__")
            result = self._invoke(method, given) if isinstance(method, Closure) else None
            result = result if result is not None else library.called(self._language, called, given)
            if result is not None:
                return result
        self._escape_all(given)
        return Unknown(called.reason if isinstance(called, Unknown) else "the called function is unknown")

    def _invoke(self, called: Closure, given: Arguments) -> Value:
        named = {**dict(called.named), **given.named}
        arguments = [*called.bound, *given.values]
        frame = self._frame(called, arguments)
        _share(called, frame, given)
        _bind(called.function, frame, arguments, named)
        return self._language.machine.invoke(called.function, frame, arguments)

    def _frame(self, called: Closure, arguments: list[Value]) -> Frame:
        """Return a new frame for a function, within the variables around it."""
        function = called.function
        through_class = function.owner is not None and not called.bound and called.frame.this is None
        this = next(iter(arguments if through_class else called.bound), None)
        frame = Frame(function.unit, (*function.scope, function.name), this, parent=called.frame)
        if this is None:
            frame.this = called.frame.this
        if function.owner is not None:
            frame.types[CLASS] = TypeValue(Kind(("class",), cls=function.owner))
        return frame

    def method(self, of: Value, name: str, given: Arguments, written: Expression | None = None) -> Value:
        """Call a method of a value; `written` is the expression of the value."""
        if isinstance(of, Object):
            member = self._language.of_object(of, name)
            if not isinstance(member, Unknown):
                return self.value(member, given)
        elif isinstance(of, TypeValue):
            if name == "__subclasses__" and of.kind.cls is not None:
                return self._language.subclasses(of.kind.cls)
            return self.value(self._language.member(of, name), given)
        else:
            result = library.method(self._language, of, name, given, written)
            if result is None:
                result = self._of_unknown_node(name, given)
            if result is not None:
                return result
        self._escape_all(given)
        if isinstance(of, Unknown):
            return replace(of, parameter=None) if of.label else outside(name, given.values, of.reason)
        return outside(name, given.values)

    # Outside of the sources

    def outside_method(self, of: Object, name: str, given: Arguments) -> Value:
        """Call a method of an object whose class, or one of its bases, is not in the sources."""
        machine = self._language.machine
        if name == "__init__":
            self._construct_bases(of, given)
            return Unknown("it returns nothing")
        result = library.object_method(self._language, of, name, given)
        if result is None:
            result = machine.framework.call_method(of, name, given)
        if result is None:
            result = self._of_unknown_node(name, given)
        if result is not None:
            return result
        self._escape_all(given)
        return outside(name, given.values)

    def _of_unknown_node(self, name: str, given: Arguments) -> Value | None:
        named = (given.named[name] for name in _TYPES if name in given.named)
        kind = given.values[0] if given.values else next(named, None)
        return self._language.machine.framework.call_unknown_node(name, kind, given)

    def outside(self, called: TypeValue, given: Arguments) -> Value:
        """Call a function or construct a class that is not in the sources."""
        language, names = self._language, called.kind.names
        framework = language.machine.framework
        if names[-1] == "__init__" and given.values and isinstance(given.values[0], Object):
            base = Kind(public(names[:-1]))
            framework.construct_base(given.values[0], base, replace(given, values=given.values[1:]))
            return Unknown("it returns nothing")
        result = library.call(language, names, given)
        if result is None:
            result = framework.construct(Kind(public(names)), given)
        if result is None:
            result = framework.call_function(public(names), given)
        if result is not None:
            return result
        self._escape_all(given)
        if names[-1][:1].isupper():
            return Object(called.kind, fields=dict(given.named))
        return outside(names[-1], given.values)

    # Constructions

    def construct(self, kind: Kind, given: Arguments, *, hosted: bool = False) -> Object:
        """Return a new object of a class of the sources; `hosted` if a framework makes it."""
        language, cls = self._language, kind.cls
        machine = language.machine
        line = given.call.line if given.call is not None else cls.line if cls is not None else 0
        instance = Object(kind, line=line, path=cls.unit.path if cls is not None else "")
        if len(machine.stack) > _DEEPEST:
            machine.reached("depth")
            return instance
        chain, outside = language.chain(kind)
        owner = next((one for one, _ in chain if "__init__" in one.methods), None)
        if owner is not None:
            self._initialise(Closure(owner.methods["__init__"][0], language.around[owner], (instance,)), given)
        else:
            if not any(map(machine.framework.constructs, outside)):
                names = dict.fromkeys(name for one, _ in reversed(chain) for name in one.fields)
                instance.fields.update(zip(names, given.values, strict=False))
            instance.fields.update(given.named)
            self._construct_bases(instance, given)
        machine.framework.constructed(instance)
        if not hosted and any(map(self._calls_back, outside)):
            methods = dict.fromkeys(name for cls, _ in chain for name in cls.methods)
            self.escape([language.of_object(instance, name) for name in methods if not name.startswith("_")])
        return instance

    def _construct_bases(self, instance: Object, given: Arguments) -> None:
        """Run the constructors of the bases outside of the sources; one that is presumed to be a node does anything."""
        framework = self._language.machine.framework
        for base in self._language.chain(instance.kind)[1]:
            framework.construct_base(instance, base, given)
            for presumed in (one for one in base.arguments if isinstance(one, TypeValue)):
                framework.left(presumed.kind.names, instance, "and is its base class")

    def _initialise(self, called: Closure, given: Arguments) -> None:
        machine, function = self._language.machine, called.function
        if machine.running[id(function)] >= _MOST_REPEATS:
            machine.reached("depth")
            return
        arguments = [*called.bound, *given.values]
        frame = self._frame(called, arguments)
        _bind(function, frame, arguments, given.named)
        with machine.entered(function):
            bind(machine, function, frame, arguments)
            machine.run(function.body, frame)

    def _calls_back(self, base: Kind) -> bool:
        """Check whether a base outside of the sources may call any method of the classes that derive from it."""
        framework = self._language.machine.framework
        return base.names[0] not in PLAIN and not framework.constructs(base) and not base.name.endswith("Exception")

    # Callbacks

    def _escape_all(self, given: Arguments) -> None:
        self.escape([*given.values, *given.named.values()])

    def escape(self, values: Iterable[Value]) -> None:
        """Schedule the functions among some values that are handed to code outside of the sources."""
        for value in values:
            for one in alternatives(value):
                if isinstance(one, Closure):
                    self._schedule(one)
                elif isinstance(one, Bound) and isinstance(one.of, Object):
                    method = self._language.of_object(one.of, one.name)
                    if isinstance(method, Closure):
                        self._schedule(method)
                elif isinstance(one, TypeValue) and self._is_created(one.kind):
                    self.create(one)
                elif isinstance(one, Sequence):
                    self.escape(item for item in one.items if isinstance(item, Closure | Sequence | TypeValue))
                elif isinstance(one, Mapping):
                    self.escape(item for _, item in one.items if isinstance(item, Closure))

    def _is_created(self, kind: Kind) -> bool:
        """Check whether code outside of the sources that gets a class presumably creates an object of it."""
        described = self._language.machine.framework.described(kind) if kind.cls is not None else []
        return any(one.is_a == "node" for one in described) or any(map(self._calls_back, self._language.chain(kind)[1]))

    def create(self, value: Value) -> None:
        """Schedule the creation of an object of a class by code outside of the sources."""
        for one in alternatives(value):
            if isinstance(one, TypeValue) and one.kind.cls is not None:
                work = partial(self.construct, one.kind, Arguments([]))
                self._language.machine.schedule((one.kind.cls, "create"), work)

    def _schedule(self, called: Closure) -> None:
        self._callbacks.register(called)
        owners = tuple(id(one) for one in called.bound if isinstance(one, Object))
        key = (id(called.function), owners or id(called.frame.this))
        machine = self._language.machine
        configures = any((called.function.name, owner) in machine.framework.called_later for owner in owners)
        machine.schedule(key, partial(self._called_back, called), notes_conditions=configures)

    def _called_back(self, called: Closure) -> None:
        """Run a callback after any others, and after itself."""
        self._callbacks.run(self._language.machine)
        self._invoke(called, Arguments([]))


def _last(function: form.Name | form.Member) -> str:
    return function.names[-1] if isinstance(function, form.Name) else function.name


def _super(arguments: list[Value], frame: Frame) -> Value:
    """Return what `super()` and `super(Class, self)` give: the object, seen as one of the bases behind a class."""
    after = arguments[0] if arguments else frame.bound_type(CLASS)
    of = arguments[1] if len(arguments) > 1 else next((one.this for one in frame.outward() if one.this), None)
    if not isinstance(of, Object) or not isinstance(after, TypeValue):
        return Unknown("it is not known what super() means")
    return Object(Kind(("builtins", "super")), native={"super": of, "after": after})


def _share(called: Closure, frame: Frame, given: Arguments) -> None:
    """Make the parameters of a function mean the lists and dictionaries that the caller's variables hold."""
    if given.frame is None or given.call is None or len(given.call.arguments) != len(given.values):
        return
    parameters = called.function.parameters[len(called.bound) :]
    rows = [*zip((one.name for one in parameters), given.values, given.call.arguments, strict=False)]
    rows += [(name, given.named[name], written) for name, written in given.call.keywords if name in given.named]
    usual = {one.name for one in parameters if not one.variadic}
    for name, value, written in rows:
        if name in usual and isinstance(value, Sequence | Mapping) and isinstance(written, form.Name | form.Member):
            frame.variables[name] = Alias(written, given.frame, object=True)


def _bind(function: Function, frame: Frame, arguments: list[Value], named: Names[str, Value]) -> None:
    """Set the parameters of a function that arguments give by name, and those that take all others."""
    plain = [one for one in function.parameters if not one.variadic and not one.named]
    for index, parameter in enumerate(function.parameters):
        if parameter.variadic:
            rest = Sequence(tuple(arguments[len(plain) :]))
            own = {one.name for one in function.parameters}
            others = tuple((Text.of(name), value) for name, value in named.items() if name not in own)
            frame.variables[parameter.name] = Mapping(others) if parameter.named else rest
        elif parameter.name in frame.variables:
            continue
        elif parameter.name in named and (parameter.named or index >= len(arguments)):
            frame.variables[parameter.name] = named[parameter.name]
