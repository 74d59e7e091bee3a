"""The meaning of names, members and values of C++ for the interpreter."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, Final, cast

from kg.extract.cpp import library, packs
from kg.extract.cpp.callbacks import Callbacks
from kg.extract.cpp.calls import Calls, Overload
from kg.extract.cpp.construction import Constructions
from kg.extract.cpp.copies import Copies
from kg.extract.cpp.formats import MANIPULATORS, formatted, streamed
from kg.extract.cpp.kinds import Kinds, inside, this_of
from kg.extract.cpp.macros import calls_in
from kg.extract.cpp.project import COVERED
from kg.extract.cpp.specialising import UNKNOWN
from kg.symbolic import form
from kg.symbolic.containers import counted, element, elements, key_of, with_element
from kg.symbolic.spelling import spelled
from kg.symbolic.state import Alias, Frame, decides
from kg.symbolic.values import (
    OUTSIDE,
    PLACEHOLDER,
    Bound,
    Closure,
    Either,
    Kind,
    Number,
    Object,
    Pack,
    Sequence,
    Text,
    TypeValue,
    Unknown,
    Value,
    join,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from kg.extract.cpp.linking import Linker, Variable
    from kg.extract.cpp.macros import Macro
    from kg.symbolic.form import Class, Expression, Field, Function, Type
    from kg.symbolic.machine import Machine

_PLACEHOLDER: Final = re.compile(r"_[1-9]")
_RELATIONS: Final = frozenset({"is_same", "is_same_v", "is_base_of", "is_base_of_v"})
_READER: Final = re.compile(
    r"(?i:load|get|read|fetch|from|retrieve).*(?:R(?:os|OS)(?:N(?:s|amespace)|Param\w*)?\Z|[pP]aram(?:eter)?s?(?![a-z]))"
)
"""The names of functions that read parameters: `loadFromRosNs`, `getParams`."""
_PAIR: Final = ("first", "second")
_STORED: Final = frozenset({Either, Object, Text, Number, Sequence})
"""Values that a variable may hold in another form."""
_NOTHING: Final = Sequence(())
"""The value of `{}`."""


class Cpp:
    """The meaning of C++ in one program, whose names `linker` finds."""

    machine: Machine

    def __init__(self, linker: Linker) -> None:
        self.linker = linker
        self.kinds = Kinds(self)
        self.copies = Copies(self)
        self.expressions: Mapping[type, Callable[[Any, Frame], Value]] = {
            form.Lambda: self.copies.closure,
            form.Spread: partial(packs.expand, self),
        }
        self.statements: Mapping[type, Callable[[Any, Frame], None]] = {form.Static: self._static_local}
        self.calls = Calls(self)
        self._constructions = Constructions(self)
        self.kind = self.kinds.kind
        self.kind_of = self.kinds.kind_of
        self.type_of = self.kinds.type_of
        self.nested_type = self.kinds.nested_type
        self.message = self.kinds.message
        self.chain = self.kinds.chain
        self.reaches = linker.project.reach.reaches
        self.call = self.calls.call
        self.construct_expression = self._constructions.expression
        self.construct = self._constructions.construct
        self.initialise = self._constructions.initialise
        self.default = self._constructions.default
        callbacks = self._callbacks = Callbacks(self)
        self.escape, self.enter, self.hand_over = callbacks.escape, callbacks.enter, callbacks.hand_over
        self.spares = callbacks.spares
        self.elements = elements
        self.with_element = with_element
        self.counted = counted

    # Names

    def name(self, expression: form.Name, frame: Frame) -> Value:
        """Return the meaning of a name that is not a local variable."""
        names, last = expression.names, expression.names[-1]
        this = this_of(frame)
        if names == ("this",):
            return this or Unknown("it is the object")
        if len(names) == 1:
            bound = frame.bound_type(last)
            if bound is None and isinstance(this, Object):
                bound = self._of_object(this, last)
            if bound is not None:
                return bound
        if _PLACEHOLDER.fullmatch(last):
            return PLACEHOLDER
        if expression.template and (names[-2] if last == "value" and len(names) > 1 else last) in _RELATIONS:
            return self.kinds.related(
                *self.kinds.template(expression.template, frame)[:2], same="is_same" in "".join(names)
            )
        variable = self.linker.find_variable(names, frame.unit, frame.scope)
        if variable is not None and variable[0].value is not None:
            return self._global(variable, last)
        if len(names) == 1 and frame.scope:
            value = self._static((frame.scope[-1], last), (), Frame(frame.unit, frame.scope[:-1]))
            if value is not None and not isinstance(value, Bound):
                return value
        if len(names) > 1:
            value = self._static(names, self.kinds.template(expression.template, frame), frame)
            if value is not None:
                return value
        if variable is not None:  # a static member can have its value in the class
            return self._global(variable, last)
        functions = self.linker.find_functions(names, frame.unit, frame.scope)
        if functions:
            return Bound(last, None, tuple(functions), template=self.kinds.template(expression.template, frame))
        constant = self.machine.framework.constant(names) or self._of_message(names, frame)
        if constant is not None:
            return constant
        enumerator = self.linker.find_enumerator(last, frame.unit)
        if enumerator is not None:
            return enumerator
        if len(names) == 1:
            macro = self.linker.find_macro(last, frame.unit, expression.line)
            if macro is not None and macro.parameters is None:
                return self.expanded(macro, (), frame, expression.line)
        resolved = self.kinds.kind(form.Type(names, expression.template), frame)
        if isinstance(resolved, Kind) and (resolved.cls is not None or resolved.names != names):
            return TypeValue(resolved)
        standard = names[:-1] == ("std",) or (len(names) == 1 and ("std",) in frame.unit.uses)
        known = library.CONSTANTS.get(last) or (MANIPULATORS.get(last) if standard else None)
        return known or Unknown(f"{'::'.join(names)} {OUTSIDE}")

    def _of_message(self, names: tuple[str, ...], frame: Frame) -> Value | None:
        """Return a constant of a message by its name; None if it is none."""
        kind = self.kinds.kind(form.Type(names[:-1]), frame) if len(names) > 1 and names[-1].isupper() else None
        return self.linker.project.constants.find((*kind.names, names[-1])) if isinstance(kind, Kind) else None

    def static_member(self, kind: Kind, name: str) -> Value | None:
        """Return a static member of a class by its name; None if the class has none of that name."""
        if kind.cls is None:
            return None
        return self._static((*kind.names, name), (), Frame(kind.cls.unit, kind.cls.scope))

    def static_fields(self, of: Value) -> dict[str, Value] | None:  # noqa: ARG002 - a class is not a value in C++
        """Return None: static members are written by their names."""
        return None

    def _global(self, variable: Variable, name: str) -> Value:
        statement, unit, at = variable
        holder = self.machine.globals.setdefault(id(statement), {})
        if name not in holder:
            holder[name] = Unknown(f"{name} depends on itself")
            frame = Frame(unit, at)
            self.machine.run(statement, frame)
            value = frame.variables.get(statement.name, Unknown("it has no value"))
            zero = library.zero(self.kinds.kind_of(statement.type, frame)) if statement.value is None else None
            holder[name] = value if zero is None or statement.name in unit.external else zero
            if name in self._callbacks.changed and decides(holder[name]):
                holder[name] = Unknown("a callback changes it")
        slot = holder[name]
        return library.as_constant(slot) if not isinstance(slot, Alias) else self.machine.value(slot.target, slot.frame)

    def _static_local(self, statement: form.Static, frame: Frame) -> None:
        """Declare a variable that all calls of a function share, of each instance of a template its own.

        The first call initialises it. If this call is not certain and creates something, the next one does so too.
        """
        name, machine = statement.name, self.machine
        bound = tuple(one for around in frame.outward() for one in around.types.items())
        variables = machine.globals.setdefault((id(statement), bound), {})
        if name not in variables:
            variables[name] = Unknown(f"{name} depends on itself")
            first = form.Declare(statement.line, name, statement.type, statement.value)
            certain = machine.ahead(lambda: machine.run(first, frame))
            if statement.switched:
                variables[name] = Unknown(f"{name} changes from call to call")
            elif certain:
                variables[name] = frame.variables[name]
            else:
                del variables[name]
                return
        if statement.type is not None:
            frame.declared[name] = statement.type
        at = Frame(frame.unit, frame.scope, variables=variables)
        machine.write(frame.variables, name, Alias(form.Name(statement.line, (name,)), at))

    def _static(self, names: tuple[str, ...], template: tuple[Value, ...], frame: Frame) -> Value | None:
        outer = self.kinds.kind(form.Type(names[:-1]), frame)
        if not isinstance(outer, Kind) or outer.cls is None:
            return None
        cls = outer.cls
        methods = self.declarations(outer, names[-1])
        if (cls.template or cls.pattern) and not any(function.template for function, _ in methods):
            # `A<T>::member`, or `A::member` in a method of `A<T>`.
            outer = self.kinds.instance(cls, template) if template else self._instance(outer, frame)
            template = ()
            if outer.cls is None:
                return UNKNOWN
        for owner, bound in self.chain(outer)[0]:
            declared = owner.fields.get(names[-1])
            if declared is not None and declared.value is not None and not declared.static:
                return library.as_constant(self._declared(declared, declared.value, inside(owner, bound)))
            holder = self._shared(owner, names[-1], bound)
            if holder is not None:
                return library.as_constant(holder[names[-1]])
        variable = self.kinds.own_variable(outer, names[-1])
        if variable is not None:
            return self._global(variable, names[-1])
        return Bound(names[-1], outer, template=template) if methods else None

    def _shared(self, cls: Class, name: str, bound: dict[str, Value]) -> dict[str, Value] | None:
        """Return what holds a static member that a class defines, of each instance of a template its own.

        None for other members, and for those that are defined outside of the class.
        """
        declared = cls.fields.get(name)
        if declared is None or not declared.static or (declared.value is None and not declared.inline):
            return None
        holder = cast("dict[str, Value]", self.machine.globals.setdefault((id(declared), tuple(bound.items())), {}))
        if name not in holder:
            holder[name] = Unknown(f"{name} depends on itself")
            frame = inside(cls, bound)
            if declared.value is not None:
                holder[name] = self._declared(declared, declared.value, frame)
            elif declared.type is not None:
                holder[name] = self.default(declared.type, frame, declared.line)
        return holder

    def _instance(self, kind: Kind, frame: Frame) -> Kind:
        """Return a class with the template arguments that it has in the running object, if it is a class of that."""
        this = this_of(frame)
        if kind.arguments or not isinstance(this, Object):
            return kind
        bound = next((bound for cls, bound in self.chain(this.kind)[0] if cls is kind.cls), None)
        return Kind(kind.names, tuple(bound.values()), kind.cls) if bound else kind

    def _declared(self, field: Field, value: Expression, frame: Frame) -> Value:
        """Return the value of a static member that its declaration initialises."""
        return self.converted(self.machine.value(value, frame), field.type, value, frame)

    def expanded(self, macro: Macro, given: tuple[Expression, ...], frame: Frame, line: int) -> Value:
        """Run the text of a macro in the frame that uses it, at a line there."""
        texts = tuple(map(spelled, given)) if macro.is_textual or macro.is_list else ()
        texts = texts if not any("..." in one for one in texts) else ()
        listed = calls_in(macro.filled(texts)) if macro.is_list and (texts or not given) else []
        if len(listed) > 1:
            for name, arguments in listed:
                if (entry := self.linker.find_macro(name, frame.unit, line)) is not None:
                    self._run_macro(entry, (), arguments, frame, line)
            return Unknown("it returns nothing")
        return self._run_macro(macro, given, texts if macro.is_textual else (), frame, line)

    def _run_macro(
        self, macro: Macro, given: tuple[Expression, ...], texts: tuple[str, ...], frame: Frame, line: int
    ) -> Value:
        """Run the text of a macro; `texts` are arguments that become a part of it, in place of those that are given."""
        function = macro.unit.expand(macro, line, texts)
        inner = Frame(frame.unit, frame.scope, frame.this, parent=frame)
        if texts:  # what the text declares is where the macro is used
            inner = replace(inner, variables=frame.variables, types=frame.types, declared=frame.declared)
        for parameter, expression in zip(function.parameters, given if not texts else (), strict=False):
            inner.variables[parameter.name] = Alias(expression, frame)
            if isinstance(expression, form.Name) and len(expression.names) > 1:
                resolved = self.kinds.kind(form.Type(expression.names, expression.template), frame)
                inner.types[parameter.name] = TypeValue(resolved) if isinstance(resolved, Kind) else resolved
        running = self.machine.running
        if running[id(macro)]:
            return Unknown("the macro expands to itself")
        running[id(macro)] += 1
        try:
            self.machine.run(function.body, inner)
        finally:
            running[id(macro)] -= 1
        return join(*inner.returned) if inner.returned else Unknown("it returns nothing")

    def hand_node(self, names: tuple[str, ...], arguments: list[Value]) -> None:
        """Record a node among the arguments of code outside of the sources that no description covers."""
        if not COVERED.issuperset(names[:1]):
            self.machine.framework.leave(names, arguments)

    def hand_parameters(self, names: tuple[str, ...], arguments: list[Value]) -> None:
        """Record a call of code outside of the sources that reads parameters, as all code may do with roscpp."""
        project = self.linker.project
        if project.ros == 1 and arguments and not COVERED.issuperset(names[:1]) and _READER.search(names[-1]):
            self.machine.framework.left(names, None, "and reads parameters")

    def assign_name(self, target: form.Name, value: Value, frame: Frame) -> None:
        """Assign a value to a member of the object that runs, or to a variable at namespace scope."""
        this, names, last = this_of(frame), target.names, target.names[-1]
        own = this if isinstance(this, Object) and len(names) == 1 and self.kinds.has_field(this, last) else None
        classes = [one for one in self.chain(own.kind)[0] if last in one[0].fields] if own is not None else []
        variable = None
        if own is None or any(cls.fields[last].static for cls, _ in classes):
            variable = self.linker.find_variable(names, frame.unit, frame.scope)
        if variable is not None:
            self.machine.write(self.machine.globals.setdefault(id(variable[0]), {}), last, value)
            return
        if own is None and (outer := names[:-1] or frame.scope[-1:]):
            kind = self.kinds.kind(form.Type(outer), frame)
            classes = self.chain(kind)[0] if isinstance(kind, Kind) else []
        holder = next((one for cls, bound in classes if (one := self._shared(cls, last, bound)) is not None), None)
        if holder is not None or own is not None:
            self.machine.write(holder if holder is not None else cast("Object", own).fields, last, value)
        elif isinstance(this, Object) and self.chain(this.kind)[1]:
            self.hand_over([value])  # the variable may be one of a base that is not in the sources

    # Members

    def member(self, of: Value, name: str) -> Value:
        """Return a member of a value."""
        if isinstance(of, Object):
            value = self._of_object(of, name)
            return value if value is not None else Unknown(f"the member {name} is not known")
        if isinstance(of, Sequence) and name in _PAIR and len(of.items) == len(_PAIR):
            return of.items[_PAIR.index(name)]
        if isinstance(of, (Text, Unknown)) and of.parameter is not None:
            if name in _PAIR and of.parameter.endswith("[]"):  # the value of a map at a key
                return of if name == "second" else key_of(of.parameter[:-2])
            return Text.hole(f"it is part of a parameter: {of.parameter}", parameter=f"{of.parameter}.{name}")
        return Unknown(of.reason if isinstance(of, Unknown) else f"the member {name} is not known")

    def _of_object(self, of: Object, name: str) -> Value | None:
        """Return a field or a method of an object; None if it has none of that name."""
        if name in of.fields:
            return of.fields[name]
        for cls, bound in self.chain(of.kind)[0]:
            if name in cls.fields:
                return self._unwritten(of, cls, name, inside(cls, bound))
        return Bound(name, of) if self.methods(of.kind, name) else None

    def _unwritten(self, of: Object, cls: Class, name: str, frame: Frame) -> Value:
        """Return the value of a field that the code that ran did not write."""
        declared = cls.fields[name]
        holder = self._shared(cls, name, frame.types)
        if holder is not None:
            return holder[name]
        if declared.static:
            variable = self.linker.find_variable((cls.inside[-1], name), cls.unit, cls.scope)
            if variable is not None:
                return self._global(variable, name)
        if not of.created:
            return self.unknown(declared.type, frame, name)
        return Unknown(f"{name} is given no value in the code that was run")

    def methods(self, kind: Kind, name: str) -> list[Overload]:
        """Return the methods of a name that a class has, its own before those of its bases."""
        cached = self.kinds.methods_of(kind)
        if name not in cached:
            methods = self.linker.methods
            cached[name] = [
                (one, bound)
                for cls, bound in self.chain(kind)[0]
                for one in self.kinds.own_methods(cls, bound, methods(cls).get(name, []))
            ]
        return cached[name]

    def declarations(self, kind: Kind, name: str) -> list[Overload]:
        """Return the methods of a name; their declarations if none has a body."""
        methods = self.methods(kind, name)
        return methods or [(one, bound) for cls, bound in self.chain(kind)[0] for one in cls.declared.get(name, ())]

    # Values

    def unknown(self, kind: Type | None, frame: Frame, name: str) -> Value:
        """Return a value of a type that comes from outside: an unknown text, an object that no code creates."""
        resolved = self.kind_of(kind, frame)
        if resolved is None:
            return Unknown(f"{name} comes from outside")
        given = self.machine.framework.given(resolved, name)
        if given is not None:
            return given
        if resolved.name in library.TEXTS or resolved.name == "char":
            return Text.hole(f"{name} comes from outside")
        if resolved.cls is not None or (len(resolved.names) > 1 and resolved.names[0] != "std"):
            return Object(resolved, created=False)
        return Unknown(f"{name} comes from outside")

    def converted(self, value: Value, kind: Type | None, written: Expression | None, frame: Frame) -> Value:
        """Return a value as a variable of a type holds it."""
        if isinstance(value, (Closure, Bound, Pack)):
            return value
        if written is not None and (kind is None or not (kind.reference or kind.pointer)):
            value = self.copies.copy(value, kind, frame, written, frame)
        if kind is None or type(value) not in _STORED:
            return value
        if isinstance(value, Object):
            return self._wrapped(value, kind, frame)
        if isinstance(value, Either):
            return join(*(self.converted(item, kind, None, frame) for item in value.items))
        if isinstance(value, Text) and kind.names == ("auto",):
            return value
        if isinstance(value, Sequence):
            if value == _NOTHING:
                return self._nothing(kind, frame)
            target = self.kind_of(kind, frame)
            if target is not None and (
                target.cls is not None or target.name in library.MAPS or self.machine.framework.is_handle(target)
            ):
                return self.construct(target, list(value.items), frame, listed=True)
        elif isinstance(value, (Text, Number)) and not kind.reference and not kind.pointer:
            target = self.kind_of(kind, frame)
            if target is not None and (target.cls is not None or self.machine.framework.constructs(target)):
                return self.construct(target, [value], frame)
            if target is not None:
                return library.stored(target, value)
        return value

    def _wrapped(self, value: Object, kind: Type, frame: Frame) -> Value:
        """Return an object as a variable of a type holds it: in a new one if a constructor takes objects of any type.

        Classes that hide the type of what they hold (type erasure) have such constructors.
        """
        target = self.kinds.variable_kind(kind, frame) if not kind.pointer else None
        wrapper = target.cls if target is not None else None
        if target is None or wrapper is None or wrapper is value.kind.cls or value.kind.cls is None:
            return value
        if not any(map(_takes_any, self.linker.methods(wrapper).get(wrapper.name, ()))):
            return value
        inherits = any(cls is wrapper for cls, _ in self.chain(value.kind)[0])
        return value if inherits else self.construct(target, [value], frame)

    def _nothing(self, kind: Type, frame: Frame) -> Value:
        """Return the value of `{}` in a variable of a type."""
        target = self.kinds.variable_kind(kind, frame)
        if target is None or target.name in library.LISTS:
            return _NOTHING
        return self.construct(target, [], frame, listed=True)

    def assigned(self, target: Expression, value: Value, written: Expression, frame: Frame) -> Value:
        """Return a value as the target of an assignment holds it."""
        value = self.copies.assigned(target, value, written, frame)
        if not isinstance(target, (form.Name, form.Member)):
            return value
        if isinstance(value, Text):
            held = self.machine.value(target, frame)
            if isinstance(held, Object) and (held.kind.cls is not None or self.machine.framework.constructs(held.kind)):
                return self.construct(held.kind, [value], frame)
        if isinstance(value, Number):
            kind = self.kinds.type_of(target, frame)
            return library.stored(kind, value) if kind is not None else value
        if isinstance(value, Sequence):
            declared = self.kinds.written_type(target, frame)
            if declared is not None:
                return self.converted(value, declared[0], written, declared[1])
        return value

    def create(self, value: Value) -> None:
        """Create an object of a class, as code outside of the sources does."""
        if isinstance(value, TypeValue):
            self.construct(value.kind, [], None)

    def element(self, of: Value, key: Value) -> Value:
        """Return the element of a container at a key."""
        return element(of, key)

    def formatted(self, row: tuple[Value, ...]) -> Value:
        """Return the result of `%` between a format and values."""
        pattern, *values = row
        return formatted(pattern.native.get("format", pattern) if isinstance(pattern, Object) else pattern, values)

    def shifted(self, values: list[Value]) -> Value | None:
        """Return a stream after texts were written to it; None if `<<` shifts bits."""
        first = values[0]
        if isinstance(first, Object) and first.kind.name in library.STREAMS:
            text, manner = streamed(first, values[1:])
            self.machine.write(first.native, "text", text)
            if manner.items or "manner" in first.native:
                self.machine.write(first.native, "manner", manner)
        return None if isinstance(first, Number) else first


def _takes_any(constructor: Function) -> bool:
    """Return whether a constructor converts an object of any type: its only parameter has that of a template."""
    kind = constructor.parameters[0].type if len(constructor.parameters) == 1 else None
    return kind is not None and len(kind.names) == 1 and kind.names[0] in constructor.template
