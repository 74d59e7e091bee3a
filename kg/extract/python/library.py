"""Functions outside of the build whose results matter for names: of Python itself, `rospy`, `rclpy` and argparse."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.extract.python import formatting
from kg.extract.python.arguments import read_arguments
from kg.extract.python.entities import (
    ArgumentsParsed,
    Bound,
    Dotted,
    Items,
    Made,
    Nothing,
    ParameterRead,
    QosValue,
    Table,
    plain,
)
from kg.extract.python.lookup import Lookups
from kg.extract.python.qos import read_qos
from kg.extract.values import HOLE, Number, Text, Unknown, concatenate
from kg.facts import Resolution
from kg.names import normalise

if TYPE_CHECKING:
    from collections.abc import Callable

    from tree_sitter import Node

    from kg.extract.python.arguments import Arguments
    from kg.extract.python.entities import Alternatives, Choice, Frame, Thing
    from kg.extract.python.unit import CallSite, Scope

__all__ = ["Library"]

_COMPUTED: Final = Unknown("it is computed when the program runs")
_COMMAND_LINE: Final = Unknown("it is given on the command line")


class Library(Lookups):
    """The part of the evaluator that knows functions outside of the build."""

    sites: dict[str, list[tuple[Scope, CallSite]]]
    _declared: dict[str, Thing] | None = None
    _options: dict[int, dict[str, Thing]] | None = None

    def library_call(self, value: Dotted | Bound, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """Return what calling something outside of the build gives."""
        last = value.path.rpartition(".")[2]
        arguments = read_arguments(node, frame)
        if value.path in _PURE:
            return self.pure(_PURE[value.path], value, arguments, frame, choice)
        if last in _PARSERS:
            return [(ArgumentsParsed(frame.scope.unit), choice)]
        if isinstance(value, Bound) and last in _NODE_METHODS:
            return _NODE_METHODS[last](self, value, arguments, frame, choice)
        special = _SPECIAL.get(value.path)
        if special:
            return special(self, value, arguments, frame, choice)
        prefix = value.path.partition(".")[0]
        if prefix in ("str", "dict", "list", "parameter", "?") and isinstance(value, Bound):
            return [(_COMPUTED, choice)]
        return [(Made(value.path, node, frame), choice)]

    def pure(
        self,
        function: Callable[[Thing, list[Thing], dict[str, Thing]], Thing],
        value: Dotted | Bound,
        arguments: Arguments,
        frame: Frame,
        choice: Choice,
    ) -> Alternatives:
        """Return what a function that needs nothing but its arguments gives."""
        receiver: Thing = value.receiver if isinstance(value, Bound) and value.receiver is not None else _COMPUTED
        names = list(arguments.named)
        rows = self.combined([*arguments.positional, *arguments.named.values()], frame, choice)
        split = len(arguments.positional)
        return [
            (function(receiver, values[:split], dict(zip(names, values[split:], strict=True))), after)
            for values, after in rows
        ]

    def get_param(self, value: Dotted | Bound, arguments: Arguments, frame: Frame, choice: Choice) -> Alternatives:
        """`rospy.get_param(name, default)`: the default, marked with the parameter's name."""
        del value
        name, default = arguments.get(0, "param_name"), arguments.get(1, "default")
        if name is None:
            return [(_COMPUTED, choice)]
        rows = self.combined([name] if default is None else [name, default], frame, choice)
        return [(parameter_value(row[0], row[1] if len(row) > 1 else None), after) for row, after in rows]

    def same(self, value: Dotted | Bound, arguments: Arguments, frame: Frame, choice: Choice) -> Alternatives:
        """A function that gives its first argument back, as far as names are concerned."""
        del value, frame
        first = arguments.get(0, "name")
        return self.thunk(first, choice) if first else [(_COMPUTED, choice)]

    def get_attribute(self, value: Dotted | Bound, arguments: Arguments, frame: Frame, choice: Choice) -> Alternatives:
        """`getattr(value, name, default)`."""
        del value
        if len(arguments.positional) < 2:  # noqa: PLR2004 - the value and the name
            return [(_COMPUTED, choice)]
        found: Alternatives = []
        for (held, name), after in self.combined(arguments.positional[:2], frame, choice):
            known = name.known if isinstance(name, Text) else None
            found.extend(self.member(held, known, frame, after) if known else [(_COMPUTED, after)])
        return found

    def declare(self, value: Dotted | Bound, arguments: Arguments, frame: Frame, choice: Choice) -> Alternatives:
        """`node.declare_parameter(name, default)`."""
        del value
        name, default = arguments.get(0, "name"), arguments.get(1, "value")
        if name is None:
            return [(_COMPUTED, choice)]
        rows = self.combined([name] if default is None else [name, default], frame, choice)
        return [
            (ParameterRead(parameter_value(row[0], row[1] if len(row) > 1 else None)), after) for row, after in rows
        ]

    def get_parameter(self, value: Dotted | Bound, arguments: Arguments, frame: Frame, choice: Choice) -> Alternatives:
        """`node.get_parameter(name)`: what was declared for it."""
        del value, frame
        name = arguments.get(0, "name")
        found: Alternatives = []
        for asked, after in self.thunk(name, choice) if name else ():
            known = asked.known if isinstance(asked, Text) else None
            default = self.declared().get(known or "")
            if default is None and arguments.get(1) is not None:
                default = self.thunk(arguments.positional[1], after)[0][0]
            found.append((ParameterRead(default or parameter_value(asked, None)), after))
        return found or [(_COMPUTED, choice)]

    def parameter_object(
        self, value: Dotted | Bound, arguments: Arguments, frame: Frame, choice: Choice
    ) -> Alternatives:
        """`parameter.get_parameter_value()`: the parameter itself, seen as a message."""
        del arguments, frame
        receiver = value.receiver if isinstance(value, Bound) else None
        return [(receiver or _COMPUTED, choice)]

    def declared(self) -> dict[str, Thing]:
        """Return the values with which parameters are declared in the code that was reached."""
        if self._declared is None:
            self._declared = {}
            for scope, call in self.sites.get("declare_parameter", ()):
                for frame in self.frames_around(scope):
                    self._declare_one(read_arguments(call.node, frame), frame)
            for scope, call in self.sites.get("declare_parameters", ()):
                for frame in self.frames_around(scope):
                    self._declare_many(read_arguments(call.node, frame), frame)
        return self._declared

    def frames_around(self, scope: Scope) -> list[Frame]:
        """Return the runs of a scope."""
        return self.frames_of(scope, None) if scope.kind == "function" else [self.program.scope_frame(scope)]

    def _declare_one(self, arguments: Arguments, frame: Frame) -> None:
        name, default = arguments.get(0, "name"), arguments.get(1, "value")
        if name is None:
            return
        for row, _ in self.combined([name] if default is None else [name, default], frame, {}):
            self._remember(row[0], row[1] if len(row) > 1 else None)

    def _declare_many(self, arguments: Arguments, frame: Frame) -> None:
        listed = arguments.get(1, "parameters")
        namespace = arguments.get(0, "namespace")
        if listed is None or namespace is None:
            return
        for (prefix, items), _ in self.combined([namespace, listed], frame, {}):
            for name, default in declared_pairs(prefix, items):
                self._remember(name, default)

    def _remember(self, name: Thing, default: Thing | None) -> None:
        known = name.known if isinstance(name, Text) else None
        if known and self._declared is not None:
            self._declared.setdefault(known, parameter_value(name, default))

    def option(self, parsed: ArgumentsParsed, name: str) -> Thing:
        """Return the default of an option of argparse or optparse, as a launch argument."""
        self._options = self._options if self._options is not None else {}
        key = id(parsed.unit)
        if key not in self._options:
            self._options[key] = {}
            self._options[key] = self._read_options(parsed)
        return self._options[key].get(name, _COMMAND_LINE)

    def _read_options(self, parsed: ArgumentsParsed) -> dict[str, Thing]:
        found: dict[str, Thing] = {}
        for scope in parsed.unit.scopes:
            for call in scope.calls:
                if call.name in ("add_argument", "add_option"):
                    frame = self.program.scope_frame(scope)
                    found.update(self._read_option(read_arguments(call.node, frame)))
        return found

    def _read_option(self, arguments: Arguments) -> dict[str, Thing]:
        flags = [str(plain(self.thunk(thunk, {})[0][0]) or "") for thunk in arguments.positional]
        named = arguments.named.get("dest")
        long = [flag for flag in flags if flag.startswith("--")] or flags[:1]
        target = (
            plain(self.thunk(named, {})[0][0]) if named else (long[0].lstrip("-").replace("-", "_") if long else "")
        )
        default = arguments.named.get("default")
        if not target or default is None:
            return {}
        value = self.thunk(default, {})[0][0]
        if isinstance(value, Text):
            value = replace(value, resolution=Resolution.LAUNCH_ARGUMENT)
        return {str(target): value}


