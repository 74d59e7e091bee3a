"""Calls in C++: the function that a call means, and its result."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, Final, TypeAlias, TypeGuard, cast

from kg.extract.cpp import library
from kg.extract.cpp.callbacks import closure_frame
from kg.extract.cpp.kinds import frame_of, inside, this_of
from kg.extract.cpp.specialising import chosen_functions
from kg.symbolic import form
from kg.symbolic.binding import put
from kg.symbolic.kinds import POINTERS, is_pointer, pointee
from kg.symbolic.messages import GENERATED
from kg.symbolic.operators import NULL
from kg.symbolic.state import Arguments, Frame
from kg.symbolic.values import (
    Bound,
    Closure,
    Either,
    Kind,
    Mapping,
    Number,
    Object,
    Sequence,
    Truth,
    TypeValue,
    Unknown,
    Value,
    alternatives,
    is_empty_text,
    join,
    labelled,
    outside,
)

if TYPE_CHECKING:
    from kg.extract.cpp.language import Cpp
    from kg.symbolic.form import Expression, Function

_HANDLE: Final = Kind(("ros", "NodeHandle"))
_OF_HANDLES: Final = ("advertise", "subscribe", "advertiseService", "serviceClient")
"""Methods that tell a node handle."""
_SINGLE: Final = ("instance", "getinstance")
_CONNECTING: Final = ("setupUi", "connectSlotsByName")
"""Functions of Qt that connect the slots of the object that they get."""
_SLOT: Final = re.compile(r"on_\w+_[a-z]\w*")
_MAKING: Final = ("create", "make")
"""How the names of factories begin."""
_SPINS: Final = ("ros", "rclcpp")
_SPINNING: Final = frozenset({"spin", "spinOnce", "spin_some", "spin_once", "spin_all", "spin_until_future_complete"})
"""What runs callbacks, as functions of a framework or methods of its classes."""
_SUPPORT: Final = re.compile(r"ROSIDL_GET_(MSG|SRV|ACTION)_TYPE_SUPPORT")
"""Macros of rosidl whose arguments are the parts of a type's name."""
Overload: TypeAlias = "tuple[Function, dict[str, Value]]"
"""A function, with the values of the template parameters around it."""


