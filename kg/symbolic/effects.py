"""Effects of described framework calls: interfaces and parameters, with the calls that led to them."""

from __future__ import annotations

import fnmatch
import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from kg.facts import CAMERA_ORIGIN, Access, Qos
from kg.symbolic import durations, qos
from kg.symbolic.binding import put
from kg.symbolic.form import Literal, Name
from kg.symbolic.messages import GENERATED, message_type, option, transported, type_name
from kg.symbolic.names import (
    EMPTY,
    below,
    camera_info,
    given_namespace,
    handle_namespace,
    namespace_of,
    with_node_name,
)
from kg.symbolic.parameters import Parameters, listed, ros_type, type_of_value
from kg.symbolic.plugins import Loading, loading
from kg.symbolic.results import result
from kg.symbolic.spelling import spelled
from kg.symbolic.state import Arguments, Frame, Invocation, Site
from kg.symbolic.trees import Registered, port_value
from kg.symbolic.values import (
    ABSENT,
    OUTSIDE,
    UNSURE,
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
    combinations,
    is_empty_text,
    join,
    number,
)

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.symbolic.descriptions import CallDescription, ClassDescription, Descriptions, Effect, SlotDescription
    from kg.symbolic.form import Expression
    from kg.symbolic.machine import Machine

_PARAMETER_TYPE: Final = "PARAMETER_"
"""How the types of parameters begin in C++: `rclcpp::ParameterType::PARAMETER_STRING`."""
_PARAMETER_TYPES: Final = re.compile(
    rf"{_PARAMETER_TYPE}(?:NOT_SET|BYTE_ARRAY|(?:BOOL|INTEGER|DOUBLE|STRING)(?:_ARRAY)?)"
)
_CONVERSIONS: Final = {
    name + end: kind + end
    for name, kind in {"string": "string", "int": "int", "integer": "int", "double": "double", "bool": "bool"}.items()
    for end in ("", "_array")
}
"""The types of parameters by the words in the names of their conversions."""
_NODES: Final = ("node", "handle")
_OF_NODES: Final = frozenset({"create_publisher", "create_subscription", "create_service", "create_client"})
"""Methods that only nodes of ROS 2 have."""
_AUTOMATIC: Final = "automatically_declare_parameters_from_overrides"
_ANY: Final = "?"
"""The namespace of a member that is a node handle, where it is not known."""
_PLAIN_NODE: Final = Kind(("rcl_node_t",))
_UNKNOWN_NODE: Final = Unknown("it has no node")


@dataclass(frozen=True, slots=True)
class Declared:
    """An interface or parameter with its node, and the calls that led to it, the outermost first."""

    effect: Effect
    name: Text | Unknown
    type: str | None
    node: Object | None
    stack: tuple[Site, ...]
    qos: Qos | None = None
    default: Value | None = None
    guards: tuple[str, ...] = ()
    value_type: str | None = None
    by_conversion: bool = False
    """Whether conversions of the value say what its type is."""
    written: str | None = None
    """The expression that gives the name."""
    origin: str | None = None
    """The framework that makes it beside the one of the call."""
    passed: int = 0
    """How many of the innermost calls have the whole name of a parameter as an argument."""


