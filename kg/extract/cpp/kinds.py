"""Types of C++: the meaning of written types, template parameters, and bases of classes."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Final, cast

from kg.extract.cpp import library
from kg.extract.cpp.specialising import UNKNOWN, choose, chosen_class, chosen_methods, mentions
from kg.symbolic import form
from kg.symbolic.kinds import POINTER, POINTER_ALIASES, POINTER_NAME, POINTERS, pointee
from kg.symbolic.messages import GENERATED, PARTS
from kg.symbolic.state import Alias as Reference
from kg.symbolic.state import Frame
from kg.symbolic.values import Kind, Number, Object, Pack, Sequence, Text, Truth, TypeValue, Unknown, Value

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kg.extract.cpp.language import Cpp
    from kg.extract.cpp.linking import Alias, Variable
    from kg.extract.cpp.units import CppUnit
    from kg.symbolic.form import Class, Expression, Function, Type, Unit

_DEEPEST: Final = 12
_ROSSERIAL: Final = "ros/msg.h"
"""What the headers of messages include that rosserial generates, and no other header of messages."""
_PLAIN: Final = library.NUMBERS | library.TEXTS | {"bool"}
_IN_MESSAGES: Final = {
    "string": ("std", "string"),
    "float32": ("float",),
    "float64": ("double",),
    **{f"{sign}int{bits}": (f"{sign}int{bits}_t",) for sign in ("", "u") for bits in (8, 16, 32, 64)},
}
"""The types of C++ of the fields of messages that have another name."""
_VALUES: Final = frozenset({"ParameterValue"})
"""Classes whose objects have the type of the value that they hold."""
_MOST_BASES: Final = 40
_MOST_CHOICES: Final = 3
"""How many choices of specialisations may depend on each other."""
_PAIR: Final = 2
_PARTS: Final = frozenset((part,) for part in PARTS)
_WEIGHT: Final = 6
"""How much of the depth the search in the outer type of a name takes."""


def this_of(frame: Frame) -> Value | None:
    """Return the object that a frame, or one around it, runs on."""
    current: Frame | None = frame
    while current is not None:
        if current.this is not None:
            return current.this
        current = current.parent
    return None


def inside(cls: Class, types: dict[str, Value] | None = None, this: Object | None = None) -> Frame:
    """Return a frame in the body of a class, outside of its methods."""
    return Frame(cls.unit, cls.inside, this, types=types if types is not None else {})


def frame_of(function: Function, types: Mapping[str, Value] | None = None, this: Object | None = None) -> Frame:
    """Return a new frame for a function, with the values of template parameters by the names that it has for them."""
    bound = dict(types or {})
    if function.outer and function.owner is not None:
        names = zip(function.outer, function.owner.template, strict=False)
        bound |= {own: bound[name] for own, name in names if name in bound}
    return Frame(function.unit, function.scope, this, types=bound, returns=function.returns)


class Kinds:
    """The types of a program."""

    def __init__(self, language: Cpp) -> None:
        self._language = language
        self._linker = language.linker
        self._meanings: dict[tuple[object, ...], Kind | Value] = {}
        self._choices = 0
        """Types by names, template arguments, file, scope and depth of the search."""
        self._plain: dict[tuple[int, Unit, tuple[str, ...], int], tuple[Type, Kind | Value]] = {}
        """The types that mean the same in all frames of a file and scope, by the identity of what is written."""
        self._own_aliases: dict[tuple[str, Unit, tuple[str, ...]], Alias | None] = {}
        self._chains: dict[object, tuple[list[tuple[Class, dict[str, Value]]], list[Kind]]] = {}
        self._methods: dict[object, dict[str, list[tuple[Function, dict[str, Value]]]]] = {}

    def kind(self, kind: Type, frame: Frame, depth: int = 0) -> Kind | Value:
        """Return the meaning of a type in a frame: a `Kind`, or the value of a template parameter."""
        if frame.templated:
            return self._resolve(kind, frame, depth)
        key = (id(kind), frame.unit, frame.scope, depth)
        cached = self._plain.get(key)
        if cached is None:
            resolved = self._resolve(kind, frame, depth)
            if _is_plain(kind):
                self._plain[key] = (kind, resolved)
            return resolved
        return cached[1]

    def _resolve(self, kind: Type, frame: Frame, depth: int) -> Kind | Value:
        names = kind.names if "" not in kind.names else tuple(filter(None, kind.names))
        if not names or depth > _DEEPEST:
            return Kind(names)
        if names[0].startswith("decltype("):
            declared = self.type_of(form.Name(0, (names[0][9:-1],)), frame)
            if declared is not None:
                return declared if len(names) == 1 else self._nested(declared, names[1:], (), depth)
        bound = frame.bound_type(names[0])
        written = kind.arguments or (kind.outer if names[-1] in POINTER_ALIASES else ())
        arguments = self.template(written, frame) if written else ()
        if bound is not None:
            if len(names) == 1:
                return bound.kind if isinstance(bound, TypeValue) else bound
            if isinstance(bound, TypeValue):
                own = self._alias_in(bound.kind, names[1], arguments, depth) if len(names) == _PAIR else None
                return own or self._nested(bound.kind, names[1:], arguments, depth)
        if names[0] == "std" and len(names) > 1 and len(arguments) > 1:
            computed = self._computed(names, arguments)
            if computed is not None:
                return computed
        own = self._of_template(kind, names, arguments, frame, depth)
        if own is not None:
            return own
        key = (names, arguments, frame.unit, frame.scope, depth)
        resolved = self._meanings.get(key)
        if resolved is None:
            self._meanings[key] = Kind(names, arguments)  # before it is resolved, since an alias can name itself
            resolved = self._meanings[key] = self._named(names, arguments, frame.unit, frame.scope, depth)
        return self._with_types(resolved, frame) if isinstance(resolved, Kind) and resolved.arguments else resolved

    def _of_template(
        self, kind: Type, names: tuple[str, ...], arguments: tuple[Value, ...], frame: Frame, depth: int
    ) -> Kind | Value | None:
        """Return the type that a member of an instance of a template, or a name in its body, means; None for others."""
        if len(names) == 1:
            alias = self._own_alias(names, frame) if frame.templated else None
            if alias is None:
                return None
            types = {name: value for one in reversed([*frame.outward()]) for name, value in one.types.items()}
            if not mentions(alias[1], tuple(types)):
                return None
            return self._meant(alias[1], Frame(alias[3], alias[0], types=types), depth)
        if kind.outer and names[-1] not in POINTER_ALIASES:
            owner = self.kind(form.Type(names[:-1], kind.outer), frame, depth + 1)
        elif frame.templated and len(names) == _PAIR:
            owner = self._of_template(kind, names[:1], (), frame, depth + 1) or Unknown("")
        else:
            return None
        if not isinstance(owner, Kind):
            return None
        if owner.cls is None:
            known = self._linker.find_class(owner.names, frame.unit, frame.scope)
            return UNKNOWN if known is not None else None
        return self._alias_in(owner, names[-1], arguments, depth)

    def _alias_in(self, owner: Kind, name: str, arguments: tuple[Value, ...], depth: int) -> Kind | Value | None:
        """Return the type that an alias in a class, or in a base of it, stands for; None if none has the name."""
        for cls, bound in self.chain(owner)[0] if owner.cls is not None else ():
            alias = self._linker.find_alias((name,), cls.unit, cls.inside)
            if alias is not None and alias[0] == cls.inside:
                types = bound | dict(zip(alias[2], arguments, strict=False))
                return self._meant(alias[1], Frame(alias[3], alias[0], types=types), depth)
        return None

    def _meant(self, kind: Type, frame: Frame, depth: int) -> Kind | Value:
        """Return the type that an alias stands for; that of pointers to a class is not the class."""
        meant = self.kind(kind, frame, depth + 1)
        if kind.pointer and isinstance(meant, Kind) and meant.cls is not None:
            return Kind((POINTER,), (TypeValue(meant),))
        return meant

    def _own_alias(self, names: tuple[str, ...], frame: Frame) -> Alias | None:
        """Return the meaning of a name that a class around a frame gives it without parameters of its own."""
        key = (names[0], frame.unit, frame.scope)
        if key not in self._own_aliases:
            alias = self._linker.find_alias(names, frame.unit, frame.scope)
            own = alias is not None and alias[0] and frame.scope[: len(alias[0])] == alias[0] and not alias[2]
            self._own_aliases[key] = alias if own else None
        return self._own_aliases[key]

    def kind_of(self, kind: Type | None, frame: Frame) -> Kind | None:
        """Return the type of a declaration, without pointers; None if it has none."""
        resolved = self.variable_kind(kind, frame) if kind is not None else None
        return pointee(resolved) if resolved is not None else None

    def variable_kind(self, kind: Type, frame: Frame) -> Kind | None:
        """Return the type of a variable's value, a pointer or an object; None if it is unknown."""
        resolved = self.kind(kind, frame)
        if isinstance(resolved, TypeValue):
            resolved = resolved.kind
        if not isinstance(resolved, Kind):
            return None
        return Kind((POINTER,), (TypeValue(resolved),)) if kind.pointer else resolved

    def _computed(self, names: tuple[str, ...], arguments: tuple[Value, ...]) -> Kind | Value | None:
        """Return what a template of the standard library computes from types; None if it is not known."""
        relation = names[1].removesuffix("_v")
        if len(names) == len(("std", "is_same")) and relation in {"is_same", "is_base_of"}:
            truth = self.related(arguments[0], arguments[1], same=relation == "is_same")
            if not isinstance(truth, Truth):
                return None
            return truth if relation != names[1] else Kind(("std", "true_type" if truth.value else "false_type"))
        if names == ("std", "conditional_t") and isinstance(arguments[0], Truth):
            chosen = arguments[1 if arguments[0].value else -1]
            return chosen.kind if isinstance(chosen, TypeValue) else chosen
        if names == ("std", "tuple_element_t") and isinstance(arguments[0], Number):
            tuples, at = arguments[1], arguments[0].whole
            items = tuples.kind.arguments if isinstance(tuples, TypeValue) and tuples.kind.name == "tuple" else ()
            item = items[at] if 0 <= at < len(items) else None
            return item.kind if isinstance(item, TypeValue) else item
        return None

    def _named(
        self, names: tuple[str, ...], arguments: tuple[Value, ...], unit: Unit, scope: tuple[str, ...], depth: int
    ) -> Kind | Value:
        """Return the type that a name with template arguments means in a scope of a file."""
        names = self._linker.spelled(names, unit, scope)
        alias = self._linker.find_alias(names, unit, scope) if depth < _DEEPEST else None
        if alias is not None:
            at, kind, template, home = alias
            if kind.names != names:
                inner = Frame(home, at, types=dict(zip(template, arguments, strict=False)))
                meant = self._meant(kind, inner, depth)
                if not template and arguments and isinstance(meant, Kind) and not meant.arguments:
                    return Kind(meant.names, arguments, meant.cls)  # a template that `using` declares
                return meant
        cls = self._linker.find_class(names, unit, scope)
        if cls is not None:
            # The classes of messages in headers that rosserial generated are as those that are generated elsewhere.
            elsewhere = _ROSSERIAL in cast("CppUnit", cls.unit).includes
            return Kind((*cls.scope, cls.name), arguments) if elsewhere else self.instance(cls, arguments)
        stem = POINTER_NAME.sub("", names[-1])
        pointed = self._linker.find_class((*names[:-1], stem), unit, scope) if stem and stem != names[-1] else None
        if pointed is not None:
            return _pointer(Kind((*pointed.scope, pointed.name), (), pointed))
        if len(names) == 1:
            generated = self._linker.generated(names[0], unit, scope) if names[0][:1].isupper() else None
            return Kind(generated or names, arguments)
        if names[-1] in POINTER_ALIASES:
            owner = self._named(names[:-1], arguments, unit, scope, depth + 1)
            if isinstance(owner, Kind):
                return _pointer(owner) if owner.cls is not None else Kind((*owner.names, names[-1]), owner.arguments)
        if names[0] in GENERATED and (full := self._linker.within(names, unit, scope)) is not None:
            return Kind(full, arguments)
        if names[1:] in _PARTS and (full := self._linker.generated(names[0], unit, scope)) is not None:
            return Kind((*full, names[1]), arguments)
        if depth < _DEEPEST:
            outer = self._named(names[:-1], (), unit, scope, depth + _WEIGHT)
            if isinstance(outer, Kind) and outer.names != names[:-1] and outer.cls is None:
                return Kind((*outer.names, names[-1]), arguments)
        return Kind(names, arguments)

    def _nested(self, kind: Kind, names: tuple[str, ...], arguments: tuple[Value, ...], depth: int) -> Kind | Value:
        """Return the type that a name means in a class."""
        if kind.cls is not None:
            nested = self._named(names, arguments, kind.cls.unit, kind.cls.inside, depth + 1)
            if isinstance(nested, Kind) and nested.names != names:
                return nested
            if names[-1] in POINTER_ALIASES:
                return _pointer(kind)
        return Kind((*kind.names, *names), arguments)

    def message(self, kind: Kind, frame: Frame | None) -> Kind:
        """Return the message that objects of a type are sent as, where a frame uses it: the type itself if none."""
        kind = pointee(kind)
        adapted = self._linker.find_adapted(kind.names, frame.unit) if frame is not None else None
        stated = self.kind(adapted[0], Frame(adapted[1], ())) if adapted is not None else kind
        return stated if isinstance(stated, Kind) else kind

    def nested_type(self, kind: Kind, name: str) -> Kind | None:
        """Return a type that a class names by an alias; None if it has none."""
        if kind.cls is None:
            return None
        frame = inside(kind.cls)
        if not any(at == frame.scope for at, _, _ in cast("CppUnit", frame.unit).aliases(name)):
            return None
        nested = self.kind(form.Type((name,)), frame)
        return nested if isinstance(nested, Kind) else None

    # Template parameters

    def _with_types(self, kind: Kind, frame: Frame) -> Kind:
        """Return a type that an alias of a class gives, with the values of the class's template parameters."""
        arguments = tuple(
            (frame.bound_type(one.kind.names[0]) or one)
            if isinstance(one, TypeValue) and one.kind.cls is None and len(one.kind.names) == 1
            else one
            for one in kind.arguments
        )
        if arguments == kind.arguments:
            return kind
        cls = kind.cls or self._linker.find_class(kind.names, frame.unit, frame.scope)
        return self.instance(cls, arguments) if cls is not None else Kind(kind.names, arguments)

    def _argument(self, argument: Type | Expression, frame: Frame) -> Value:
        if isinstance(argument, form.Type):
            value = _as_value(self.kind(argument, frame, 1))
            constant = self._constant(argument, value, frame)
            if constant is not None:
                return constant
            return TypeValue(Kind((POINTER,), (value,))) if argument.pointer and isinstance(value, TypeValue) else value
        return self._language.machine.value(argument, frame)

    def _constant(self, argument: Type, meant: Value, frame: Frame) -> Value | None:
        """Return the value of a constant that a template argument names as a type would be; None if it is a type."""
        if argument.arguments or argument.pointer or not isinstance(meant, TypeValue) or meant.kind.cls is not None:
            return None
        if meant.kind.names != argument.names or not self._linker.find_variable(
            argument.names, frame.unit, frame.scope
        ):
            return None
        value = self._language.name(form.Name(0, argument.names), frame)
        return value if isinstance(value, Text | Number | Truth) else None

    def instance(self, cls: Class, arguments: tuple[Value, ...]) -> Kind:
        """Return a class with template arguments, or the specialisation that they choose, with its own parameters.

        If that depends on an argument that is not known, the class is not known.
        """
        names = (*cls.scope, cls.name)
        general, special = self._linker.family(cls) if arguments and (cls.template or cls.pattern) else (cls, [])
        if not special:
            return Kind(names, arguments, cls)
        given = _flat(self.bound(general, arguments).values()) if general is not None else arguments
        found = chosen_class(self, general, special, given)
        if found is None:
            return Kind(names, arguments, general)
        if isinstance(found, Unknown):
            return Kind(names, arguments, special[0] if general is None and len(special) == 1 else None)
        chosen, bound = found
        own = _flat(bound[name] for name in chosen.template if name in bound) if chosen.template else arguments
        return Kind(names, own, chosen)

    def template(self, arguments: tuple[Type | Expression, ...], frame: Frame) -> tuple[Value, ...]:
        """Return the values of template arguments."""
        return _flat(self._argument(argument, frame) for argument in arguments)

    def bound(self, cls: Class, arguments: tuple[Value, ...]) -> dict[str, Value]:
        """Return the values of the template parameters of a class."""
        bound = dict(zip(cls.template, arguments, strict=False))
        if len(arguments) > len(cls.template) > 0:  # the last parameter is a pack
            bound[cls.template[-1]] = Pack(arguments[len(cls.template) - 1 :])
        elif cls.pattern and len(arguments) < len(cls.template):
            bound[cls.template[-1]] = Pack(())
        for name, default in cls.defaults.items():
            if name not in bound:
                bound[name] = self._argument(default, Frame(cls.unit, cls.scope, types=bound))
        return bound

    def bind_template(
        self,
        function: Function,
        frame: Frame,
        arguments: list[Value],
        written: tuple[Expression, ...] = (),
        caller: Frame | None = None,
    ) -> None:
        """Bind the template parameters of a function, in its frame, by its arguments and their own defaults."""
        for index, (parameter, argument) in enumerate(zip(function.parameters, arguments, strict=False)):
            kind = parameter.type
            if kind is None or not function.template:
                continue
            inner = kind.arguments[0] if kind.name in POINTERS and kind.arguments else kind
            if not isinstance(inner, form.Type) or not mentions(inner, function.template):
                continue
            deduced = library.type_of(argument)
            partly = deduced is None or inner.arguments or argument == Sequence(())
            if partly and caller is not None and index < len(written):
                deduced = self.type_of(written[index], caller) or deduced
            if deduced is not None:
                _unify(inner, deduced, function.template, frame.types)
        for name, default in function.defaults.items() if function.template else ():
            if name not in frame.types:
                frame.types[name] = self._argument(default, Frame(function.unit, function.scope, types=frame.types))

    # Classes

    def chain(self, kind: Kind) -> tuple[list[tuple[Class, dict[str, Value]]], list[Kind]]:
        """Return the classes of an object, its own first, with their template arguments; and its bases outside."""
        key = (kind.cls or kind.names, kind.arguments)
        cached = self._chains.get(key)
        if cached is not None:
            return cached
        classes: list[tuple[Class, dict[str, Value]]] = []
        outside: list[Kind] = []
        self._chains[key] = (classes, outside)  # before they are filled, since a base can name the class itself
        pending = [kind]
        while pending and len(classes) < _MOST_BASES:
            current = pending.pop(0)
            if current.cls is None:
                outside.append(current)
                continue
            if any(cls is current.cls for cls, _ in classes):
                continue
            bound = self.bound(current.cls, current.arguments)
            classes.append((current.cls, bound))
            frame = inside(current.cls, bound)
            bases = [self.kind(base, frame) for base in current.cls.bases]
            pending += [one for one in bases if isinstance(one, Kind)]
        self._methods.pop(key, None)  # found among a part of the classes
        return classes, outside

    def methods_of(self, kind: Kind) -> dict[str, list[tuple[Function, dict[str, Value]]]]:
        """Return the methods of a class that were looked up before, by name."""
        return self._methods.setdefault((kind.cls or kind.names, kind.arguments), {})

    def is_a(self, kind: Kind, name: str) -> bool:
        """Return whether a type is, or derives from, the class of a name."""
        classes, outside = self.chain(kind)
        return any(cls.name == name for cls, _ in classes) or any(base.name == name for base in outside)

    def related(self, one: Value, other: Value, *, same: bool) -> Truth | Unknown:
        """Return whether two types are the `same`, or the first is a base of the second."""
        kinds = [pointee(value.kind) for value in (one, other) if isinstance(value, TypeValue)]
        # A name alone that no source defines can be a parameter of a template whose type is not known.
        if len(kinds) < 2 or any(k.cls is None and len(k.names) == 1 and k.name not in _PLAIN for k in kinds):  # noqa: PLR2004 - a pair
            return Unknown("it depends on a type")
        classes, outside = self.chain(kinds[1])
        if same or kinds[0].names in {one.names for one in (kinds[1], *outside)}:
            return Truth(kinds[0].names == kinds[1].names or not same)
        return Truth(any(cls is kinds[0].cls for cls, _ in classes))

    @contextmanager
    def choosing(self) -> Iterator[bool]:
        """Yield whether a specialisation can be chosen here: what one is for may depend on others, without end."""
        self._choices += 1
        try:
            yield self._choices <= _MOST_CHOICES
        finally:
            self._choices -= 1

    def own_methods(self, cls: Class, bound: Mapping[str, Value], methods: list[Function]) -> list[Function]:
        """Return those of some methods of a class that its template arguments choose."""
        return chosen_methods(self, methods, _flat(bound[name] for name in cls.template if name in bound))

    def own_variable(self, kind: Kind, name: str) -> Variable | None:
        """Return the definition of a static member outside of a class, for all or for its template arguments."""
        cls = cast("Class", kind.cls)
        found = self._linker.find_variable((cls.inside[-1], name), cls.unit, cls.scope)
        if found is not None or not cls.template or not kind.arguments:
            return found
        listed = self._linker.special_variables(cls, name)
        special = ((one, one[1].written(one[2][-1]).arguments, (), Frame(one[1], one[2])) for one in listed)
        chosen = choose(self, special, kind.arguments)
        return chosen[0] if isinstance(chosen, tuple) else None

    def has_field(self, of: Object, name: str) -> bool:
        """Return whether an object has a field of a name."""
        return name in of.fields or any(name in cls.fields for cls, _ in self.chain(of.kind)[0])

    # Declarations

    def type_of(self, expression: Expression, frame: Frame) -> Kind | None:
        """Return the declared type of a variable or member, or that of the object that an expression creates."""
        while isinstance(expression, form.Unary):
            expression = expression.operand
        if isinstance(expression, form.Construct):
            if expression.type.name in _VALUES and len(expression.arguments) == 1:
                return self.type_of(expression.arguments[0], frame)
            return self.kind_of(expression.type, frame)
        if isinstance(expression, form.Call) and isinstance(expression.function, form.Name):
            names, arguments = expression.function.names, expression.arguments
            if names[-1] in _VALUES and len(arguments) == 1:
                return self.type_of(arguments[0], frame)
            called = form.Type(names, expression.function.template)
            return self.kind_of(called, frame) if names[0] == "std" and names[-1] in library.TYPES else None
        if not isinstance(expression, (form.Name, form.Member)):
            return None
        slot = frame.variables.get(expression.names[0]) if isinstance(expression, form.Name) else None
        if isinstance(slot, Reference):  # a parameter of a macro
            return self.type_of(slot.target, slot.frame)
        written = self.written_type(expression, frame)
        if written is None and isinstance(expression, form.Member):
            return self._type_in_message(expression, frame)
        return self.kind_of(*written) if written is not None else None

    def _type_in_message(self, expression: form.Member, frame: Frame) -> Kind | None:
        """Return the type of a field of a message."""
        message = self.type_of(expression.of, frame)
        names = (*pointee(message).names, expression.name) if message is not None and message.cls is None else ()
        written = self._linker.project.constants.type_of_field(names)
        return _of_field(written) if written is not None else None

    def written_type(self, expression: form.Name | form.Member, frame: Frame) -> tuple[Type, Frame] | None:
        """Return the type of a variable or member as written, with the frame that gives it its meaning."""
        if isinstance(expression, form.Name) and len(expression.names) == 1:
            current: Frame | None = frame
            while current is not None:
                if expression.names[0] in current.declared:
                    return current.declared[expression.names[0]], current
                current = current.parent
        return self.declared_type(expression, frame)

    def declared_type(self, target: form.Name | form.Member, frame: Frame) -> tuple[Type, Frame] | None:
        """Return the type of a member or global variable as written, with the frame that gives it its meaning."""
        if isinstance(target, form.Name):
            of, name = this_of(frame), target.names[-1]
        else:
            of, name = self._language.machine.value(target.of, frame), target.name
        for cls, bound in self.chain(of.kind)[0] if isinstance(of, Object) else ():
            kind = cls.fields[name].type if name in cls.fields else None
            if kind is not None:
                return kind, inside(cls, bound)
        if isinstance(target, form.Name):
            found = self._linker.find_variable(target.names, frame.unit, frame.scope)
            if found is not None and found[0].type is not None:
                return found[0].type, Frame(found[1], found[2])
        return None


