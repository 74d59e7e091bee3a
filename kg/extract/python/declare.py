"""From a call that declares something to the facts: names, types, quality of service, parameters and marks."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

from kg.extract.marks import Mark
from kg.extract.python.arguments import read_arguments
from kg.extract.python.entities import Dotted, Instance, Items, Made, Nothing, Table, Thunk
from kg.extract.python.library import declared_pairs
from kg.extract.python.program import GENERATED
from kg.extract.python.qos import quality
from kg.extract.python.syntax import code
from kg.extract.values import HOLE, OWN_NAMESPACE, Number, Text, Truth, Unknown, in_own_namespace
from kg.facts import Access, Interface, Location, Parameter, Resolution, Role
from kg.names import join, normalise, resolve

if TYPE_CHECKING:
    from kg.extract.python.api import Slot
    from kg.extract.python.arguments import Arguments
    from kg.extract.python.entities import Choice, Thing
    from kg.extract.python.evaluate import Evaluator
    from kg.extract.python.walk import Site

__all__ = ["Declarations", "declare", "plugin_asked"]

_NO_REASON: Final = "it is computed when the program runs"
_OWN_NAMESPACE: Final = "the namespace of the node is part of it"
_MAX_ROWS: Final = 64
_STEPS_FOR_A_SITE: Final = 800
_STEPS_FOR_A_NODE: Final = 12_000
_STEPS_WHEN_SPENT: Final = 100


@dataclass(slots=True)
class Declarations:
    """What the sites of one node declare."""

    nodes: list[tuple[Site, str | None]] = field(default_factory=list)
    interfaces: list[Interface] = field(default_factory=list)
    parameters: list[Parameter] = field(default_factory=list)
    marks: list[Mark] = field(default_factory=list)

    @property
    def name(self) -> str | None:
        """The name that the node gives itself."""
        return next((name for _, name in self.nodes if name), None)


def declare(sites: list[Site], evaluator: Evaluator, repository: str) -> Declarations:
    """Return what sites declare; `repository` is the source that the node belongs to."""
    evaluator.memory.clear()
    reader = _Reader(evaluator, repository)
    evaluator.limit = _STEPS_FOR_A_SITE
    for site in sites:
        evaluator.steps = 0
        if site.api.kind == "node":
            reader.node(site)
    spent = 0
    for site in sites:
        spent += evaluator.steps
        evaluator.steps, evaluator.limit = 0, _STEPS_FOR_A_SITE if spent < _STEPS_FOR_A_NODE else _STEPS_WHEN_SPENT
        if site.api.kind == "interface":
            reader.interface(site)
        elif site.api.kind == "parameter":
            reader.parameter(site)
        elif site.api.kind == "parameters":
            reader.parameters(site)
        if site.api.mark:
            reader.mark(site)
    return _tidied(reader.found)


def plugin_asked(site: Site, evaluator: Evaluator) -> str | None:
    """Return the plugin that a program asks rqt to start."""
    slot = site.api.name
    thunk = read_arguments(site.call, site.frame).get(slot.position, *slot.names) if slot is not None else None
    evaluator.steps = 0
    value = evaluator.thunk(thunk, site.choice)[0][0] if thunk is not None else None
    return value.known if isinstance(value, Text) else None


class _Reader:
    """Reads the arguments of sites."""

    def __init__(self, evaluator: Evaluator, repository: str) -> None:
        self.evaluator = evaluator
        self.repository = repository
        self.found = Declarations()
        self.namespaces: dict[int, str] = {}
        self.names: dict[int, str] = {}

    def rows(self, site: Site, slots: list[Slot | None]) -> list[tuple[list[Thing], Choice]]:
        """Return the combinations of what the arguments of a call can be; None stands for one not given."""
        arguments = self.arguments(site)
        thunks = []
        for slot in slots:
            thunk = arguments.get(slot.position, *slot.names) if slot is not None else None
            missing = Unknown("it is passed on in *args or **kwargs") if arguments.starred else Nothing()
            thunks.append(thunk or Thunk(None, None, missing))
        return self.evaluator.combined(thunks, site.frame, site.choice)[:_MAX_ROWS]

    def arguments(self, site: Site) -> Arguments:
        """Return the arguments of a call without the object itself."""
        arguments = read_arguments(site.call, site.frame)
        del arguments.positional[: site.skip]
        return arguments

    def location(self, site: Site) -> Location:
        """Return where a call stands."""
        file = site.frame.scope.unit.file
        other = None if file.repository == self.repository else file.repository
        return Location(file.path, site.call.start_point.row + 1, other)

    def node(self, site: Site) -> None:
        """Note that a node is made, with its name and namespace."""
        rows = self.rows(site, [site.api.name, site.api.namespace])
        name, namespace = rows[0][0] if rows else (Nothing(), Nothing())
        known = name.known if isinstance(name, Text) else None
        self.found.nodes.append((site, known))
        made = self.holder(site.receiver)
        key = made if made is not None else hash((site.call.start_byte, site.frame.id))
        self.namespaces[key] = (namespace.pattern or "") if isinstance(namespace, Text) else ""
        if known:
            self.names[key] = known

    def holder(self, thing: Thing | None) -> int | None:
        """Return the key of the node that an interface belongs to."""
        if isinstance(thing, Instance):
            return id(thing)
        return hash((thing.call.start_byte, thing.frame.id)) if isinstance(thing, Made) else None

    def interface(self, site: Site) -> None:
        """Note an interface, once for each combination of name and type."""
        api = site.api
        if api.role is None:
            return
        rows = self.rows(site, [api.name, api.type, api.qos, api.node])
        for values, _ in _known_only(rows):
            name, kind, qos, node = values
            holder = self.holder(node if api.node is not None else site.receiver)
            text = _placed(_as_name(name))
            pattern = _pattern(text)
            namespace = self.namespaces.get(holder or 0, "")
            inside = in_own_namespace(pattern) if pattern is not None else None
            if pattern is not None:
                pattern = join(namespace, normalise(pattern)) if inside is None else inside
            self.found.interfaces.append(
                Interface(
                    role=api.role,
                    name=pattern,
                    type=interface_type(kind, api.role),
                    resolution=_resolution(text, pattern),
                    location=self.location(site),
                    resolved=self.resolved(pattern, holder, namespace),
                    written=self.written(site, api.name),
                    parameter=text.parameter,
                    qos=quality(qos) if api.qos is not None else None,
                    reason=None if pattern is not None and HOLE not in text.parts else text.reason or _NO_REASON,
                )
            )

    def resolved(self, name: str | None, holder: int | None, namespace: str) -> str | None:
        """Return a name for the node started alone; the namespace stands in front of all but private names."""
        if name is None:
            return None
        node = self.names.get(holder or 0) or self.found.name or "node"
        return resolve(name, node, namespace if name.startswith("~") else "/")

    def written(self, site: Site, slot: Slot | None) -> str | None:
        """Return the expression of an argument as it stands in the code."""
        thunk = self.arguments(site).get(slot.position, *slot.names) if slot is not None else None
        return code(thunk.node) if thunk is not None and thunk.node is not None else None

    def parameter(self, site: Site) -> None:
        """Note a parameter that is read, written or declared."""
        if site.api.access is None:
            return
        for values, _ in _known_only(self.rows(site, [site.api.name, site.api.default])):
            self.add_parameter(site, values[0], values[1])

    def parameters(self, site: Site) -> None:
        """Note the parameters of `declare_parameters`."""
        for (prefix, items), _ in self.rows(site, [site.api.namespace, site.api.default]):
            for name, default in declared_pairs(prefix, items):
                self.add_parameter(site, name, default or Nothing())

    def add_parameter(self, site: Site, name: Thing, default: Thing) -> None:
        """Add one parameter."""
        text = _as_name(name)
        pattern = _pattern(text)
        kind, written = parameter_type(default), None if site.api.access is Access.WRITE else as_yaml(default)
        if _DYNAMIC in site.frame.scope.unit.source:
            kind = None
        if site.api.access is None:
            return
        self.found.parameters.append(
            Parameter(
                name=normalise(pattern) if pattern else None,
                type=kind,
                default=written,
                access=site.api.access,
                location=self.location(site),
                resolution=_resolution(text, pattern),
                reason=None if pattern and HOLE not in text.parts else text.reason or _NO_REASON,
            )
        )

    def mark(self, site: Site) -> None:
        """Note the use of a framework."""
        if site.api.mark is None:
            return
        for values, _ in _known_only(self.rows(site, [site.api.name, site.api.type, site.api.namespace])):
            name, kind, namespace = values
            if site.api.mark.startswith("dynamic_reconfigure"):
                detail, under = configuration(kind), _handle_namespace(namespace)
            else:
                pattern = _pattern(_as_name(name)) if site.api.name is not None and site.api.kind == "mark" else None
                detail, under = (normalise(pattern) if pattern else None), ""
            self.found.marks.append(Mark(site.api.mark, self.location(site), under, detail))


def _handle_namespace(value: Thing) -> str:
    pattern = value.pattern if isinstance(value, Text) else None
    return normalise(pattern) if pattern else "~"


def _known_only(rows: list[tuple[list[Thing], Choice]]) -> list[tuple[list[Thing], Choice]]:
    """Drop combinations whose first value is not known, unless there are no others."""
    known = [row for row in rows if not isinstance(row[0][0], Unknown | Nothing)]
    better = [row for row in known if isinstance(row[0][0], Text) and row[0][0].pattern is not None]
    return better or known or rows[:1]


def _as_name(value: Thing) -> Text:
    if isinstance(value, Text):
        return value
    reason = value.reason if isinstance(value, Unknown) else _NO_REASON
    return Text((HOLE,), Resolution.UNRESOLVED, reason=reason)


def _placed(text: Text) -> Text:
    """Return a name with the node's namespace in front of it alone, which makes it relative; elsewhere it is a hole."""
    parts: list[str | None] = []
    for index, part in enumerate(text.parts if text.resolution is not Resolution.LITERAL else ()):
        body = part[1:] if part is not None and not index and part.startswith(f"/{OWN_NAMESPACE}") else part
        if body is None:
            parts.append(HOLE)
            continue
        front = OWN_NAMESPACE if not index and body.startswith(OWN_NAMESPACE) else ""
        first, *others = body.removeprefix(front).split(OWN_NAMESPACE)
        parts.append(front + first)
        parts.extend(piece for other in others for piece in (HOLE, other))
    if not parts:
        return text
    return replace(text, parts=tuple(parts), reason=text.reason if HOLE not in parts else text.reason or _OWN_NAMESPACE)


