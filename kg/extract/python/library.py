"""Functions outside of the build whose results matter for names: of Python itself, `rospy`, `rclpy` and argparse."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.extract.python.arguments import read_arguments
from kg.extract.python.core import COMPUTED
from kg.extract.python.entities import (
    ArgumentsParsed,
    Bound,
    Dotted,
    Items,
    Made,
    Nothing,
    ParameterRead,
    Table,
    plain,
)
from kg.extract.python.lookup import Lookups
from kg.extract.python.pure import PURE
from kg.extract.values import COMMAND_LINE, HOLE, OWN_NAMESPACE, Text, Unknown, concatenate
from kg.facts import Resolution
from kg.names import normalise

if TYPE_CHECKING:
    from collections.abc import Callable

    from tree_sitter import Node

    from kg.extract.python.arguments import Arguments
    from kg.extract.python.entities import Alternatives, Choice, Frame, Thing
    from kg.extract.python.unit import CallSite, Scope

__all__ = ["Library"]


class Library(Lookups):
    """The part of the evaluator that knows functions outside of the build."""

    sites: dict[str, list[tuple[Scope, CallSite]]]
    _declared: dict[str, Thing] | None = None
    _options: dict[int, dict[str, Thing]] | None = None

    def library_call(self, value: Dotted | Bound, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """Return what calling something outside of the build gives."""
        last = value.path.rpartition(".")[2]
        arguments = read_arguments(node, frame)
        if value.path in PURE:
            return self.pure(PURE[value.path], value, arguments, frame, choice)
        if last in _PARSERS:
            return [(ArgumentsParsed(frame.scope.unit), choice)]
        if isinstance(value, Bound) and last in _NODE_METHODS:
            return _NODE_METHODS[last](self, value, arguments, frame, choice)
        special = _SPECIAL.get(value.path)
        if special:
            return special(self, value, arguments, frame, choice)
        prefix = value.path.partition(".")[0]
        if prefix in ("str", "dict", "list", "parameter", "?") and isinstance(value, Bound):
            return [(COMPUTED, choice)]
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
        receiver: Thing = value.receiver if isinstance(value, Bound) and value.receiver is not None else COMPUTED
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
            return [(COMPUTED, choice)]
        rows = self.combined([name] if default is None else [name, default], frame, choice)
        return [(parameter_value(row[0], row[1] if len(row) > 1 else None), after) for row, after in rows]

    def same(self, value: Dotted | Bound, arguments: Arguments, frame: Frame, choice: Choice) -> Alternatives:
        """A function that gives its first argument back, as far as names are concerned."""
        del value, frame
        first = arguments.get(0, "name")
        return self.thunk(first, choice) if first else [(COMPUTED, choice)]

    def get_attribute(self, value: Dotted | Bound, arguments: Arguments, frame: Frame, choice: Choice) -> Alternatives:
        """`getattr(value, name, default)`."""
        del value
        if len(arguments.positional) < 2:  # noqa: PLR2004 - the value and the name
            return [(COMPUTED, choice)]
        found: Alternatives = []
        for (held, name), after in self.combined(arguments.positional[:2], frame, choice):
            known = name.known if isinstance(name, Text) else None
            found.extend(self.member(held, known, frame, after) if known else [(COMPUTED, after)])
        return found

    def declare(self, value: Dotted | Bound, arguments: Arguments, frame: Frame, choice: Choice) -> Alternatives:
        """`node.declare_parameter(name, default)`."""
        del value
        name, default = arguments.get(0, "name"), arguments.get(1, "value")
        if name is None:
            return [(COMPUTED, choice)]
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
        return found or [(COMPUTED, choice)]

    def parameter_object(
        self, value: Dotted | Bound, arguments: Arguments, frame: Frame, choice: Choice
    ) -> Alternatives:
        """`parameter.get_parameter_value()`: the parameter itself, seen as a message."""
        del arguments, frame
        receiver = value.receiver if isinstance(value, Bound) else None
        return [(receiver or COMPUTED, choice)]

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
        return self._options[key].get(name, replace(COMMAND_LINE, reason="it is given on the command line"))

    def _read_options(self, parsed: ArgumentsParsed) -> dict[str, Thing]:
        calls = [(scope, call) for scope in parsed.unit.scopes for call in scope.calls if call.name in _OPTIONS]
        found: dict[str, Thing] = {}
        for scope, call in calls:
            found.update(self._read_option(read_arguments(call.node, self.program.scope_frame(scope))))
        return found

    def _read_option(self, arguments: Arguments) -> dict[str, Thing]:
        flags = [str(plain(self.thunk(thunk, {})[0][0]) or "") for thunk in arguments.positional]
        named = arguments.named.get("dest")
        long = [flag for flag in flags if flag.startswith("--")] or flags[:1]
        target = (
            plain(self.thunk(named, {})[0][0]) if named else (long[0].lstrip("-").replace("-", "_") if long else "")
        )
        if not target:
            return {}
        default = arguments.named.get("default")
        value = self.thunk(default, {})[0][0] if default is not None else Nothing()
        single = flags[0].startswith("-") and not {"nargs", "action"} & arguments.named.keys()
        parameter = f"argv[{'|'.join(flags)}]" if single else None
        if isinstance(value, Text):
            return {str(target): replace(value, resolution=Resolution.LAUNCH_ARGUMENT, parameter=parameter)}
        if not isinstance(value, Nothing):
            return {str(target): value}
        reason = f"it is the option {parameter} of the command line"
        return {str(target): replace(COMMAND_LINE, parameter=parameter, reason=reason)} if single else {}


def parameter_value(name: Thing, default: Thing | None) -> Thing:
    """Return the value of a parameter: its default, marked with the parameter's name, or a hole."""
    asked = name.pattern if isinstance(name, Text) else None
    written = normalise(asked) if asked else None
    reason = f"the parameter {written or ''} has no default in the code".replace("  ", " ")
    if default is None or isinstance(default, Nothing) or (isinstance(default, Items | Table) and not default.items):
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


_SPECIAL: Final[dict[str, Callable[[Library, Dotted | Bound, Arguments, Frame, Choice], Alternatives]]] = {
    **{f"rospy.{name}": Library.get_param for name in ("get_param", "get_param_cached", "client.get_param")},
    **{f"rospy.{name}": Library.same for name in ("resolve_name", "remap_name", "names.resolve_name")},
    "roslib.names.resolve_name": Library.same,
    "rosgraph.names.resolve_name": Library.same,
    "builtins.getattr": Library.get_attribute,
    "parameter.get_parameter_value": Library.parameter_object,
}

_OPTIONS: Final = frozenset({"add_argument", "add_option"})
_PARSERS: Final = frozenset({"parse_args", "parse_known_args", "parse_intermixed_args"})


def _own_name(self: Library, value: Dotted | Bound, arguments: Arguments, frame: Frame, choice: Choice) -> Alternatives:
    del self, value, arguments, frame
    return [(Text.of("~", Resolution.CONSTANT), choice)]


def _own_namespace(
    self: Library, value: Dotted | Bound, arguments: Arguments, frame: Frame, choice: Choice
) -> Alternatives:
    del self, value, arguments, frame
    return [(Text.of(OWN_NAMESPACE, Resolution.CONSTANT), choice)]


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