class Framework:
    """The frameworks in one interpretation. `host` is the node that loads the plugin, if the root is a plugin."""

    machine: Machine

    def __init__(self, descriptions: Descriptions, host: Object | None = None) -> None:
        self.descriptions = descriptions
        self.host = host
        self.declared: list[Declared] = []
        self.marks: list[tuple[str, Object | None, tuple[Site, ...], Value | None]] = []
        self.called_later: set[tuple[str, int]] = set()
        """Methods that a framework calls after construction, unless the code does so itself, each with its object."""
        self.parameters = Parameters()
        self.node_names: list[Value] = []
        self.node_sites: list[tuple[Site, ...]] = []
        """The calls that led to each node and to each name of the node."""
        self.nodes: list[Object] = []
        self.loaded: list[tuple[Value, ...]] = []
        self.loadings: list[Loading] = []
        self.registered: list[Registered] = []
        """The nodes of behavior trees that calls register."""
        self.ports: dict[str, Value] = {}
        """The values that ports have by default."""
        self._option_sites: dict[Object, tuple[Site, ...]] = {}
        """The calls that gave an options object the name of its interface."""
        self._untyped: dict[str, set[str]] = {}
        """Parameters whose type only conversions can give, each with the types that they gave."""
        self._described: dict[object, list[ClassDescription]] = {}
        self._alike: dict[object, tuple[list[ClassDescription], frozenset[str]]] = {}
        """For each type the descriptions that apply to its objects, with their names."""

    def progress(self) -> tuple[int, ...]:
        """Return the number of results so far: if it changes while a function runs, the function has effects."""
        return (*self.results(), len(self.machine.queued))

    def results(self) -> tuple[int, ...]:
        """Return the number of results so far, without functions that are still to run."""
        return (
            len(self.declared),
            len(self.marks),
            len(self.nodes),
            len(self.loaded),
            len(self.loadings),
            len(self.registered),
            len(self.node_names),
        )

    # Classes

    def described(self, kind: Kind) -> list[ClassDescription]:
        """Return the descriptions of the framework classes that a type is or derives from."""
        key = kind.cls or kind.names
        classes = self._described.get(key)
        if classes is None:
            outside = self.machine.language.chain(kind)[1]
            classes = [one for base in outside if (one := self.descriptions.class_named(base.names)) is not None]
            # A described class whose sources are in the build is not among the bases outside of them. What a loader
            # calls is said by its own bases.
            own = self.descriptions.class_named(kind.names) if kind.cls is not None and not classes else None
            if own is not None and (own.is_a or not own.runs):
                classes.append(own)
            self._described[key] = classes
        return classes

    def presume_node(self, kind: Kind) -> None:
        """Take a class that a container of components loads as a node, if only its unknown bases can make it one."""
        outside = [base for base in self.machine.language.chain(kind)[1] if base.names[0] not in ("std", "boost")]
        node = self.descriptions.class_named(("rclcpp", "Node"))
        if kind.cls is not None and outside and node is not None and not self.described(kind):
            self._described[kind.cls] = [replace(node, node_name=None, namespace=None)]

    def _classes(self, of: Object) -> tuple[list[ClassDescription], frozenset[str]]:
        """Return the descriptions of an object's classes and of those that these are like, and their names."""
        key = of.kind.cls or of.kind.names
        cached = self._alike.get(key)
        if cached is None:
            descriptions = list(self.described(of.kind))
            for one in descriptions:
                like = self.descriptions.class_named(tuple(one.like.split("::"))) if one.like is not None else None
                if like is not None and like not in descriptions:
                    descriptions.append(like)
            cached = self._alike[key] = (descriptions, frozenset(one.name for one in descriptions))
        return cached

    def is_a(self, of: Object, name: str) -> bool:
        """Check whether the class of an object is, derives from, or is like a class of a framework."""
        return name in self._classes(of)[1]

    def is_node(self, of: Value) -> bool:
        """Check whether an object is a node or a node handle."""
        return isinstance(of, Object) and any(one.is_a in _NODES for one in self._classes(of)[0])

    def _is_profile(self, of: Object) -> bool:
        return "qos" in of.native or any(one.is_a == "qos" for one in self.described(of.kind))

    # Values that frameworks supply

    def given(self, kind: Kind, name: str) -> Value | None:
        """Return the value that a framework passes to a plugin for a type: its node, or a handle."""
        if kind.cls is not None:
            described = next((one for one in self.described(kind) if one.is_a in _NODES), None)
            return self.host if described is not None and described.is_a == "node" else None
        description = self.descriptions.class_named(kind.names)
        if description is not None and description.is_a == "handle":
            private = "priv" in name or name.startswith("pn") or name.endswith("_p")
            return Object(kind, native={"namespace": Text.of("~" if private else "")})
        return self.host_node() if description is not None and description.is_a == "node" else None

    def host_node(self) -> Object:
        """Return the node that loads the plugin."""
        if self.host is None:
            library = "rclpy" if self.descriptions.language == "python" else "rclcpp"
            self.host = Object(Kind((library, "Node")), native={"namespace": EMPTY})
        return self.host

    def handed(self, of: Object, name: str, count: int) -> dict[int, Value]:
        """Return the node handles that a framework passes to a method, by the index of the parameter."""
        for described in self._classes(of)[0]:
            for method, arguments, handles in described.gives:
                if method == name and arguments == count:
                    return {index: _handle(namespace) for index, namespace in handles}
        return {}

    def constant(self, names: tuple[str, ...]) -> Value | None:
        """Return a constant of a framework: quality of service, a duration, the type of a parameter."""
        name = names[-1]
        if (names[0] == "rclcpp" or len(names) == 1) and _PARAMETER_TYPES.fullmatch(name):
            return TypeValue(Kind(("Type", name.removeprefix(_PARAMETER_TYPE))))
        if name in qos.PROFILES:
            return qos.rmw_profile(qos.PROFILES[name])
        return durations.duration(durations.CONSTANTS[name]) if name in durations.CONSTANTS else qos.policy(names)

    # Construction

    def constructs(self, kind: Kind) -> bool:
        """Check whether a type is a framework class."""
        return kind.cls is None and self.descriptions.class_named(kind.names) is not None

    def is_handle(self, kind: Kind) -> bool:
        """Check whether a type is a framework class of node handles, which are made of names."""
        described = self.descriptions.class_named(kind.names) if kind.cls is None else None
        return described is not None and described.is_a == "handle"

    def replaces(self, kind: Kind) -> bool:
        """Check whether the description of a class is used even if its sources are in the build."""
        described = self.descriptions.class_named(kind.names)
        return described is not None and described.replaces

    def construct(self, kind: Kind, given: Arguments) -> Value | None:
        """Return an object of a framework class, and apply the effects of its construction."""
        described = self.descriptions.class_named(kind.names)
        if described is None:
            return None
        given = given.placed(described.parameters)
        arguments = given.values
        what, _, detail = described.is_a.partition(":")
        first = arguments[0] if arguments else None
        if what in _NODES and len(arguments) == 1 and isinstance(first, Object) and first.kind.names == kind.names:
            return first
        if what == "value":
            return arguments[int(detail)] if int(detail) < len(arguments) else Unknown("it has no value")
        if what == "pair" and len(arguments) == 1 and getattr(first, "parameter", None) is not None:
            return first  # a copy of a parameter, which is its value
        if what == "pair":
            return Sequence(tuple(arguments[:2])) if arguments else Unknown("it has no value")
        if what == "duration":
            parts: list[Value] = [number(0) if one is ABSENT else one for one in arguments]
            return durations.construct_duration(kind, float(detail), parts or [number(0)])
        instance = self.machine.created(Object(kind, line=self.machine.stack[-1].line if self.machine.stack else 0))
        self._construct(instance, kind, described, given)
        return instance

    def construct_base(self, instance: Object, kind: Kind, given: Arguments) -> None:
        """Run the constructor of a framework class for an object of a class that derives from it."""
        described = self.descriptions.class_named(kind.names)
        if described is not None:
            self._construct(instance, kind, described, given.placed(described.parameters))
        else:
            self.machine.language.escape([*given.values, *given.named.values()])

    def constructed(self, instance: Object) -> None:
        """Schedule the methods of an object that a framework calls after construction."""
        language = self.machine.language
        for described in self._classes(instance)[0]:
            for name in (one for pattern in described.runs for one in self._matching(instance, pattern)):
                if language.methods(instance.kind, name):
                    self.called_later.add((name, id(instance)))
                    language.escape([Bound(name, instance)])

    def _matching(self, instance: Object, pattern: str) -> list[str]:
        """Return the methods of an object whose names match: `test*`."""
        if "*" not in pattern:
            return [pattern]
        classes = [cls for cls, _ in self.machine.language.chain(instance.kind)[0]]
        names = dict.fromkeys(name for cls in classes for name in (*cls.methods, *cls.declared))
        return fnmatch.filter(names, pattern)

    def _construct(self, instance: Object, kind: Kind, described: ClassDescription, given: Arguments) -> None:
        arguments = given.values
        for name, namespace in described.members:
            instance.fields[name] = self.host_node() if namespace == "host" else _handle(namespace)
        if described.is_a == "handle":
            instance.native["namespace"] = handle_namespace(arguments)
        elif described.is_a == "node":
            self._construct_node(instance, described, given)
        elif described.is_a == "carrier":
            instance.native["node"] = arguments[0] if arguments else _UNKNOWN_NODE
        elif described.is_a == "qos":
            qos.construct(instance, kind, arguments)
        if described.slot is not None:
            self._loads(described.slot, Invocation(instance, given, kind))
            instance.native["base"] = Text.of(self.loadings[-1].base or "")
        if described.mark is not None:
            self._mark(described.mark, kind, described, Invocation(None, given))
        off = described.unless is not None and arguments[described.unless : described.unless + 1] == [Truth(False)]
        node, rest = self._shifted(described.node, arguments)
        fits = described.least <= len(rest) <= described.most
        if described.options and fits:
            self._store(instance, described.effects[0], Invocation(node, replace(given, values=rest), kind))
        elif described.effects and not off and fits:
            for effect in described.effects:
                for row in combinations(rest):
                    self._apply(effect, Invocation(node, replace(given, values=list(row)), kind))
        self.machine.language.escape([*arguments, *given.named.values()])

    def _mark(self, key: str, kind: Kind, described: ClassDescription, call: Invocation) -> None:
        """Record the use of a framework, with the argument that it takes and the namespace that it is in."""
        arguments = call.arguments.values
        detail = call.argument(described.detail) or next(iter(kind.arguments), None)
        namespace = call.argument(described.under)
        if namespace is not None:
            owner: Object | None = Object(Kind(("namespace",)), native={"namespace": below(EMPTY, namespace)})
        else:
            nodes = (one for value in arguments for one in alternatives(value) if isinstance(one, Object))
            owner = next((one for one in nodes if self.is_node(one)), None)
        self.marks.append((key, owner, tuple(self.machine.stack), detail))

    def _construct_node(self, instance: Object, described: ClassDescription, given: Arguments) -> None:
        arguments = given.values
        instance.native["namespace"] = EMPTY
        if described.namespace is not None:
            cpp = self.descriptions.language == "cpp"
            own = given_namespace(arguments, described.namespace, options_in_place=cpp)
            if own is not None:
                instance.native["own namespace"] = own
        options = (one.native.get("automatic") for one in arguments if isinstance(one, Object))
        automatic = next((one for one in (given.named.get(_AUTOMATIC), *options) if one is not None), Truth(False))
        instance.native["automatic"] = automatic
        if described.node_name is not None and len(arguments) > described.node_name:
            instance.native["name"] = arguments[described.node_name]
        if instance in self.nodes:
            return
        self.nodes.append(instance)
        self.node_sites.append(tuple(self.machine.stack))
        running = (site.this for site in self.machine.stack)
        outer = next(
            (one for one in running if isinstance(one, Object) and one is not instance and one in self.nodes), None
        )
        if outer is not None:
            instance.native["within"] = outer

    def _shifted(self, node: int | str | None, arguments: list[Value]) -> tuple[Value | None, list[Value]]:
        """Return the node or handle of a call, and the arguments as the description counts them."""
        if node == "host":
            return self.host_node(), arguments
        if node == "interfaces":
            rest = arguments[1:]
            while len(rest) > 1 and self.is_node(rest[0]):
                rest = rest[1:]
            return (arguments[0] if arguments else None), rest
        if node == "first handle":
            if arguments and any(isinstance(one, Object) for one in alternatives(arguments[0])):
                return arguments[0], arguments[1:]
            return None, arguments
        given = arguments[node] if isinstance(node, int) and node < len(arguments) else None
        is_time = isinstance(given, Object) and "seconds" in given.native  # the node can be left out in front of it
        return (None if is_time else given), arguments

    # Calls

    def describes_method(self, of: Object, name: str) -> bool:
        """Check whether a method that an object calls on itself is described."""
        if any(self._applies(one, of) for one in self.descriptions.calls.get(name, ()) if one.on):
            return True
        return name in qos.METHODS and self._is_profile(of)

    def _applies(self, described: CallDescription, of: Object) -> bool:
        return not self._classes(of)[1].isdisjoint(described.on)

    def call_method(self, of: Object, name: str, given: Arguments) -> Value | None:
        """Apply the effects of a method of a framework class; None if it is not described."""
        if name in qos.METHODS and self._is_profile(of):
            changed = qos.changed_profile(self.machine, of, name, given.values)
            if changed is not None:
                return changed
        elapsed = durations.called(self.machine, of, name, given.values) if name in durations.METHODS else None
        if elapsed is not None:
            return elapsed
        for described in self.descriptions.calls.get(name, ()):
            if not self._applies(described, of):
                continue
            placed = given.placed(described.parameters)
            if described.least <= len(placed.values) <= described.most:
                node: Value | None = of
                if described.node is not None:
                    node, rest = self._shifted(described.node, placed.values)
                    placed = replace(placed, values=rest)
                return self._run(described, Invocation(node, placed, of.kind))
        return None

    def call_unknown_node(self, name: str, kind: Value | None, given: Arguments) -> Value | None:
        """Apply the effects of a method of a node of ROS 2 that is not known, which gets the type of an interface.

        The node is the one of the program, or the one that loads the plugin, as there rarely is another.

        Returns:
            None unless only nodes have a method of the name, and `kind` is generated from an interface definition.
        """
        if name not in _OF_NODES or not isinstance(kind, TypeValue) or GENERATED.isdisjoint(kind.kind.names[:-1]):
            return None
        return self.call_method(next(iter(self.nodes), None) or self.host_node(), name, given)

    def describes(self, names: tuple[str, ...]) -> bool:
        """Check whether a full name is that of a class or function that is described."""
        if self.descriptions.class_named(names) is not None:
            return True
        calls = self.descriptions.calls.get(names[-1], ())
        return any(one.scopes and one.scopes != ("*",) and _in_scope(one.scopes, names[:-1], ()) for one in calls)

    def call_function(self, names: tuple[str, ...], given: Arguments) -> Value | None:
        """Apply the effects of a function of a framework; None if it is not described."""
        uses = given.frame.unit.uses if given.frame is not None else ()
        for described in self.descriptions.calls.get(names[-1], ()):
            if not described.scopes or not _in_scope(described.scopes, names[:-1], uses):
                continue
            placed = given.placed(described.parameters)
            where = 0 if described.node == "handle" and any(map(self.is_node, placed.values[:1])) else described.node
            if where != "handle" and described.least <= len(placed.values) <= described.most:
                node, rest = self._shifted(where, placed.values)
                return self._run(described, Invocation(node, replace(placed, values=rest)))
        return None

    def _run(self, described: CallDescription, call: Invocation) -> Value:
        given = call.arguments
        if described.node_name is not None and described.node_name < len(given.values):
            self.node_names.append(given.values[described.node_name])
            if described.node == 0 and given.frame is not None and given.written:  # a node of C
                node = call.node if isinstance(call.node, Object) else self.machine.created(Object(_PLAIN_NODE))
                node.native["name"] = given.values[described.node_name]
                put(self.machine, given.written[0], node, given.frame)
            self.node_sites.append(tuple(self.machine.stack))
        if described.loads and len(given.values) > 1:
            self.loaded.append(tuple(given.values))
        if described.slot is not None:
            self._loads(described.slot, call)
        if described.registers is not None:
            self.registered.append(Registered.of(described.registers, call, tuple(self.machine.stack)))
            return Unknown("it returns nothing")
        if described.port is not None:
            value = port_value(described.port, call, self.ports)
            if described.port.output is not None and given.frame is not None:
                put(self.machine, given.written[described.port.output], value, given.frame)
            return value
        created = call.argument(described.creates)
        if created is not None:
            self.machine.language.create(created)
        if described.options and given.values:
            return self._options(described, call)
        if described.mark is not None:
            topic = call.argument(described.effects[0].name or 0) if described.effects else None
            owner = call.node if isinstance(call.node, Object) else None
            detail = below(namespace_of(owner), topic) if topic is not None else None
            self.marks.append((described.mark, owner, tuple(self.machine.stack), detail))
        read: Value | None = None
        for effect in described.effects:
            nodes: tuple[Value | None, ...] = alternatives(call.node) if call.node is not None else (None,)
            certain = all(type(value) is not Either for value in given.values)
            rows = [given] if certain else [replace(given, values=list(row)) for row in combinations(given.values)]
            rows = [row for row in rows if not _is_unset(effect, row)] or rows
            results = [self._apply(effect, Invocation(one, row, call.kind)) for one in nodes for row in rows]
            values = [one for one in results if one is not None]
            read = join(*values) if values else None
        self.machine.language.escape([*given.values, *given.named.values()])
        if described.copies is not None and given.frame is not None and described.copies[1] < len(given.written):
            source, target = described.copies
            put(self.machine, given.written[target], given.values[source], given.frame)
        return result(self, described.returns, call, read)

    def leave(self, names: tuple[str, ...], arguments: Iterable[Value]) -> None:
        """Record that code outside of the sources gets a node or a handle: it can read and create anything there."""
        node = next((one for one in arguments if isinstance(one, Object) and self.is_node(one)), None)
        if node is not None:
            self.left(names, node, "and gets the node")

    def left(self, names: tuple[str, ...], node: Object | None, what: str) -> None:
        """Record that code outside of the sources uses a node, or the only one of the program, in a way of its own."""
        reason = f"{'::'.join(names)} {OUTSIDE}, {what}"
        self.loadings.append(Loading(None, node, tuple(self.machine.stack), reason=reason, fixed=True))

    def _loads(self, slot: SlotDescription, call: Invocation) -> None:
        """Record that a call loads plugins, or creates an object whose methods do."""
        running = (site.this for site in reversed(self.machine.stack))
        node = next((one for one in running if isinstance(one, Object) and one in self.nodes), None)
        for row in combinations(call.arguments.values):
            one = replace(call, arguments=replace(call.arguments, values=list(row)))
            module = one.argument(slot.module)
            if not isinstance(module, Text) or module.exact is None:
                self.loadings.append(loading(slot, one, node, tuple(self.machine.stack)))

    def _options(self, described: CallDescription, call: Invocation) -> Object:
        """Store the name and type of an interface in an options object."""
        options = call.node if isinstance(call.node, Object) else Object(Kind(("ros", "SubscribeOptions")))
        self._store(options, described.effects[0], call)
        self.machine.language.escape(call.arguments.values)
        return options

    def _store(self, options: Object, effect: Effect, call: Invocation) -> None:
        kind = message_type(self.machine.language, effect, call)
        self._option_sites[options] = tuple(self.machine.stack)
        options.native["options name"] = call.arguments.values[effect.name or 0]
        options.native["options type"] = Text.of(kind) if kind is not None else Unknown("its type is not known")

    # Effects

    def defaulted(self, parameter: str, value: Value) -> None:
        """Record the value that the code uses if a parameter is not set, after the parameter was read."""
        for index, one in enumerate(self.declared):
            read = one.effect.access is Access.READ and one.default is None
            if read and isinstance(one.name, Text) and one.name.shown == parameter:
                self.declared[index] = replace(one, default=value, value_type=one.value_type or type_of_value(value))

    def converted(self, value: Value, name: str, template: tuple[Value, ...] = ()) -> None:
        """Record the type that a conversion gives a parameter without one: `as_int`, `get_value<int>`, `bool_value`.

        Code that converts the same parameter to several types chooses one when it runs, so none is recorded.
        """
        first = template[0] if template else None
        of = ros_type(first.kind) if isinstance(first, TypeValue) else None
        kind = of or _CONVERSIONS.get(name.removeprefix("as_").removesuffix("_value"))
        parameter = getattr(value, "parameter", None)
        if kind is None or parameter not in self._untyped:
            return
        kinds = self._untyped[parameter]
        kinds.add(kind)
        only = kind if len(kinds) == 1 else None
        for index, one in enumerate(self.declared):
            open_type = one.effect.access is not None and (one.value_type is None or one.by_conversion)
            if open_type and isinstance(one.name, Text) and one.name.shown == parameter:
                self.declared[index] = replace(one, value_type=only, by_conversion=True)

    def _apply(self, effect: Effect, call: Invocation) -> Value | None:
        """Add the interface or parameter of one effect; return the value of the parameter."""
        owner = call.node if isinstance(call.node, Object) else None
        if owner is not None and isinstance(carried := owner.native.get("node"), Object):
            owner = carried
        if call.node is not None and owner is None and effect.role and not isinstance(call.node, Unknown):
            return None
        if effect.listed:
            single = replace(effect, listed=False, name=0, default=1, descriptor=2, prefix=None, output=None)
            held = call.declared(effect.output, self.machine.language)
            values = held.arguments[-1] if held is not None and held.arguments else None
            if isinstance(values, TypeValue) and (shown := ros_type(values.kind)) is not None:
                single = replace(single, types=(shown,))
            for row in listed(effect, call):
                self._apply(single, Invocation(owner, Arguments(row)))
            frame, expressions = call.arguments.frame, call.arguments.written
            if effect.output is not None and frame is not None and effect.output < len(expressions):
                put(self.machine, expressions[effect.output], Mapping((), open=True), frame)
            return None
        if effect.specification is not None:
            self._specified(effect, owner, call)
            return None
        name = Text.of(effect.fixed) if effect.fixed is not None else call.argument(effect.name)
        if name is None:
            return None
        stack = tuple(self.machine.stack)
        if isinstance(name, Object) and (stated := option(name, "name")) is not None:
            stack = self._option_sites.get(name, stack)
            name = stated
        if effect.access is not None:
            return self._parameter(effect, owner, name, call)
        if isinstance(name, (Closure, Bound, Sequence, Mapping)):
            return None
        if isinstance(name, Text) and name.unsure:
            name = Unknown(UNSURE)
        whole = with_node_name(below(namespace_of(owner), name), owner)
        if is_empty_text(whole) or (is_empty_text(name) and isinstance(whole, Text) and whole.exact == "~"):
            return None  # the framework refuses an empty name
        given = call.argument(effect.qos)
        usual = Qos("reliable", "volatile", "keep_last", effect.depth) if effect.depth is not None else None
        profile = qos.profile_of(given) if given is not None else usual
        written = _written(effect, call, stack[-1].given if stack else ())
        full, kind = transported(effect, call, whole, message_type(self.machine.language, effect, call))
        self._add(Declared(effect, _shown(full), kind, owner, stack, profile, written=written))
        if effect.camera:
            info = _shown(camera_info(whole))
            kind = "sensor_msgs/CameraInfo"
            self._add(Declared(effect, info, kind, owner, stack, profile, written=written, origin=CAMERA_ORIGIN))
        return None

    def _add(self, declared: Declared) -> None:
        guards = tuple(self.machine.guards)
        self.declared.append(replace(declared, guards=guards) if guards else declared)

    def _specified(self, effect: Effect, owner: Object | None, call: Invocation) -> None:
        """Add the interface of a class: `Message` or `Service`, `name`, `depth`, `reliability`, `durability`."""
        language = self.machine.language
        if isinstance(effect.specification, int):
            declared = call.declared(effect.specification, language)
            template = declared.arguments if declared is not None else ()
        else:
            template = call.arguments.template
        inner = template[0] if template else None
        if not isinstance(inner, TypeValue) or inner.kind.cls is None:
            return
        kinds = [language.nested_type(inner.kind, name) for name in ("Message", "Service")]
        kind = next((type_name(one) for one in kinds if one is not None), None)
        name = language.static_member(inner.kind, "name")
        exact = name.exact if isinstance(name, Text) else None
        policies = ("depth", "reliability", "durability")
        fields = {one: value for one in policies if (value := language.static_member(inner.kind, one)) is not None}
        profile = qos.with_fields(Qos(history="keep_last"), fields) if isinstance(fields.get("depth"), Number) else None
        shown = Text.of(exact) if exact else Unknown("it is not specified")
        self._add(Declared(effect, shown, kind, owner, tuple(self.machine.stack), profile))

    def _parameter(self, effect: Effect, owner: Object | None, name: Value, call: Invocation) -> Value:
        """Record an access to a parameter, and write its value to the output argument."""
        machine, given = self.machine, call.arguments
        reading = self.parameters.read(machine.language, effect, owner, name, call)
        value = reading.value
        if effect.access is Access.WRITE and any(term.startswith("?") for term in machine.guards):
            return value
        stack, passed = tuple(machine.stack), self._passing(name)
        default, kind = reading.default, reading.type
        if kind is None and isinstance(reading.name, Text):
            self._untyped.setdefault(reading.name.shown, set())
        self._add(Declared(effect, reading.name, None, owner, stack, default=default, value_type=kind, passed=passed))
        if effect.output is not None and given.frame is not None and effect.output < len(given.written):
            written = value
            if isinstance(value, Unknown) and isinstance(reading.before, Text):
                written = Text.hole(value.reason, parameter=value.parameter)
            put(machine, given.written[effect.output], written, given.frame)
        return value

    def _passing(self, name: Value) -> int:
        """Return how many of the innermost running calls have a name as an argument, as a text or in a variable."""
        text = name.exact if isinstance(name, Text) else None
        sites = [site for site in reversed(self.machine.stack) if site.line] if text is not None else []
        passing, frame = 0, None
        for depth, site in enumerate(sites, 1):
            if any(isinstance(one, Literal) and one.value == text for one in site.given):
                return depth
            if site.frame is not None and self._passes(site.given, site.frame, text):
                passing, frame = depth, site.frame
            elif site.frame is not frame:
                break  # a call in the same function can be around the one that has the name
        return passing

    def _passes(self, given: tuple[Expression, ...], frame: Frame, text: str | None) -> bool:
        """Check whether an argument of a running call is a variable with a text."""
        values = (self.machine.value(one, frame) for one in given if isinstance(one, Name))
        return any(isinstance(value, Text) and value.exact == text for value in values)