def _pattern(text: Text) -> str | None:
    """Return the name with `{}` for what is not known; the node's own name in front is the private namespace."""
    pattern = text.pattern
    if pattern is None or pattern == "":
        return None
    return pattern.lstrip("/") if pattern.startswith("/~") else pattern


def _resolution(text: Text, pattern: str | None) -> Resolution:
    if pattern is None:
        return Resolution.UNRESOLVED
    return Resolution.PARTIAL if HOLE in text.parts else text.resolution


def interface_type(value: Thing, role: Role) -> str | None:
    """Return `package/Type` of a generated class; a ROS 1 action drops its suffix `Action`."""
    if not isinstance(value, Dotted):
        return None
    parts = value.path.replace("diagnostic_updater.", "diagnostic_msgs.msg.").split(".")
    inner = [index for index, part in enumerate(parts) if part in GENERATED]
    if not inner or inner[0] == 0 or inner[-1] == len(parts) - 1:
        return None
    package, name = parts[inner[0] - 1], parts[-1]
    if role in (Role.ACTION_SERVERS, Role.ACTION_CLIENTS) and parts[inner[0]] == "msg":
        name = name.removesuffix("Action")
    return f"{package}/{name}"


def configuration(value: Thing) -> str | None:
    """Return `package/Name` of a dynamic_reconfigure configuration (`package.cfg.NameConfig`)."""
    if not isinstance(value, Dotted):
        return None
    parts = [part for part in value.path.split(".") if part != "cfg"]
    if len(parts) < 2:  # noqa: PLR2004 - package and name
        return None
    return f"{parts[0]}/{parts[-1].removesuffix('Config')}"


