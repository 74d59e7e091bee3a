"""Constructions of objects in C++: constructors, bases, member initialisers, aggregates."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Final, TypeAlias

from kg.extract.cpp import library
from kg.extract.cpp.calls import fits
from kg.extract.cpp.kinds import frame_of, inside
from kg.symbolic import form
from kg.symbolic.binding import bind
from kg.symbolic.kinds import is_pointer
from kg.symbolic.state import Arguments, Frame, Site
from kg.symbolic.values import Kind, Object, Sequence, Text, Truth, TypeValue, Unknown, Value, number

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.extract.cpp.language import Cpp
    from kg.symbolic.form import Class, Expression, Field, Function, Type

_DEEPEST: Final = 60
_PAIR: Final = 2
_Initialisers: TypeAlias = "dict[str, form.Initialiser]"
"""What a constructor initialises, by name."""


class Constructions:
    """The creation of objects in a program."""

    def __init__(self, language: Cpp) -> None:
        self._language = language
        self._kinds = language.kinds
        self._around: list[Class] = []
        """The classes whose members are initialised, the outermost first."""

    def expression(self, expression: form.Construct, frame: Frame) -> Value:
        """Return the object of a construction."""
        arguments = self._language.machine.arguments(expression.arguments, frame)
        if expression.type.pointer and not expression.heap and len(arguments) == 1:
            return arguments[0]
        kind = self._kinds.kind(expression.type, frame)
        if isinstance(kind, TypeValue):
            kind = kind.kind
        if not isinstance(kind, Kind):
            return arguments[0] if len(arguments) == 1 else Unknown("its type is not known")
        if not arguments and not expression.heap and (kind.name in library.NUMBERS or kind.name == "bool"):
            return library.stored(kind, number(0.0)) if kind.name != "bool" else Truth(False)
        create = self._braced if expression.listed else self.construct
        result = create(kind, arguments, frame, expression.line)
        if expression.heap and isinstance(result, Object):
            result.heap = True
        return result

    def default(self, kind: Type, frame: Frame, line: int) -> Value:
        """Return the value of a variable that is declared without one."""
        if kind.pointer:
            return Unknown("it is null")
        resolved = self._kinds.kind(kind, frame)
        if not isinstance(resolved, Kind):
            return Unknown("its type is not known")
        if is_pointer(resolved):
            return Unknown("it is null")
        with self._at(frame, line):
            value = self.construct(resolved, [], frame, line)
        if isinstance(value, Object) and value.kind.cls is None:
            value.native["empty"] = Truth(True)
        return value

    def construct(
        self, kind: Kind, arguments: list[Value], frame: Frame | None, line: int = 0, *, listed: bool = False
    ) -> Value:
        """Return a new object of a type; `listed` if braces hold the arguments."""
        machine = self._language.machine
        if kind.cls is None or machine.framework.replaces(kind):
            return self._outside(kind, arguments, line, listed=listed)
        if len(arguments) == 1 and isinstance(arguments[0], Object) and arguments[0].kind.cls is kind.cls:
            return self._language.copies.copied(arguments[0], kind)
        instance = machine.created(Object(kind, line=line, path=frame.unit.path if frame is not None else ""))
        if len(machine.stack) <= _DEEPEST:
            self.initialise(instance, kind, arguments, listed=listed)
            machine.framework.constructed(instance)
        return instance

    def _outside(self, kind: Kind, arguments: list[Value], line: int, *, listed: bool) -> Value:
        """Return an object of a class outside of the sources: of a framework, of a library, or unknown."""
        if is_pointer(kind):
            return arguments[0] if arguments else Unknown("it is null")
        result = self._language.machine.framework.construct(kind, Arguments(arguments))
        if result is None:
            result = library.construct(self._language, kind, arguments, listed=listed)
        if result is None:
            result = self._wrapped(kind, arguments, line)
        if result is not None:
            return result
        self._language.escape(arguments)
        self._language.hand_node(kind.names, arguments)
        if not arguments or kind.names[:1] not in (("std",), ("auto",)):
            return Object(kind, line=line)
        return Unknown("it is of a class that is not in the build")

    def _wrapped(self, kind: Kind, arguments: list[Value], line: int) -> Value | None:
        """Return an object of the class that a template outside of the sources, such as a state machine, derives from.

        It is an argument of the template with a constructor for the arguments, one of which is a node. None for others.
        """
        nodes = (one for one in arguments if isinstance(one, Object) and self._language.machine.framework.is_node(one))
        if not kind.arguments or next(nodes, None) is None:
            return None
        for one in kind.arguments:
            cls = one.kind.cls if isinstance(one, TypeValue) else None
            constructors = self._language.linker.methods(cls).get(cls.name, ()) if cls is not None else ()
            if isinstance(one, TypeValue) and any(fits(function, len(arguments)) for function in constructors):
                return self.construct(one.kind, arguments, None, line)
        return None

    def initialise(
        self,
        this: Object,
        kind: Kind,
        arguments: list[Value],
        *,
        listed: bool = False,
        without: tuple[Function, ...] = (),
    ) -> None:
        """Run the constructor of one class of an object: its bases, its members, its body.

        `without` are the constructors that delegated to this one.
        """
        cls, machine = kind.cls, self._language.machine
        if cls is None:
            machine.framework.construct_base(this, kind, Arguments(arguments))
            return
        if len(machine.stack) > _DEEPEST:
            machine.reached("depth")
            return
        bound = self._kinds.bound(cls, kind.arguments)
        own = inside(cls, bound, this)
        constructors = self._kinds.own_methods(cls, bound, self._language.linker.methods(cls).get(cls.name, []))
        candidates = [(f, bound) for f in constructors if fits(f, len(arguments)) and f not in without]
        if not candidates:
            self._aggregate(this, cls, own, arguments, listed=listed)
            return
        chosen, _ = self._language.calls.overload(candidates, arguments)
        frame = frame_of(chosen, bound, this)
        self._kinds.bind_template(chosen, frame, arguments)
        if len(machine.stack) > _DEEPEST or machine.running[id(chosen)] >= machine.most_repeats:
            machine.reached("depth")
            return
        bind(machine, chosen, frame, arguments)
        given = {one.name: one for one in chosen.initialisers}
        if cls.name in given:
            self.initialise(this, kind, machine.arguments(given[cls.name].arguments, frame), without=(*without, chosen))
        else:
            self._bases(this, cls, own, frame, given)
            self._members(this, cls, own, frame, given)
        with machine.entered(chosen):  # after bases and members, as in C++
            machine.run(chosen.body, frame)

    def _aggregate(self, instance: Object, cls: Class, own: Frame, arguments: list[Value], *, listed: bool) -> None:
        """Initialise an object of a class without a constructor for some arguments."""
        inherited = bool(arguments) and bool(cls.bases) and not (listed and cls.fields)
        if inherited:
            for index, base in enumerate(cls.bases):
                resolved = self._kinds.kind(base, own)
                if isinstance(resolved, Kind):
                    self.initialise(instance, resolved, arguments if index == 0 else [])
        else:
            self._bases(instance, cls, own, own, {})
        self._members(instance, cls, own, own, {})
        if inherited and not listed:
            return
        designated = [pair for pair in (_designated(one, cls) for one in arguments) if pair is not None]
        if not designated or len(designated) != len(arguments):
            declared = [field for field in cls.fields.values() if not field.static]
            designated = list(zip(declared, arguments, strict=False))
        for field, value in designated:
            instance.fields[field.name] = self._language.converted(value, field.type, None, own)

    @contextmanager
    def _at(self, frame: Frame, line: int, given: tuple[Expression, ...] = ()) -> Iterator[None]:
        """Run something as part of a line of a frame."""
        stack = self._language.machine.stack
        stack.append(Site(frame.unit, line, frame.this, given, frame))
        try:
            yield
        finally:
            stack.pop()

    def _bases(self, instance: Object, cls: Class, own: Frame, frame: Frame, given: _Initialisers) -> None:
        for base in cls.bases:
            resolved = self._kinds.kind(base, own)
            if not isinstance(resolved, Kind) or resolved.cls is cls:
                continue
            entry = given.get(base.name) or given.get(resolved.name) or self._by_alias(resolved, cls, own, given)
            with self._at(frame, entry.line) if entry.line else self._at(own, cls.line):
                self.initialise(instance, resolved, self._language.machine.arguments(entry.arguments, frame))

    def _by_alias(self, base: Kind, cls: Class, own: Frame, given: _Initialisers) -> form.Initialiser:
        """Return the initialiser of a base that it calls by another name, an empty one if there is none."""
        for name, entry in given.items():
            if name not in cls.fields:
                resolved = self._kinds.kind(form.Type((name,)), own)
                if isinstance(resolved, Kind) and resolved.names == base.names:
                    return entry
        return form.Initialiser("")

    def _members(self, instance: Object, cls: Class, own: Frame, frame: Frame, given: _Initialisers) -> None:
        machine = self._language.machine
        self._around.append(cls)
        for field in _in_order(cls, given):
            kind = field.type
            if field.static:
                continue
            if field.name in given:
                entry = given[field.name]
                with self._at(frame, entry.line, entry.arguments):
                    value = self._initialised(kind, machine.arguments(entry.arguments, frame), own, entry)
            elif field.value is not None:
                with self._at(own, field.line):
                    value = self._valued(field, field.value, own)
            elif kind is not None and not kind.pointer and not kind.reference and not self._is_around(kind, own):
                with self._at(own, field.line):
                    value = self.default(kind, own, field.line)
            else:
                continue
            machine.write(instance.fields, field.name, value)
        self._around.pop()

    def _is_around(self, kind: Type, own: Frame) -> bool:
        """Check whether the type of a member is a class around it, so that the member is a pointer by another name."""
        resolved = self._kinds.kind(kind, own)
        return isinstance(resolved, Kind) and resolved.cls is not None and resolved.cls in self._around

    def _initialised(self, kind: Type | None, arguments: list[Value], own: Frame, entry: form.Initialiser) -> Value:
        """Return the value of a member that a constructor initialises."""
        if kind is None or kind.pointer or kind.reference or self._is_around(kind, own):
            return arguments[0] if arguments else Unknown("it is null")
        resolved = self._kinds.kind(kind, own)
        if not isinstance(resolved, Kind):
            return arguments[0] if len(arguments) == 1 else Unknown("its type is not known")
        return self.construct(resolved, arguments, own, entry.line, listed=entry.listed)

    def _valued(self, field: Field, written: Expression, own: Frame) -> Value:
        """Return the value of a member that its declaration initialises."""
        value = self._language.machine.value(written, own)
        if not isinstance(value, Sequence) or field.type is None or not isinstance(written, form.Display):
            return self._language.converted(value, field.type, written, own)
        if self._is_around(field.type, own):
            return value.items[0] if value.items else Unknown("it is null")
        kind = self._kinds.kind(field.type, own)
        if isinstance(kind, Kind):
            return self._braced(kind, list(value.items), own, field.line)
        return value

    def _braced(self, kind: Kind, items: list[Value], frame: Frame | None, line: int) -> Value:
        """Return a new object that a declaration initialises with braces; without items a text is as without braces."""
        return self.construct(kind, items, frame, line, listed=bool(items) or kind.name not in library.TEXTS)


def _in_order(cls: Class, given: _Initialisers) -> Iterable[Field]:
    """Return the members in the order of their declaration, but a member before those that receive it.

    A member can keep a reference to one that is initialised after it.
    """
    order = list(cls.fields)
    for receiver, entry in given.items():
        for argument in entry.arguments if receiver in cls.fields else ():
            name = _referred(argument)
            if name in cls.fields and order.index(name) > order.index(receiver):
                order.remove(name)
                order.insert(order.index(receiver), name)
    return map(cls.fields.__getitem__, order)


def _referred(argument: Expression) -> str:
    """Return the name of the variable that an argument is, or whose address it is; empty for others."""
    if isinstance(argument, form.Unary) and argument.sign == "&":
        argument = argument.operand
    return argument.names[0] if isinstance(argument, form.Name) and len(argument.names) == 1 else ""


def _designated(value: Value, cls: Class) -> tuple[Field, Value] | None:
    """Return the field and the value of `.name = value`, as the interpreter represents it; None for other values."""
    if isinstance(value, Sequence) and len(value.items) == _PAIR and isinstance(value.items[0], Text):
        field = cls.fields.get(value.items[0].exact or "")
        return (field, value.items[1]) if field is not None else None
    return None