class Calls:
    """The calls of a program."""

    def __init__(self, language: Cpp) -> None:
        self._language = language
        self._kinds = language.kinds
        self._linker = language.linker

    def call(self, expression: form.Call, frame: Frame) -> Value:
        """Run a call and return its value."""
        function = expression.function
        if isinstance(function, form.Name):
            return self._name(function, expression, frame)
        machine = self._language.machine
        if isinstance(function, form.Member):
            of = self._inherited_handle(machine.value(function.of, frame), function, frame)
            values = machine.arguments(expression.arguments, frame)
            given = Arguments(values, self._kinds.template(function.template, frame), expression, frame)
            if type(of) is not Either or library.changes(of, function.name):
                return self.method(of, function.name, given, function.of)
            return join(*(self.method(one, function.name, given, function.of) for one in alternatives(of)))
        if isinstance(function, form.Type):
            resolved = self._kinds.kind(function, frame)
            values = machine.arguments(expression.arguments, frame)
            if isinstance(resolved, Kind):
                return self._language.construct(resolved, values, frame, expression.line)
            return Unknown("it is computed")
        called = machine.value(function, frame)
        return self.value(called, Arguments(machine.arguments(expression.arguments, frame), (), expression, frame))

    def _inherited_handle(self, of: Value, function: form.Member, frame: Frame) -> Value:
        """Return the node handle that a base class outside of the sources must hold, as its methods are called."""
        if function.name not in _OF_HANDLES or not isinstance(of, Unknown):
            return of
        this = this_of(frame)
        if not isinstance(this, Object):
            return of
        name = _name_of_member(function.of, frame)
        if name is None or self._kinds.has_field(this, name) or not self._kinds.chain(this.kind)[1]:
            return of
        handle = self._language.machine.framework.given(_HANDLE, name)
        if handle is None:
            return of
        self._language.machine.write(this.fields, name, handle)
        return handle

    def value(self, called: Value, given: Arguments) -> Value:
        """Call a function that is a value: a lambda, a bound method, an object with `operator()`."""
        if isinstance(called, Either):
            return join(*(self.value(item, given) for item in called.items))
        if isinstance(called, Closure):
            frame = closure_frame(called)
            values = [*called.bound, *given.values]
            return self._language.machine.invoke(called.function, frame, values, given.written, given.frame)
        if isinstance(called, Bound):
            if called.given:
                given = Arguments(called.filled(given.values), called.template, frame=given.frame)
            elif called.template and not given.template:
                given = replace(given, template=called.template)
            if isinstance(called.of, Object):
                return self.method(called.of, called.name, given)
            if called.functions:
                return self._invoke([(function, {}) for function in called.functions], given)
            static = self._static(called.of, called.name, given) if called.of is not None else None
            if static is not None:
                return static
        if isinstance(called, Object):
            return self.method(called, "operator()", given)
        self._leave(given, "an unknown function")
        return Unknown("the called function is unknown")

    # Calls by a name

    def _name(self, function: form.Name, expression: form.Call, frame: Frame) -> Value:
        names, last = function.names, function.names[-1]
        machine = self._language.machine
        local = len(names) == 1
        if local and frame.holder(last) is not None:
            called = machine.value(function, frame)
            return self.value(called, Arguments(machine.arguments(expression.arguments, frame), (), expression, frame))
        if local and (last.upper() == last or "_" in last):
            macro = self._linker.find_macro(last, frame.unit, expression.line)
            if macro is not None and macro.parameters is not None:
                return self._language.expanded(macro, expression.arguments, frame, expression.line)
        if local and (support := _SUPPORT.fullmatch(last)) is not None:
            return _supported(support[1].lower(), expression.arguments)
        values = machine.arguments(expression.arguments, frame)
        if names[0].startswith("decltype("):
            of = self._kinds.type_of(form.Name(expression.line, (names[0][9:-1],)), frame)
            if of is not None:
                given = Arguments(values, of.arguments, expression, frame)
                result = machine.framework.call_function((*of.names, last), given)
                return result if result is not None else outside(last, values)
        given = Arguments(values, self._kinds.template(function.template, frame), expression, frame)
        this = this_of(frame)
        if local and isinstance(this, Object):
            if self._kinds.has_field(this, last):
                return self.value(self._language.member(this, last), replace(given, template=()))
            if own := [one for one in self._of_own_class(this, last, frame) if fits(one[0], len(values))]:
                return self._on(this, own, given)
            if self._language.methods(this.kind, last) or machine.framework.describes_method(this, last):
                return self.method(this, last, given)
        scoped = self._sibling(last, given, frame) if local else self._scoped(function, this, given, frame)
        return scoped if scoped is not None else self._function(function, given, frame)

    def _of_own_class(self, this: Object, name: str, frame: Frame) -> list[Overload]:
        """Return the methods that a name alone means in a base whose object is of a class with others of the name.

        None where that is no matter, or where they are virtual.
        """
        methods = self._language.methods(this.kind, name) if this.created else []
        if not methods or not frame.scope or frame.scope[-1] == this.kind.name:
            return []
        classes = [cls for cls, _ in self._kinds.chain(this.kind)[0]]
        at = next((index for index, cls in enumerate(classes) if cls.inside == frame.scope), 0)
        own = [one for one in methods if one[0].owner not in classes[:at]]
        return own if len(own) < len(methods) and not any(one.virtual for one, _ in own) else []

    def _sibling(self, name: str, given: Arguments, frame: Frame) -> Value | None:
        """Call a static method by its name alone in another one; return None for other functions."""
        outer = Frame(frame.unit, frame.scope[:-1])
        kind = self._kinds.kind(form.Type(frame.scope[-1:]), outer) if frame.scope else None
        if not isinstance(kind, Kind) or kind.cls is None or not self._language.methods(kind, name):
            return None
        bound = tuple(frame.types[one] for one in kind.cls.template if one in frame.types)
        return self._static(replace(kind, arguments=bound), name, given)

    def _scoped(self, function: form.Name, this: Value | None, given: Arguments, frame: Frame) -> Value | None:
        """Call a method that is qualified by its class, `Base::method()`; return None for other functions."""
        *outer, last = function.names
        template = function.outer or (function.template if last in ("create", "make") else ())
        kind = self._kinds.kind(form.Type(tuple(outer), template), frame)
        if not isinstance(kind, Kind):
            return None
        if function.outer is function.template and kind.cls is not None:
            given = replace(given, template=())  # `Singleton<T>::instance()`
        if isinstance(this, Object):
            classes, outside = self._kinds.chain(this.kind)
            bound = next((bound for cls, bound in classes if cls is kind.cls), None)
            if bound is not None or any(base.names == kind.names or base.name == kind.name for base in outside):
                base = Kind(kind.names, tuple(bound.values()), kind.cls) if bound is not None else None
                return self._of_base(this, base, last, given)
        if kind.cls is None:
            return None
        called = self._static(kind, last, given)
        return called if called is not None else self._single(kind, last, given)

    def _single(self, kind: Kind, name: str, given: Arguments) -> Value | None:
        """Return the only object of a class whose outside base is a template of it, `Singleton<T>`; None for others."""
        if given.values or name.lower().replace("_", "") not in _SINGLE:
            return None
        own = TypeValue(kind)
        if not any(base.arguments[:1] == (own,) for base in self._kinds.chain(kind)[1]):
            return None
        instances = self._language.machine.globals.setdefault((_SINGLE, kind.cls), {})
        if name not in instances:
            instances[name] = self._language.construct(kind, [], given.frame, given.line)
        return cast("Value", instances[name])

    def _of_base(self, this: Object, base: Kind | None, name: str, given: Arguments) -> Value:
        """Call the method of a base on an object; a base of None is not in the sources."""
        methods = self._fitting(base, name, given) if base is not None else []
        if methods:
            return self._on(this, methods, given)
        result = self._language.machine.framework.call_method(this, name, given)
        return result if result is not None else outside(name, given.values)

    def _function(self, function: form.Name, given: Arguments, frame: Frame) -> Value:
        """Call a function that is not a method: of the sources, of a framework, of a library, or a construction."""
        names, last = function.names, function.names[-1]
        language = self._language
        defined = [
            one
            for one in self._linker.find_functions(names, frame.unit, frame.scope)
            if one.owner is None and not _constructs(one)
        ]
        defined = chosen_functions(self._kinds, defined, given.template)
        matching = [one for one in defined if fits(one, len(given.values))]
        if defined and not matching:
            given = self._with_defaults(defined, self._linker.find_prototypes(names, frame.unit, frame.scope), given)
            matching = [one for one in defined if fits(one, len(given.values))]
        if matching:
            return self._invoke([(one, {}) for one in matching], given)
        if last in _SPINNING and names[0] in _SPINS:
            language.machine.drain()
        result = language.machine.framework.call_function(names, given)
        if result is None:
            result = library.call(language, names, given)
        if result is not None:
            return result
        if last in library.TYPES or last in POINTERS:
            return language.construct(Kind(names, given.template), given.values, frame, given.line)
        kind = self._kinds.kind(form.Type(names, function.template), frame)
        if isinstance(kind, Kind) and (
            kind.cls is not None
            or is_pointer(kind)
            or language.machine.framework.constructs(kind)
            or (not given.values and (kind.names != names or self._is_generated(names, frame)))
        ):
            return language.construct(kind, given.values, frame, given.line)
        made = self._made(last, given, frame)
        if made is not None:
            return made
        self._leave(given, last)
        language.hand_node(names, given.values)
        language.hand_parameters(names, given.values)
        for prototype in self._linker.find_prototypes(names, frame.unit, frame.scope)[:1]:
            if prototype.returns is not None:
                return labelled(language.unknown(prototype.returns, frame_of(prototype), last), last, given.values)
        return outside(last, given.values)

    def _made(self, name: str, given: Arguments, frame: Frame) -> Value | None:
        """Return the object of the class that a factory outside of the sources makes: `createModule<Arm>(broker)`."""
        first = given.template[0] if given.template and name.startswith(_MAKING) else None
        if not isinstance(first, TypeValue) or first.kind.cls is None:
            return None
        return self._language.construct(first.kind, given.values, frame, given.line)

    def _is_generated(self, names: tuple[str, ...], frame: Frame) -> bool:
        """Return whether a name is a class that the build generates of a message or service."""
        in_package = len(names) > 1 and names[-1][:1].isupper()
        return in_package and (
            names[-2] in GENERATED or self._linker.generated(names[-1], frame.unit, names[:1]) == names
        )

    def _with_defaults(self, defined: list[Function], declared: list[Function], given: Arguments) -> Arguments:
        """Return the arguments of a call of a function, with the default ones that only its declaration has."""
        count = len(given.values)
        for one in declared:
            if fits(one, count) and any(_same_types(one, other) for other in defined):
                at = Frame(one.unit, one.scope)
                rest = (parameter.default for parameter in one.parameters[count:])
                added = [self._language.machine.value(value, at) for value in rest if value is not None]
                return replace(given, values=[*given.values, *added])
        return given

    def _leave(self, given: Arguments, function: str) -> None:
        """Pass arguments to code that is not run: it can call functions, write by address, and fill empty containers.

        Texts that are not empty keep their value, as the default of an option usually is what counts.
        """
        self._language.escape(given.values)
        self._language.hand_over(given.values)
        if function in _CONNECTING:
            self._language.escape([slot for one in given.values for slot in self._slots(one)])
        if given.frame is None:
            return
        for written, value in zip(given.written, given.values, strict=False):
            plain = isinstance(value, Truth | Number) or value == NULL
            if plain and isinstance(written, form.Unary) and written.sign == "&":
                put(self._language.machine, written, outside(function, []), given.frame)
            elif isinstance(written, form.Name | form.Member) and _is_empty(value):
                put(self._language.machine, written, replace(value, open=True), given.frame)
            elif isinstance(written, form.Name | form.Member) and is_empty_text(value):
                put(self._language.machine, written, replace(value, unsure=True), given.frame)

    def _slots(self, of: Value) -> list[Bound]:
        """Return the methods of an object that Qt connects to signals by their names: `on_start_clicked`."""
        if not isinstance(of, Object):
            return []
        names = (name for cls, _ in self._kinds.chain(of.kind)[0] for name in self._linker.methods(cls))
        return [Bound(name, of) for name in names if _SLOT.fullmatch(name)]

    # Methods

    def method(self, of: Value, name: str, given: Arguments, written: Expression | None = None) -> Value:
        """Call a method of a value; `written` is the expression of the value."""
        result = self._of_object(of, name, given) if isinstance(of, Object) else None
        if isinstance(of, Unknown) and given.template:
            result = self._node_of(given)
        if result is None and not (isinstance(of, Object) and of.kind.cls is not None):
            kind = given.template[0] if given.template else None
            result = self._language.machine.framework.call_unknown_node(name, kind, given)
        if result is None:
            result = library.method(self._language, of, name, given, written)
        if result is None and name in ("first", "second"):
            result = self._call_member(self._language.member(of, name), given)  # `found->second(value)`
        if result is not None:
            return result
        if isinstance(of, Object) and of.kind.cls is None and of.kind.names:
            self._language.hand_node((*of.kind.names, name), given.values)
        self._leave(given, name)
        return outside(name, given.values, of.reason if isinstance(of, Unknown) else None)

    def _call_member(self, member: Value | None, given: Arguments) -> Value | None:
        """Call a function that a member holds; return None for other values."""
        functions = member is not None and all(isinstance(one, Closure | Bound) for one in alternatives(member))
        return self.value(member, given) if member is not None and functions else None

    def _node_of(self, given: Arguments) -> Object | None:
        """Return the node that a method of an unknown object gives, if its template argument is a class of nodes."""
        first = given.template[0]
        node = Object(pointee(first.kind), created=False) if isinstance(first, TypeValue) else None
        framework = self._language.machine.framework
        if node is None or not framework.is_node(node):
            return None
        return framework.host_node() if node.kind.cls is None else node

    def _of_object(self, of: Object, name: str, given: Arguments) -> Value | None:
        """Call a method of an object; return None for methods unknown to the sources and the frameworks."""
        language = self._language
        if name in _SPINNING and of.kind.cls is None and of.kind.names[0] in _SPINS:
            language.machine.drain()
        fitting = self._fitting(of.kind, name, given)
        if fitting and of.created:
            return self._on(of, fitting, given)
        node = language.machine.framework.is_node(of)
        if not fitting or node:
            result = language.machine.framework.call_method(of, name, given)
            if result is not None:
                return result
        if fitting and node:  # what it creates on a node that was passed in belongs to the caller
            return self._on(of, fitting, given)
        if not fitting and name in of.fields:
            return self._call_member(of.fields[name], given)
        if fitting:
            chosen, bound = self.overload(fitting, given.values, given)
            if language.reaches(chosen):  # an object that others made, and that makes something for this node
                return self._on(of, fitting, given)
            self._leave(given, name)
            return labelled(language.unknown(chosen.returns, frame_of(chosen, bound), name), name, given.values)
        for cls, bound in self._kinds.chain(of.kind)[0]:
            declared = cls.declared.get(name)
            if declared:
                self._leave(given, name)
                return labelled(language.unknown(declared[0].returns, inside(cls, bound), name), name, given.values)
        pointed = self._pointed(of)
        return self.method(pointed, name, given) if isinstance(pointed, Object) else None

    def _pointed(self, of: Object) -> Value | None:
        """Return what the `operator->` of an object gives; None if its class has none."""
        operators = self._language.methods(of.kind, "operator->")[-1:]
        value = self._on(of, operators, Arguments([])) if operators and of.created else None
        for one, bound in operators if value is None or isinstance(value, Unknown) else ():
            value = self._language.unknown(one.returns, frame_of(one, bound), one.name)
        return value if value is not of else None

    def _on(self, of: Object, methods: list[Overload], given: Arguments) -> Value:
        """Run the best overload of a method on an object."""
        # A method of a class hides those of its bases with the same name, whatever their parameters are.
        nearest = [one for one in methods if one[0].owner is methods[0][0].owner]
        return self._invoke(nearest, given, of)

    def _static(self, kind: Kind, name: str, given: Arguments) -> Value | None:
        """Call a static method of a class; return None if the class has none of that name."""
        methods = self._fitting(kind, name, given)
        return self._invoke(methods, given) if methods else None

    def _fitting(self, kind: Kind, name: str, given: Arguments) -> list[Overload]:
        """Return the methods of a name that can take the arguments of a call."""
        fitting = [method for method in self._language.methods(kind, name) if fits(method[0], len(given.values))]
        if not any(method.pattern for method, _ in fitting):
            return fitting
        chosen = chosen_functions(self._kinds, [method for method, _ in fitting], given.template)
        return [one for one in fitting if one[0] in chosen]

    def _invoke(self, overloads: list[Overload], given: Arguments, this: Object | None = None) -> Value:
        """Run the best overload of a function."""
        chosen, bound = self.overload(overloads, given.values, given)
        frame = frame_of(chosen, bound, None if chosen.static else this)
        frame.types.update(zip(chosen.template, given.template, strict=False))
        self._kinds.bind_template(chosen, frame, given.values, given.written, given.frame)
        return self._language.machine.invoke(chosen, frame, given.values, given.written, given.frame)

    def overload(self, found: list[Overload], values: list[Value], given: Arguments | None = None) -> Overload:
        """Return the overload whose parameters suit some arguments best, by their values and their declared types."""
        if len(found) == 1:
            return found[0]
        kinds: list[Kind | None] = [None] * len(values)
        if given is not None and given.frame is not None and len(given.written) == len(values):
            kinds = [self._kinds.type_of(one, given.frame) for one in given.written]
        return max(found, key=lambda one: self._likeness(one[0], one[1], values, kinds))

    def _likeness(
        self, function: Function, bound: dict[str, Value], values: list[Value], kinds: list[Kind | None]
    ) -> float:
        frame = frame_of(function, bound)
        score = 0.0
        for parameter, argument, kind in zip(function.parameters, values, kinds, strict=False):
            if parameter.variadic:
                score -= 0.5
                break
            score += library.likeness(self._language, parameter.type, argument, frame, function.template)
            if kind is not None and kind == self._kinds.kind_of(parameter.type, frame):
                score += 0.5
        return score - 0.01 * abs(len(function.parameters) - len(values))


