"""The engine: finds the uses of the tables in reached code and reads each as facts."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from itertools import islice
from typing import TYPE_CHECKING, Final

from kg.extract.cpp import syntax
from kg.extract.cpp.callbacks import callback_types
from kg.extract.cpp.command_line import CommandLine
from kg.extract.cpp.context import EMPTY, Site
from kg.extract.cpp.handles import joined_name
from kg.extract.cpp.matching import Matcher
from kg.extract.cpp.options import consumer
from kg.extract.cpp.parameters import read_listed, read_parameter
from kg.extract.cpp.qos import read_qos
from kg.extract.cpp.sites import call_around
from kg.extract.cpp.specifications import specifications, specified, specified_qos
from kg.extract.cpp.switches import Switches
from kg.extract.cpp.unit import Expr
from kg.extract.marks import Mark
from kg.extract.values import Handle, Text, Truth, Unknown, worse
from kg.facts import Interface, Location, Resolution, Role

if TYPE_CHECKING:
    from collections.abc import Iterator

    from tree_sitter import Node

    from kg.extract.cpp.api import CallSpec, MarkSpec, TypeSpec
    from kg.extract.cpp.context import Context
    from kg.extract.cpp.evaluate import Evaluator
    from kg.extract.cpp.unit import Unit
    from kg.facts import Parameter, Qos

__all__ = ["Finder"]

_ROS2: Final = 2
_TOPICS: Final = frozenset({Role.PUBLISHES, Role.SUBSCRIBES})
_NAMESPACE_UNKNOWN: Final = "the namespace of its node handle is not known"


class Finder:
    """Reads the interfaces, parameters and marks of one program."""

    def __init__(self, evaluator: Evaluator) -> None:
        self._evaluator = evaluator
        self._api = evaluator.api
        self._program = evaluator.program
        self._matcher = Matcher(evaluator)
        self.interfaces: dict[tuple[object, ...], Interface] = {}
        self.parameters: dict[tuple[object, ...], Parameter] = {}
        self.marks: dict[Mark, None] = {}
        self.ros: set[int] = set()
        self._nodes: dict[Location, tuple[Unit, Node]] = {}
        self._command_line = CommandLine(evaluator.program, evaluator.sites)
        self._switches = Switches(evaluator.program)
        mains = [function for function in self._program.functions("main") if function in self._program.reached]
        self._counts_arguments = any("argc" in function.words and "if" in function.words for function in mains)

    def run(self) -> None:
        """Read every unit of the program."""
        api = self._api
        for unit in tuple(self._program.units.values()):
            for name in unit.having(tuple(api.calls)):
                self._calls(unit, name)
            for name in unit.having(tuple(api.parameters)):
                self._parameters(unit, name)
            for name in (*unit.having(tuple(api.types)), *unit.having(self._aliases)):
                self._types(unit, name)
            for name in unit.having(tuple(api.marks)):
                self._marked(unit, name, api.marks[name])
        for key, made in self.interfaces.items():
            if made.location in self._nodes and (asked := self._switches.around(self._nodes[made.location][1])):
                self.interfaces[key] = replace(made, switches=asked)

    def _uses(self, unit: Unit, name: str) -> Iterator[tuple[Node, Expr, syntax.Callee, list[Expr]]]:
        """Yield each call of a name in code that runs: the name, the call, what is called, and its arguments."""
        for node in unit.occurrences(name):
            call = call_around(node)
            if call is None or not self._program.runs(unit, node.start_byte) or self._in_helper(unit, node):
                continue
            around = unit.function_at(node.start_byte)
            if around is not None and not self._evaluator.sites.is_called(around):
                continue
            function = call.child_by_field_name("function")
            called = syntax.callee(function) if function is not None else None
            if called is not None:
                self._evaluator.restart()
                arguments = syntax.arguments(call.child_by_field_name("arguments"))
                yield node, Expr.of(unit, call), called, [Expr.of(unit, argument) for argument in arguments]

    def _in_helper(self, unit: Unit, node: Node) -> bool:
        """Tell whether a call stands in a function that a table knows and whose calls are read instead."""
        function = unit.function_at(node.start_byte)
        return function is not None and function.name in self._api.helpers

    def _calls(self, unit: Unit, name: str) -> None:
        for node, where, called, given in self._uses(unit, name):
            spec = self._matcher.call(self._api.calls[name], where, called, given)
            if spec is None and called.scope[-1:] == ("element_type",):
                self._made_by_type(where, node, given)
            elif spec is not None and spec.specified:
                self._specified(spec, where, node, called, given)
            elif spec is not None:
                handle = given[spec.handle] if spec.handle is not None else None
                if spec.options:
                    handle = consumer(where, called.receiver)
                elif spec.handle is None and called.receiver is not None:
                    handle = where.child(called.receiver)
                self._interface(spec, where, node, called, given, handle)

    def _specified(self, spec: CallSpec, where: Expr, node: Node, called: syntax.Callee, given: list[Expr]) -> None:
        """Read an interface whose name and type a class of its own specifies."""
        place = self._location(where.unit, node)
        for holder in specifications(self._evaluator, where, called, given):
            self.ros.add(spec.ros)
            qos = specified_qos(self._evaluator, holder) if spec.role in _TOPICS else None
            for name, kind in specified(self._evaluator, holder):
                made = _interface(spec.role, Handle(), name, kind, place, holder.name)
                self._add(replace(made, qos=qos), None)

    def _interface(  # noqa: PLR0913, PLR0917 - the parts of one call
        self, spec: CallSpec, where: Expr, node: Node, called: syntax.Callee, given: list[Expr], handle: Expr | None
    ) -> None:
        evaluator = self._evaluator
        place = self._location(where.unit, node)
        self.ros.add(spec.ros)
        for holder, after in self._holders(handle, spec.ros):
            for name, chosen in evaluator.texts(given[spec.name], after):
                kinds = self._kinds(spec, where, called, given, chosen)
                qos = self._qos(spec, given, chosen)
                for kind in kinds:
                    made = _interface(spec.role, holder, name, kind, place, syntax.text(given[spec.name].node))
                    made = replace(made, qos=qos)
                    self._add(made, spec.mark)
                    if spec.camera:
                        self._add(_camera_info(made), None)

    def _qos(self, spec: CallSpec | TypeSpec, given: list[Expr], context: Context) -> Qos | None:
        """Return the quality of service that a call gives, or the usual one of its kind where it gives none."""
        if spec.qos is None or spec.qos >= len(given):
            return spec.usual
        return read_qos(self._evaluator, given[spec.qos], context)

    def _holders(self, handle: Expr | None, ros: int) -> list[tuple[object, Context]]:
        """Return the handles that an expression can be; what is not understood counts only where nothing is.

        In ROS 2 only a sub-node adds a namespace; whatever else a node is reached through stands for the node.
        """
        if handle is None:
            return [(Handle(), EMPTY)]
        found = self._evaluator.values(handle, EMPTY)
        known = [(value, chosen) for value, chosen in found if isinstance(value, Handle)]
        if ros == _ROS2 and not known:
            return [(Handle(), chosen) for _, chosen in found]
        return list(known or found)

    def _kinds(
        self, spec: CallSpec, where: Expr, called: syntax.Callee, given: list[Expr], context: Context
    ) -> list[str | None]:
        """Return the types of an interface in the context of its name."""
        types = self._evaluator.types
        if spec.fixed is not None:
            return [spec.fixed]
        found: list[str | None] = []
        template = syntax.arguments(called.template)
        if spec.template is not None and spec.template < len(template):
            found = [kind for kind, _ in types.message(where.child(template[spec.template]), context)]
        elif spec.receiver_template and called.receiver is not None:
            settled = types.of(where.child(called.receiver), context)
            if settled is not None and settled.arguments:
                found = [kind for kind, _ in types.message(settled.arguments[0], context)]
        if not any(found) and spec.callback is not None and spec.callback < len(given):
            found = [kind for kind, _ in islice(callback_types(self._evaluator, given[spec.callback], context), 1)]
        if not any(found) and spec.typed is not None and spec.typed < len(given):
            settled = types.of(given[spec.typed], context)
            found = [types.as_message(settled)] if settled is not None else []
        if not any(found) and spec.spelled is not None and spec.spelled < len(given):
            texts = [
                value.known
                for value, _ in self._evaluator.texts(given[spec.spelled], context)
                if isinstance(value, Text)
            ]
            found = [_spelled(text) for text in texts]
        if spec.service:
            found = [self._service(kind) for kind in found]
        kept = list(dict.fromkeys(kind for kind in found if kind is not None))
        return list(kept) or [None]

    def _service(self, kind: str | None) -> str | None:
        """Return the service that a generated type (`package/TypeRequest`) belongs to."""
        package, _, name = (kind or "").partition("/")
        for suffix in ("Request", "Response"):
            known = self._program.project.reader.workspace.definition(package, name, "srv") is not None
            if name.endswith(suffix) and name != suffix and not known:
                return f"{package}/{name.removesuffix(suffix)}"
        return kind

    def _parameters(self, unit: Unit, name: str) -> None:
        for node, where, called, given in self._uses(unit, name):
            spec = self._matcher.parameter(self._api.parameters[name], where, called, given)
            if spec is None:
                continue
            self.ros.add(spec.ros)
            place = self._location(unit, node)
            if spec.listed:
                many = read_listed(self._evaluator, spec, given, place)
            else:
                many = read_parameter(self._evaluator, spec, where, called, given, place)
            for found in many:
                self.parameters.setdefault((found.name, found.access, found.location), found)
                self._switches.note(spec, where.node, given, found)

    @cached_property
    def _aliases(self) -> tuple[str, ...]:
        """The names that the program gives to types of the tables (`typedef message_filters::Subscriber<Imu> Sub`)."""
        names = set(self._api.types)
        aliases = {
            (name, syntax.simple_name(node))
            for unit in self._program.units.values()
            for name, nodes in unit.aliases.items()
            for node in nodes
        }
        found: dict[str, None] = {}
        while more := sorted({name for name, behind in aliases if behind in names} - names):
            names.update(more)
            found.update(dict.fromkeys(more))
        return tuple(found)

    def _types(self, unit: Unit, name: str) -> None:
        for node in unit.occurrences(name):
            if not self._program.runs(unit, node.start_byte):
                continue
            for site in self._evaluator.sites.constructed_at(unit, node):
                self._evaluator.restart()
                found = self._matcher.type(site)
                if found is not None:
                    self._constructed(found[0], site, found[1], unit, node)

    def _made_by_type(self, where: Expr, node: Node, given: list[Expr]) -> None:
        """Read `decltype(member_)::element_type::create...(...)`, which makes what the member points to."""
        function = where.node.child_by_field_name("function")
        outer = function.child_by_field_name("scope") if function is not None else None
        inner = outer.named_children[0] if outer is not None and outer.type == "decltype" else None
        kind = self._evaluator.types.of(where.child(inner), EMPTY) if inner is not None else None
        for spec in self._api.types.get(kind.name, ()) if kind is not None else ():
            if kind is not None and not spec.scopes:
                self._constructed(spec, Site(where, tuple(given)), kind.arguments, where.unit, node)

    def _constructed(self, spec: TypeSpec, site: Site, template: tuple[Expr, ...], unit: Unit, node: Node) -> None:
        evaluator = self._evaluator
        given = list(site.arguments)
        place = self._location(site.place.unit, site.place.node) if site.place else self._location(unit, node)
        if spec.mark is not None and spec.role is None:
            self._server(spec, given, template, place)
            return
        if spec.constants:
            self._fixed(spec, given, place)
            return
        handles, index = self._handles(spec, given)
        if spec.role is None or index >= len(given):
            return
        self.ros.add(spec.ros)
        written = syntax.text(given[index].node)
        for holder, after in handles:
            for name, chosen in evaluator.texts(given[index], after):
                qos = self._qos(spec, given, chosen)
                for kind in self._template_kinds(spec, template, chosen):
                    made = _interface(spec.role, holder, name, kind, place, written)
                    self._add(replace(made, qos=qos), spec.mark)

    def _fixed(self, spec: TypeSpec, given: list[Expr], place: Location) -> None:
        """Add the interfaces of an object that names them itself; an argument `false` switches them off."""
        default = Handle(Text.of("~" if spec.private else ""))
        for holder, _ in self._evaluator.values(given[0], EMPTY) if given else [(default, EMPTY)]:
            if spec.role is not None and holder != Truth(value=False):
                for name, kind in spec.constants:
                    handle = holder if isinstance(holder, Handle) else default
                    self._add(_interface(spec.role, handle, Text.of(name), kind, place, None), spec.mark)

    def _handles(self, spec: TypeSpec, given: list[Expr]) -> tuple[list[tuple[object, Context]], int]:
        """Return the handles of a construction and the index of the name after a handle that may be left out."""
        evaluator = self._evaluator
        if spec.handle is None or spec.handle >= len(given):
            return [(Handle(Text.of("~" if spec.private else "")), EMPTY)], max(spec.name - 1, 0)
        found = evaluator.values(given[spec.handle], EMPTY)
        if spec.floating and any(isinstance(value, Text) for value, _ in found):
            return [(Handle(), EMPTY)], spec.name - 1
        if (
            spec.floating
            and not any(isinstance(value, Handle) for value, _ in found)
            and not self._is_handle(given[spec.handle])
        ):
            return [(Handle(), EMPTY)], spec.name - 1
        known = [(value, chosen) for value, chosen in found if isinstance(value, Handle)]
        return list(known or found), spec.name

    def _is_handle(self, where: Expr) -> bool:
        kind = self._evaluator.types.of(where, EMPTY)
        return kind is not None and kind.name in self._api.handles

    def _template_kinds(self, spec: TypeSpec, template: tuple[Expr, ...], context: Context) -> list[str | None]:
        if spec.fixed is not None:
            return [spec.fixed]
        if spec.template is None or spec.template >= len(template):
            return [None]
        found = [kind for kind, _ in self._evaluator.types.message(template[spec.template], context)]
        return [
            kind.removesuffix(spec.drop) if kind is not None and spec.drop else kind for kind in dict.fromkeys(found)
        ]

    def _server(self, spec: TypeSpec, given: list[Expr], template: tuple[Expr, ...], place: Location) -> None:
        """Mark a `dynamic_reconfigure` server with its namespace and configuration."""
        kinds = [kind for kind, _ in self._evaluator.types.message(template[0], EMPTY)] if template else [None]
        namespaces: list[str] = []
        if given:
            for value, _ in self._evaluator.values(given[-1] if len(given) > 1 else given[0], EMPTY):
                if isinstance(value, Handle):
                    namespaces.append(value.namespace.pattern or "")
        for kind in kinds:
            for namespace in namespaces or ["~"]:
                detail = kind.removesuffix("Config") if kind is not None else None
                self.marks.setdefault(Mark(spec.mark or "", place, namespace, detail))

    def _marked(self, unit: Unit, name: str, spec: MarkSpec) -> None:
        for node in unit.occurrences(name):
            if node.type != "type_identifier" and call_around(node) is None:
                continue
            if not self._program.runs(unit, node.start_byte) or (unit.captured("using") and _is_using(node)):
                continue
            place = self._location(unit, node)
            if spec.detail is None:
                self.marks.setdefault(Mark(spec.key, place))
                continue
            for site in self._evaluator.sites.constructed_at(unit, node):
                if spec.detail < len(site.arguments):
                    for value, _ in self._evaluator.texts(site.arguments[spec.detail], EMPTY):
                        if isinstance(value, Text) and value.pattern is not None:
                            self.marks.setdefault(Mark(spec.key, place, detail=value.pattern))

    def _add(self, made: Interface, mark: str | None) -> None:
        if self._counts_arguments and made.location in self._nodes:
            needed = self._command_line.needed(*self._nodes[made.location])
            made = replace(made, arguments=needed)
        key = (made.role, made.name, made.type, made.location, made.parameter)
        self.interfaces.setdefault(key, made)
        if mark is not None and made.name is not None:
            self.marks.setdefault(Mark(mark, made.location, detail=made.name))

    def _location(self, unit: Unit, node: Node) -> Location:
        other = None if unit.file.repository == self._program.project.repository else unit.file.repository
        place = Location(unit.file.path, unit.line(node.start_byte), other)
        self._nodes.setdefault(place, (unit, node))
        return place


def _interface(  # noqa: PLR0913, PLR0917 - the parts of one fact
    role: Role, holder: object, name: Text | Unknown, kind: str | None, place: Location, written: str | None
) -> Interface:
    shown = " ".join(written.split()) if written is not None else None
    if isinstance(name, Unknown):
        return Interface(role, None, kind, Resolution.UNRESOLVED, place, written=shown, reason=name.reason)
    if name.known == "":
        unset = "it is empty until run time"
        return Interface(
            role, None, kind, Resolution.UNRESOLVED, place, written=shown, parameter=name.parameter, reason=unset
        )
    known_handle = isinstance(holder, Handle)
    namespace = holder.namespace if isinstance(holder, Handle) else Text.of("")
    full = joined_name(namespace, name)
    pattern = full.pattern
    resolution, reason = full.resolution, full.reason
    if pattern is None:
        resolution = resolution if resolution is Resolution.LAUNCH_ARGUMENT else Resolution.UNRESOLVED
        reason = reason or "nothing of it is known"
    elif None in full.parts:
        resolution = (
            worse(Resolution.PARTIAL, resolution) if resolution is not Resolution.UNRESOLVED else Resolution.PARTIAL
        )
        reason = reason or "a part of it is computed at run time"
    elif not known_handle and not pattern.startswith(("/", "~")):
        resolution, reason = worse(resolution, Resolution.PARTIAL), _NAMESPACE_UNKNOWN
    return Interface(role, pattern, kind, resolution, place, written=shown, parameter=full.parameter, reason=reason)


def _camera_info(image: Interface) -> Interface:
    """Return the `camera_info` that stands beside an image topic (image_transport/camera_common.cpp)."""
    name = image.name
    if name is not None:
        head, slash, _ = name.rpartition("/")
        name = f"{head}{slash}camera_info"
    return replace(image, name=name, type="sensor_msgs/CameraInfo", origin="image_transport")


def _spelled(text: str | None) -> str | None:
    pieces = [piece for piece in (text or "").split("/") if piece not in ("msg", "srv", "action")]
    return "/".join(pieces) if len(pieces) == 2 else None  # noqa: PLR2004 - package and type


def _is_using(node: Node) -> bool:
    return any(parent.type in ("using_declaration", "friend_declaration") for parent in syntax.outward(node, 4))