def _of_field(written: str) -> Kind:
    """Return the type of a field of a message as its definition writes it: `float64[3]`, `string<=8`."""
    inner, bracket, _ = written.partition("[")
    if bracket:
        return Kind(("std", "vector"), (TypeValue(_of_field(inner)),))
    bare = inner.partition("<")[0]
    return Kind(_IN_MESSAGES.get(bare) or tuple(bare.split("/")))


def _pointer(to: Kind) -> Kind:
    """Return the type of the pointers to a class: `Ptr` or `SharedPtr` in the class."""
    return Kind(("std", "shared_ptr"), (TypeValue(to),))


def _flat(values: Iterable[Value]) -> tuple[Value, ...]:
    """Return template arguments with those of packs in their place."""
    return tuple([one for value in values for one in (value.items if isinstance(value, Pack) else (value,))])


def _as_value(resolved: Kind | Value) -> Value:
    return TypeValue(resolved) if isinstance(resolved, Kind) else resolved


def _is_plain(kind: Type) -> bool:
    """Return whether a type has no expression in it."""
    arguments = (*kind.arguments, *kind.outer)
    return not any(name.startswith("decltype(") for name in kind.names) and all(
        isinstance(one, form.Type) and _is_plain(one) for one in arguments
    )


def _unify(kind: Type, given: Kind, names: tuple[str, ...], bound: dict[str, Value]) -> None:
    """Bind the template parameters in the type of a parameter to their counterparts in the type of an argument."""
    if len(kind.names) == 1 and kind.names[0] in names:
        bound.setdefault(kind.names[0], TypeValue(given))
        return
    for inner, argument in zip(kind.arguments, given.arguments, strict=False):
        if isinstance(inner, form.Type) and isinstance(argument, TypeValue):
            _unify(inner, argument.kind, names, bound)