_DYNAMIC: Final = b"dynamic_typing"
"""In a descriptor, lets a parameter of ROS 2 take values of any type; for which ones is not followed."""
_SCALARS: Final = {bool: "bool", int: "int", float: "double"}


def parameter_type(value: Thing) -> str | None:
    """Return the ROS type of a default value, or the one that `rclpy.Parameter.Type.X` names in its place."""
    if isinstance(value, Truth):
        return "bool"
    if isinstance(value, Number):
        return "int" if value.written.lstrip("-").isdigit() else "double"
    if isinstance(value, Text):
        return "string"
    if isinstance(value, Dotted) and ".Type." in value.path:
        word = value.path.rpartition(".")[2].lower()
        return {"integer": "int", "integer_array": "int_array", "not_set": None}.get(word, word)
    if isinstance(value, Items):
        kinds = {parameter_type(item) for item in value.items}
        kind = next(iter(kinds)) if len(kinds) == 1 else None
        return f"{kind}_array" if kind else None
    return None


def as_yaml(value: Thing) -> str | None:
    """Return a default value as YAML in one line; None when it is not known."""
    if isinstance(value, Truth):
        return str(value.value).lower()
    if isinstance(value, Number):
        return value.written
    if isinstance(value, Text):
        return value.known
    if isinstance(value, Items):
        items = [as_yaml(item) for item in value.items]
        known = [item for item in items if item is not None]
        return f"[{', '.join(known)}]" if len(known) == len(items) else None
    if isinstance(value, Table):
        pairs = [(as_yaml(key), as_yaml(held)) for key, held in value.items]
        return "{" + ", ".join(f"{key}: {held}" for key, held in pairs) + "}" if None not in sum(pairs, ()) else None
    return None


def _tidied(found: Declarations) -> Declarations:
    """Drop repetitions, waits for services that a client names too, and untyped twins of typed interfaces."""
    kept: dict[tuple[object, ...], Interface] = {}
    for item in found.interfaces:
        told = (item.location, item.parameter) if "{}" in (item.name or "{}") else None
        kept.setdefault((item.role, item.name, item.type, told), item)
    typed = {(item.role, item.name) for item in kept.values() if item.type is not None}
    found.interfaces = sorted(
        (item for item in kept.values() if item.type is not None or (item.role, item.name) not in typed),
        key=lambda item: (item.location.path, item.location.line, item.role, item.name or "", item.type or ""),
    )
    unique: dict[tuple[object, ...], Parameter] = {}
    for entry in found.parameters:
        key = (entry.name, entry.access, entry.location if entry.name is None else None)
        known = unique.get(key)
        if known is None or (known.default is None and entry.default is not None):
            unique[key] = entry if known is None else replace(known, default=entry.default, type=entry.type)
    found.parameters = list(unique.values())
    found.marks = list(dict.fromkeys(found.marks))
    return found