def parameter_value(name: Thing, default: Thing | None) -> Thing:
    """Return the value of a parameter: its default, marked with the parameter's name, or a hole."""
    asked = name.pattern if isinstance(name, Text) else None
    written = normalise(asked) if asked else None
    reason = f"the parameter {written or ''} has no default in the code".replace("  ", " ")
    if default is None or isinstance(default, Nothing):
        return Text((HOLE,), Resolution.UNRESOLVED, written, reason)
    return _marked(default, written, reason)


def _marked(value: Thing, parameter: str | None, reason: str) -> Thing:
    if isinstance(value, Text):
        return replace(value, resolution=Resolution.PARAMETER_DEFAULT, parameter=parameter)
    if isinstance(value, Items):
        return Items(tuple(_marked(item, parameter, reason) for item in value.items))
    if isinstance(value, Unknown):
        return Text((HOLE,), Resolution.UNRESOLVED, parameter, reason)
    return value


def declared_pairs(prefix: Thing, items: Thing) -> list[tuple[Text, Thing | None]]:
    """Return names and defaults of the list that `declare_parameters` takes, the namespace put in front."""
    before = prefix.known if isinstance(prefix, Text) else None
    found: list[tuple[Text, Thing | None]] = []
    for item in items.items if isinstance(items, Items) else ():
        parts = item.items if isinstance(item, Items) else (item,)
        if parts and isinstance(parts[0], Text):
            name = concatenate(Text.of(f"{before}."), parts[0]) if before else parts[0]
            found.append((name, parts[1] if len(parts) > 1 else None))
    return found