def _is_empty(value: Value) -> TypeGuard[Sequence | Mapping]:
    return isinstance(value, Sequence | Mapping) and not value.items and not value.open and value.parameter is None


def _name_of_member(written: Expression, frame: Frame) -> str | None:
    """Return the name in `this->name`, and in `name` if it is no local variable; None for other expressions."""
    if isinstance(written, form.Member):
        return written.name if isinstance(written.of, form.Name) and written.of.names == ("this",) else None
    if not isinstance(written, form.Name) or len(written.names) > 1 or frame.holder(written.names[0]) is not None:
        return None
    return written.names[0]


def _supported(kind: str, written: tuple[Expression, ...]) -> Value:
    """Return the type of the definition that `ROSIDL_GET_..._TYPE_SUPPORT(package, folder, type)` names."""
    names = [one.names[-1] for one in written if isinstance(one, form.Name)]
    return TypeValue(Kind((names[0], kind, names[-1]))) if len(names) > 1 else Unknown("its type is not known")


def _constructs(function: Function) -> bool:
    """Return whether a function that is defined outside of a class is a constructor of it."""
    return function.scope[-1:] == (function.name,) and function.returns is None


def _same_types(one: Function, other: Function) -> bool:
    """Return whether two functions have parameters of the same types, as written without namespaces."""
    first, second = ([p.type and p.type.name for p in function.parameters] for function in (one, other))
    return first == second


def fits(function: Function, count: int) -> bool:
    """Return whether a function can take a number of arguments."""
    parameters = function.parameters
    most = count if any(p.variadic for p in parameters) else len(parameters)
    first = parameters[0] if parameters else None
    if first is not None and not first.name and first.type is not None and first.type.names == ("void",):
        return count <= most
    return sum(1 for p in parameters if p.default is None and not p.variadic) <= count <= most