def _is_unset(effect: Effect, given: Arguments) -> bool:
    """Check whether the name of an interface is that of a text to which the code that was run assigns nothing."""
    if effect.role is None or effect.name is None or effect.name >= len(given.values):
        return False
    return is_empty_text(given.values[effect.name])


def _written(effect: Effect, call: Invocation, constructed: tuple[Expression, ...]) -> str | None:
    """Return the expression that gives the name of an interface; `constructed` are the arguments of a construction."""
    expressions, values = call.arguments.written or constructed, call.arguments.values
    if effect.name is None or len(expressions) < len(values):
        return None
    index = effect.name + len(expressions) - len(values)  # a handle in front may have been taken off
    return spelled(expressions[index]) if index < len(expressions) else None


def _handle(namespace: str) -> Object:
    unknown = Text.hole("the class that makes the node handle gives its namespace", "namespace")
    inside = unknown if namespace == _ANY else Text.of(namespace)
    return Object(Kind(("ros", "NodeHandle")), native={"namespace": inside})


def _shown(name: Value) -> Text | Unknown:
    return name if isinstance(name, (Text, Unknown)) else Unknown("it is not a text")


def _in_scope(scopes: tuple[str, ...], scope: tuple[str, ...], uses: Iterable[tuple[str, ...]]) -> bool:
    """Check whether a function that is called with a scope is in one of some namespaces."""
    full = [tuple(one.split("::")) for one in scopes]
    if scope:
        return scopes == ("*",) or any(one[-len(scope) :] == scope or scope[-len(one) :] == one for one in full)
    return scopes == ("*",) or not {*full}.isdisjoint(uses)