def _join_path(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    """`os.path.join` and the name joins of ROS: parts with one slash between; an absolute part starts anew."""
    del receiver, named
    pieces = [formatting.stringify(value) for value in values]
    joined: Text = concatenate()
    for piece in pieces:
        part = piece if isinstance(piece, Text) else concatenate(piece)
        first = part.parts[0] if part.parts else None
        if first is not None and first.startswith(("/", "~")):
            joined = part
            continue
        last = joined.parts[-1] if joined.parts else ""
        needs = bool(joined.parts) and not (last is not None and last.endswith("/")) and last != ""
        joined = concatenate(joined, *([Text.of("/")] if needs else []), part)
    return joined


def _join(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    """`separator.join(parts)`."""
    del named
    if not isinstance(receiver, Text) or len(values) != 1 or not isinstance(values[0], Items):
        return _COMPUTED
    pieces = []
    for index, item in enumerate(values[0].items):
        pieces.extend([receiver, item] if index else [item])
    return concatenate(*map(formatting.stringify, pieces))


def _format(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    return formatting.format_braces(receiver, values, named) if isinstance(receiver, Text) else _COMPUTED


def _split(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del named
    separator = plain(values[0]) if values else None
    if not isinstance(receiver, Text) or receiver.known is None or (values and not isinstance(separator, str)):
        return _COMPUTED
    parts = receiver.known.split(separator if isinstance(separator, str) and separator else None)
    return Items(tuple(replace(receiver, parts=(part,)) for part in parts))


def _string_method(name: str) -> Callable[[Thing, list[Thing], dict[str, Thing]], Thing]:
    def apply(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
        del named
        given = [plain(value) for value in values]
        known = receiver.known if isinstance(receiver, Text) else None
        if not isinstance(receiver, Text) or not all(isinstance(item, str) for item in given):
            return _COMPUTED
        if known is None:
            return receiver if name in ("strip", "rstrip", "lstrip", "encode", "decode") else concatenate(_COMPUTED)
        return replace(receiver, parts=(formatting.STRING_METHODS[name](known, [str(item) for item in given]),))

    return apply


def _dictionary(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    """`dict(...)` and `OrderedDict(...)`."""
    del receiver
    pairs: tuple[tuple[Thing, Thing], ...] = ()
    if values and isinstance(values[0], Table):
        pairs = values[0].items
    elif values and isinstance(values[0], Items):
        rows = [item.items for item in values[0].items if isinstance(item, Items)]
        pairs = tuple((row[0], row[1]) for row in rows if len(row) == 2)  # noqa: PLR2004 - key and value
    elif values:
        return _COMPUTED
    return Table((*pairs, *((Text.of(name), value) for name, value in named.items())))


def _elements(value: Thing) -> tuple[Thing, ...] | None:
    if isinstance(value, Items):
        return value.items
    return tuple(key for key, _ in value.items) if isinstance(value, Table) else None


def _listed(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    """`list(x)`, `tuple(x)`, `sorted(x)`, `reversed(x)`, `set(x)`."""
    del receiver, named
    elements = _elements(values[0]) if values else ()
    return _COMPUTED if elements is None else Items(elements)


def _zip(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del receiver, named
    columns = [_elements(value) for value in values]
    known = [column for column in columns if column is not None]
    if len(known) != len(columns):
        return _COMPUTED
    return Items(tuple(Items(row) for row in zip(*known, strict=False)))


def _enumerate(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del receiver
    elements = _elements(values[0]) if values else None
    start = plain(named.get("start", values[1] if len(values) > 1 else Number(0, "0")))
    if elements is None or not isinstance(start, int | float):
        return _COMPUTED
    return Items(tuple(Items((_number(int(start) + index), item)) for index, item in enumerate(elements)))


def _range(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del receiver, named
    bounds = [plain(value) for value in values]
    if not bounds or len(bounds) > 3 or not all(isinstance(bound, int | float) for bound in bounds):  # noqa: PLR2004 - start, stop, step
        return _COMPUTED
    numbers = [int(bound or 0) for bound in bounds]
    if len(numbers) == 3 and numbers[2] == 0:  # noqa: PLR2004 - start, stop, step
        return _COMPUTED
    return Items(tuple(_number(number) for number in range(*numbers)[:_MAX_RANGE]))


_MAX_RANGE: Final = 64


def _number(value: int) -> Number:
    return Number(value, str(value))


def _length(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del receiver, named
    elements = _elements(values[0]) if values else None
    return _COMPUTED if elements is None else _number(len(elements))


def _class_of(kind: str) -> Callable[[Thing, list[Thing], dict[str, Thing]], Thing]:
    """`get_message_class("package/Type")` and its like."""

    def apply(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
        del receiver, named
        name = plain(values[0]) if values else None
        package, _, last = name.partition("/") if isinstance(name, str) else ("", "", "")
        return Dotted(f"{package}.{kind}.{last}") if package and last and "/" not in last else _COMPUTED

    return apply


def _string(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del receiver, named
    return concatenate(formatting.stringify(values[0])) if values else Text.of("")


def _first(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del receiver, named
    return values[0] if values else _COMPUTED


def _pairs(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del values, named
    return Items(tuple(Items(pair) for pair in receiver.items)) if isinstance(receiver, Table) else _COMPUTED


def _keys(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del values, named
    return Items(tuple(key for key, _ in receiver.items)) if isinstance(receiver, Table) else _COMPUTED


def _held(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del values, named
    return Items(tuple(value for _, value in receiver.items)) if isinstance(receiver, Table) else _COMPUTED


def _get(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del named
    if not isinstance(receiver, Table) or not values:
        return _COMPUTED
    return receiver.get(values[0]) or (values[1] if len(values) > 1 else Nothing())


def _text(text: str) -> Callable[[Thing, list[Thing], dict[str, Thing]], Thing]:
    def apply(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
        del receiver, values, named
        return Text.of(text, Resolution.CONSTANT)

    return apply


def _command_line(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del receiver, values, named
    return _COMMAND_LINE


def _qos(receiver: Thing, values: list[Thing], named: dict[str, Thing]) -> Thing:
    del receiver
    return QosValue(read_qos(values, named))


_PURE: Final[dict[str, Callable[[Thing, list[Thing], dict[str, Thing]], Thing]]] = {
    **{f"builtins.{name}": _listed for name in ("list", "tuple", "sorted", "reversed", "set", "frozenset", "iter")},
    **{f"builtins.{name}": _string for name in ("str", "unicode", "repr")},
    **{f"builtins.{name}": _first for name in ("int", "float", "bool")},
    **{f"builtins.{name}": _range for name in ("range", "xrange")},
    "builtins.zip": _zip,
    "itertools.izip": _zip,
    "builtins.enumerate": _enumerate,
    "builtins.len": _length,
    "builtins.dict": _dictionary,
    "collections.OrderedDict": _dictionary,
    "copy.copy": _first,
    "copy.deepcopy": _first,
    **dict.fromkeys(("os.path.join", "posixpath.join"), _join_path),
    **{f"{package}.names.ns_join": _join_path for package in ("rosgraph", "roslib", "rospy")},
    "str.join": _join,
    "str.format": _format,
    "str.split": _split,
    **{f"str.{name}": _string_method(name) for name in formatting.STRING_METHODS},
    **{f"dict.{name}": _pairs for name in ("items", "iteritems", "viewitems")},
    **{f"dict.{name}": _keys for name in ("keys", "iterkeys")},
    **{f"dict.{name}": _held for name in ("values", "itervalues")},
    "dict.get": _get,
    **{f"rospy.{name}": _text("~") for name in ("get_name", "get_caller_id", "names.get_caller_id")},
    "rospy.get_namespace": _text(""),
    "rospy.names.get_namespace": _text(""),
    "roslib.message.get_message_class": _class_of("msg"),
    "roslib.message.get_service_class": _class_of("srv"),
    "rospy.myargv": _command_line,
    "rospy.client.myargv": _command_line,
    "rclpy.qos.QoSProfile": _qos,
}  # fmt: skip
"""Functions that need nothing but their arguments, by full name; methods under `str`, `dict`, `list`."""

_Special = "Callable[[Library, Dotted | Bound, Arguments, Frame, Choice], Alternatives]"

_SPECIAL: Final[dict[str, Callable[[Library, Dotted | Bound, Arguments, Frame, Choice], Alternatives]]] = {
    **{f"rospy.{name}": Library.get_param for name in ("get_param", "get_param_cached", "client.get_param")},
    **{f"rospy.{name}": Library.same for name in ("resolve_name", "remap_name", "names.resolve_name")},
    "roslib.names.resolve_name": Library.same,
    "rosgraph.names.resolve_name": Library.same,
    "builtins.getattr": Library.get_attribute,
    "parameter.get_parameter_value": Library.parameter_object,
}

_PARSERS: Final = frozenset({"parse_args", "parse_known_args", "parse_intermixed_args"})


def _own_name(self: Library, value: Dotted | Bound, arguments: Arguments, frame: Frame, choice: Choice) -> Alternatives:
    del self, value, arguments, frame
    return [(Text.of("~", Resolution.CONSTANT), choice)]


def _own_namespace(
    self: Library, value: Dotted | Bound, arguments: Arguments, frame: Frame, choice: Choice
) -> Alternatives:
    del self, value, arguments, frame
    return [(Text.of("", Resolution.CONSTANT), choice)]


_NODE_METHODS: Final[dict[str, Callable[[Library, Dotted | Bound, Arguments, Frame, Choice], Alternatives]]] = {
    "declare_parameter": Library.declare,
    "get_parameter": Library.get_parameter,
    "get_parameter_or": Library.get_parameter,
    "get_name": _own_name,
    "get_fully_qualified_name": _own_name,
    "get_namespace": _own_namespace,
    "resolve_topic_name": Library.same,
    "resolve_service_name": Library.same,
}
"""Methods of a ROS 2 node (or of an object not known) that give names or parameters."""
