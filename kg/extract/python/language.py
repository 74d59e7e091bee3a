"""What names, members and values of Python mean to the interpreter.

A module is an object whose fields are its variables; a class is a type as a value. What is outside of the build, such
as `rospy.Publisher`, is a type by its full name, whatever it is.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Final, cast

from kg.extract.python import library
from kg.extract.python.calls import CLASS, Calls, public
from kg.extract.python.functions import elements
from kg.extract.python.modules import BUILTINS, FRAMEWORKS, GENERATED, PLAIN, Modules, PythonUnit, mentions_ros
from kg.extract.python.texts import percent
from kg.holes import fits
from kg.symbolic import form
from kg.symbolic.containers import counted, with_element
from kg.symbolic.qos import PROFILES, RMW_PROFILE, policy, rmw_profile
from kg.symbolic.state import Alias, Frame, Site, Variables
from kg.symbolic.values import (
    OUTSIDE,
    Bound,
    Closure,
    Kind,
    Mapping,
    Object,
    Pack,
    Sequence,
    Text,
    TypeValue,
    Unknown,
    Value,
    alternatives,
    options,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from collections.abc import Mapping as Names

    from kg.corpus.files import FilePath
    from kg.symbolic.form import Class, Expression, Function, Type
    from kg.symbolic.machine import Machine

MODULE: Final = "<module>"
_MOST_BASES: Final = 200
_PRESETS: Final = {name.removeprefix("rmw_qos_profile_"): qos for name, qos in PROFILES.items()}
_OF_NODES: Final = re.compile(rb"\bself\.(create_(?:publisher|subscription|service|client))\(")
"""Calls of methods that only nodes of ROS 2 have."""


class Python:
    """The meaning of Python in one program, with `main` as the module that runs first."""

    machine: Machine
    calls_of: type[Calls] = Calls
    counted = staticmethod(counted)

    def __init__(self, modules: Modules, main: PythonUnit | None = None) -> None:
        self.modules = modules
        self.calls = self.calls_of(self)
        self.call = self.calls.call
        self.construct_expression = self.calls.construct_expression
        self.escape = self.calls.escape
        self.create = self.calls.create
        self.classes: dict[Class, Variables] = {}
        """The variables of each class that was defined."""
        self.around: dict[Class, Frame] = {}
        """The frame around each class that was defined."""
        self._bases: dict[Class, list[Kind]] = {}
        self._node_calls: dict[tuple[Class, ...], bool] = {}
        self._main = main
        self._loaded: dict[FilePath, Object] = {}
        self._waiting: dict[int, PythonUnit] = {}
        """Modules that run when one of their names is used, by the identity of their object."""
        self.statements: Names[type, Callable[[Any, Frame], str | None]] = {}
        self._stars: dict[int, list[str]] = {}
        """The modules outside of the build from which a module takes all names, by the identity of its variables."""

    @property
    def expressions(self) -> Names[type, Callable[[Any, Frame], Value]]:
        """How expressions run that only Python has."""
        return {form.Import: self._import, form.Define: self._define, form.Spread: self._spread}

    # Modules

    def module(self, unit: PythonUnit, *, lazy: bool = False) -> Object:
        """Return a module as an object, after its statements ran; `lazy` if they may wait until a name is used."""
        module = self._loaded.get(unit.key)
        if module is None:
            name = "__main__" if unit is self._main else unit.name
            module = Object(Kind((MODULE, unit.name)), path=unit.path)
            module.fields.update({"__name__": Text.of(name), "__file__": self.path_of(unit)})
            self._loaded[unit.key] = module
            self._waiting[id(module)] = unit
        if not lazy or mentions_ros(unit.source):
            self._run(module)
        return module

    def path_of(self, unit: PythonUnit) -> Value:
        """Return the path of a module, as a text of the program."""
        del unit
        return Text.hole("it is the path of the file")

    def _run(self, module: Object) -> None:
        unit = self._waiting.pop(id(module), None)
        if unit is not None:
            self.machine.run(unit.body, self.frame_of_module(unit, module))

    @staticmethod
    def frame_of_module(unit: PythonUnit, module: Object) -> Frame:
        """Return the frame whose variables are the fields of a module."""
        return Frame(unit, (), variables=cast("Variables", module.fields))

    def _import(self, statement: form.Import, frame: Frame) -> Value:
        self.machine.stack.append(Site(frame.unit, statement.line))
        try:
            return self._bring_in(statement, frame)
        finally:
            self.machine.stack.pop()

    def _bring_in(self, statement: form.Import, frame: Frame) -> Value:
        unit = cast("PythonUnit", frame.unit)
        names = [name for name in statement.module.split(".") if name]
        if statement.name is None:
            module = self.imported(names if statement.alias else names[:1], unit)
            self._set(frame, statement.alias or names[0], module)
            if not statement.alias and len(names) > 1:
                self.imported(names, unit)
        elif statement.name == "*":
            self._import_all(statement.module, unit, frame)
        else:
            self._set(frame, statement.alias, self._imported_name(statement.module, statement.name, unit))
        return Unknown("it is an import")

    def _set(self, frame: Frame, name: str, value: Value) -> None:
        self.machine.assign(form.Name(0, (name,)), value, frame)

    def imported(self, names: list[str], unit: PythonUnit, *, lazy: bool = True) -> Value:
        """Return a module by its name, as a file imports it; `lazy` if it may run when its first name is used."""
        module = self.modules.find(".".join(names), unit)
        return self.module(module, lazy=lazy) if module is not None else TypeValue(Kind(tuple(names)))

    def _import_all(self, module: str, unit: PythonUnit, frame: Frame) -> None:
        source = self.modules.find(module, unit) if not self._is_generated(module, unit) else None
        if source is None:
            self._stars.setdefault(id(frame.variables), []).append(module)
            return
        loaded = self.module(source)
        for name, value in list(loaded.fields.items()):
            if not name.startswith("_"):
                self._set(frame, name, value)
        self._stars.setdefault(id(frame.variables), []).extend(self._stars.get(id(loaded.fields), ()))

    def _is_generated(self, module: str, unit: PythonUnit) -> bool:
        """Check whether a module is of interface definitions: a package of that name, or one that no source holds."""
        if module.startswith(".") or GENERATED.isdisjoint(module.split(".")[1:]):
            return False
        source = self.modules.find(module, unit)
        return source is None or source.is_package

    def _imported_name(self, module: str, name: str, unit: PythonUnit) -> Value:
        inner = module.strip(".").split(".")
        outside = TypeValue(_kind((*inner, name) if inner != [""] else (name,)))
        if self._is_generated(module, unit) or (name in GENERATED and not module.startswith(".")):
            return outside
        source = self.modules.find(module, unit)
        if source is not None:
            member = self._of_module(self.module(source), name)
            if member is not None:
                return member
        below = self.modules.find(f"{module}{'' if module.endswith('.') else '.'}{name}", unit)
        return self.module(below, lazy=True) if below is not None else self._constant(outside)

    def _of_module(self, module: Object, name: str) -> Value | None:
        """Return a variable of a module, or a module in its folder; None if it has neither."""
        self._run(module)
        if name in module.fields:
            return module.fields[name]
        unit = next(unit for unit in (self.modules.unit(key) for key, one in self._loaded.items() if one is module))
        if unit is None:
            return None
        starred = self._starred(name, module.fields)
        if starred is not None:
            return starred
        if name in GENERATED:
            return TypeValue(Kind((unit.name, name)))
        below = self.modules.find(f".{name}", unit) if unit.is_package else None
        return self.module(below, lazy=True) if below is not None else None

    def _starred(self, name: str, variables: Names[str, object]) -> Value | None:
        modules = self._stars.get(id(variables))
        if not modules or name in BUILTINS:
            return None
        candidates = ((*module.split("."), name) for module in modules if not GENERATED & set(module.split(".")))
        described = next((one for one in candidates if self.machine.framework.describes(one)), None)
        names = described or self.modules.starred(name, modules)
        return self._constant(TypeValue(Kind(names))) if names is not None else None

    # Names

    def name(self, expression: form.Name, frame: Frame) -> Value:
        """Return what a name means that is not a variable: of all names of a module, or of Python itself."""
        name = expression.names[-1]
        for outer in frame.outward():
            starred = self._starred(name, outer.variables)
            if starred is not None:
                return starred
        if name in BUILTINS:
            return TypeValue(Kind(("builtins", name)))
        return Unknown(f"{name} {OUTSIDE}")

    def assign_name(self, target: form.Name, value: Value, frame: Frame) -> None:
        """Set a variable that has no value yet: one of the module."""
        *_, module = frame.outward()
        self.machine.write(module.variables, target.names[-1], value)

    def static_member(self, kind: Kind, name: str) -> Value | None:
        """Return a variable of a class; None if it has none of that name."""
        member = self._of_class(kind, name)
        return member if member is not None and not isinstance(member, Closure) else None

    def reaches(self, function: Function) -> bool:  # noqa: ARG002 - every function may
        """Check whether a run of a function can have an effect, as far as its code shows."""
        return True

    def spares(self, function: Function, this: Value | None, arguments: list[Value]) -> bool:  # noqa: ARG002 - the same
        """Check whether a call in a callback need not run."""
        return False

    def static_fields(self, of: Value) -> dict[str, Value] | None:
        """Return the variables of a class; None for other values."""
        cls = of.kind.cls if isinstance(of, TypeValue) else None
        return cast("dict[str, Value] | None", self.classes.get(cls)) if cls is not None else None

    # Classes

    def _define(self, statement: form.Define, frame: Frame) -> Value:
        cls = statement.cls
        inner = Frame(cls.unit, (*cls.scope, cls.name), parent=frame)
        bases = [one for base in cls.derived for one in alternatives(self.machine.value(base, frame))]
        self._bases[cls] = [base.kind for base in bases if isinstance(base, TypeValue)]
        self.classes[cls], self.around[cls] = inner.variables, frame
        if cls.body is not None:
            self.machine.run(cls.body, inner)
        return TypeValue(kind_of_class(cls))

    def chain(self, kind: Kind) -> tuple[list[tuple[Class, dict[str, Value]]], list[Kind]]:
        """Return the classes of an object, its own first, and its bases outside of the build."""
        classes: dict[Class, None] = {}
        outside: list[Kind] = []
        pending = [kind]
        while pending and len(classes) < _MOST_BASES:
            current = pending.pop(0)
            if current.cls is None:
                outside.append(Kind(public(current.names)))
            elif current.cls not in classes:
                classes[current.cls] = None
                pending = [*self._bases.get(current.cls, ()), *pending]  # depth first, as Python where no base recurs
        return [(cls, {}) for cls in classes], self._with_node(outside, classes)

    def subclasses(self, cls: Class) -> Sequence:
        """Return the classes of the program that have a class as a base, in the order of their definitions."""
        for module in [*self._loaded.values()]:
            unit = self._waiting.get(id(module))
            if unit is not None and cls.name.encode() in unit.source:
                self._run(module)
        derived = (one for one, bases in self._bases.items() if any(base.cls is cls for base in bases))
        return Sequence(tuple(TypeValue(kind_of_class(one)) for one in derived))

    def _with_node(self, outside: list[Kind], classes: Iterable[Class]) -> list[Kind]:
        """Return the bases outside of the build; one is presumed to be a node if the methods call themselves as one.

        If it is named like a node, its constructor is presumed to get the name of the node first.
        """
        unknown = [base for base in outside if base.names[0] not in FRAMEWORKS | PLAIN]
        if len(unknown) != len(outside) or not unknown or not self._calls_a_node(tuple(classes)):
            return outside
        base = next((one for one in unknown if one.name.endswith("Node")), None)
        name = "PresumedNode" if base is None else "LifecycleNode" if "Lifecycle" in base.name else "Node"
        presumed = base or unknown[0]
        node = Kind(("rclpy", name), arguments=(TypeValue(presumed),) if base is None else ())
        return [node if one is presumed else one for one in outside]

    def _calls_a_node(self, classes: tuple[Class, ...]) -> bool:
        """Check whether methods of classes call one of a node on themselves that none of the classes has."""
        known = self._node_calls.get(classes)
        if known is None:
            methods = [one for cls in classes for several in cls.methods.values() for one in several]
            called = {name for one in methods for name in _OF_NODES.findall(getattr(one.source, "text", None) or b"")}
            known = self._node_calls[classes] = not called <= {one.name.encode() for one in methods}
        return known

    def methods(self, kind: Kind, name: str) -> list[tuple[Function, dict[str, Value]]]:
        """Return the methods of a name, those of the class before those of its bases."""
        return [(one, bound) for cls, bound in self.chain(kind)[0] for one in cls.methods.get(name, ())]

    declarations = methods

    def _of_class(self, kind: Kind, name: str, after: Class | None = None) -> Value | None:
        """Return a variable or a method of a class or its bases; `after` skips the classes up to one."""
        classes = [cls for cls, _ in self.chain(kind)[0]]
        for cls in classes[classes.index(after) + 1 :] if after in classes else classes:
            value = self.classes.get(cls, {}).get(name)
            if value is not None:
                return cast("Value", value)
            if name in cls.methods and cls in self.around:
                return Closure(cls.methods[name][0], self.around[cls])
        return None

    def elements(self, of: Value) -> list[Value]:
        """Return what a loop over a value gives: of an enumeration, the values of its members."""
        cls = of.kind.cls if isinstance(of, TypeValue) else None
        if cls is None or not any(base.name.endswith(("Enum", "Flag")) for base in self.chain(kind_of_class(cls))[1]):
            return elements(of)
        members = self.classes.get(cls, {}).items()
        return [one for name, one in members if not name.startswith("_") and not isinstance(one, Alias | Closure)]

    # Members

    def member(self, of: Value, name: str) -> Value:
        """Return a member of a value."""
        if isinstance(of, Object):
            return self.of_object(of, name)
        if isinstance(of, TypeValue):
            return self._of_type(of, name)
        if isinstance(of, Closure) and name == "__name__":
            return Text.of(of.function.name)
        value = library.member(of, name)
        if value is not None:
            self.machine.framework.converted(of, name)
            return value
        return Unknown(of.reason if isinstance(of, Unknown) else f"the member {name} is not known")

    def member_named(self, of: Value, name: Text) -> Value:
        """Return the member that a text names; if part of the text is unknown (`"on_" + event`), what it can be."""
        if name.exact is not None:
            return self.member(of, name.exact) if name.exact else Unknown("the member has no name")
        if not isinstance(of, Object) or name.wholly_unknown:
            return Unknown("the name of the member is not known")
        names = dict.fromkeys((*of.fields, *(one for cls, _ in self.chain(of.kind)[0] for one in cls.methods)))
        fitting = [self.of_object(of, one) for one in names if fits(name.shown, one, ".*")]
        return options(fitting, object()) if fitting else Unknown("no member has such a name")

    def of_object(self, of: Object, name: str, after: Class | None = None) -> Value:
        """Return a member of an object, a module, or of what `super()` gives."""
        if of.kind.names[0] == MODULE:
            value = self._of_module(of, name)
            return value if value is not None else Unknown(f"{name} is not in the module")
        through = of.native.get("super")
        if isinstance(through, Object):
            value = of.native.get("after")
            return self.of_object(through, name, value.kind.cls if isinstance(value, TypeValue) else None)
        if name in of.fields and after is None:
            return of.fields[name]
        if name == CLASS:
            return TypeValue(of.kind)
        member = self._of_class(of.kind, name, after)
        if member is not None:
            return self._bound(member, of)
        if name == "value" and of.kind.name == RMW_PROFILE:
            return of
        if of.kind.cls is None or self.chain(of.kind)[1]:
            return Bound(name, of)
        return Unknown(f"the member {name} is not known")

    def _bound(self, value: Value, of: Object) -> Value:
        """Return a member of a class as the member of an object: methods with the object as first argument."""
        if not isinstance(value, Closure) or value.bound or value.function.static:
            return value
        marks = value.function.marks
        method = Closure(value.function, value.frame, (TypeValue(of.kind) if "classmethod" in marks else of,))
        if marks & {"property", "cached_property"}:
            return self.calls.value(method)
        return method

    def _of_type(self, of: TypeValue, name: str) -> Value:
        kind = of.kind
        if kind.cls is None:
            return self._constant(TypeValue(_kind((*kind.names, name))))
        if name == "__name__":
            return Text.of(kind.name)
        member = self._of_class(kind, name)
        if isinstance(member, Closure) and "classmethod" in member.function.marks:
            return Closure(member.function, member.frame, (of,))
        if member is not None:
            return member
        outside = self.chain(kind)[1]
        return TypeValue(Kind((*outside[0].names, name))) if outside else Unknown(f"{name} is not in the class")

    def _constant(self, constant: TypeValue) -> Value:
        """Return a constant of a framework or message, of the quality of service or a duration, for its full name."""
        names = constant.kind.names
        if "QoSPresetProfiles" in names[:-1] or names[-1].startswith("qos_profile_"):
            profile = _PRESETS.get(names[-1].lower().removeprefix("qos_profile_"))
            return rmw_profile(profile) if profile is not None else constant
        if names[0] == "rclpy" and len(names) > 2:  # noqa: PLR2004 - package, class and policy
            value = policy((*names[:-2], names[-2].removeprefix("QoS"), names[-1]))
            if value is not None:
                return value
        return self.modules.constants.find(names) or library.CONSTANTS.get(".".join(names), constant)

    # Types and values, as far as Python has them

    def kind(self, kind: Type, frame: Frame) -> Kind | Value:
        """Return the meaning of a type; Python has types only as values."""
        del frame
        return Kind(kind.names)

    def kind_of(self, kind: Type | None, frame: Frame) -> Kind | None:
        """Return None, since declarations have no types that count."""
        del kind, frame
        return None

    def type_of(self, expression: Expression, frame: Frame) -> Kind | None:
        """Return None, since variables have no types."""
        del expression, frame
        return None

    def message(self, kind: Kind, frame: Frame | None) -> Kind:
        """Return the type itself, which Python sends as it is."""
        del frame
        return kind

    def nested_type(self, kind: Kind, name: str) -> Kind | None:
        """Return None, since classes have no aliases of types."""
        del kind, name
        return None

    def default(self, kind: Type, frame: Frame, line: int) -> Value:
        """Return the value of a variable without a value."""
        del kind, frame, line
        return Unknown("it has no value")

    def unknown(self, kind: Type | None, frame: Frame, name: str) -> Value:
        """Return a value that comes from outside."""
        del kind, frame
        return Unknown(f"{name} comes from outside")

    def converted(self, value: Value, kind: Type | None, written: Expression | None, frame: Frame) -> Value:
        """Return the value, which variables hold as it is."""
        del kind, written, frame
        return value

    def assigned(self, target: Expression, value: Value, written: Expression, frame: Frame) -> Value:
        """Return the value, which variables hold as it is; a module runs before its variables are set from outside."""
        del written
        if isinstance(target, form.Member) and isinstance(target.of, form.Name):
            for module in alternatives(self.machine.value(target.of, frame)):
                if isinstance(module, Object):
                    self._run(module)
        return value

    # Operators

    def element(self, of: Value, key: Value) -> Value:
        """Return the element of a container at a key; a `defaultdict` makes those that it does not have."""
        if isinstance(of, Mapping) and of.default is not None and all(key != own for own, _ in of.items):
            return self.calls.value(of.default)
        return library.element(of, key)

    def with_element(self, of: Value, key: Value, value: Value) -> Value:
        """Return a container with an element set."""
        return with_element(of, key, value)

    def formatted(self, row: tuple[Value, ...]) -> Value:
        """Return the text of `format % value`."""
        return percent(row[0], row[1])

    def shifted(self, values: list[Value]) -> Value | None:
        """Return None: `<<` shifts bits."""
        del values
        return None

    def _spread(self, expression: form.Spread, frame: Frame) -> Value:
        """Return the elements of a collection as items of another one."""
        value = self.machine.value(expression.of, frame)
        rows = [one for one in alternatives(value) if isinstance(one, Sequence) and not one.open]
        return Pack(rows[0].items) if rows else Unknown("it is passed on by *")


def kind_of_class(cls: Class) -> Kind:
    """Return the type of a class of the sources."""
    return Kind((cls.unit.path, *cls.scope, cls.name), cls=cls)


def _kind(names: tuple[str, ...]) -> Kind:
    """Return the type of a full name; a message type is `package.msg.Type`, wherever it was imported from."""
    inner = next((index for index, part in enumerate(names) if index and part in GENERATED), None)
    if inner is not None and len(names) > inner + 2 and names[inner + 1].startswith("_"):
        names = (*names[: inner + 1], *names[inner + 2 :])
    return Kind(names)
