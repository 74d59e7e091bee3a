"""The declarations of an interpretation as facts, with names as users see them and lines in the node's own package."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final, Protocol

from kg.extract.marks import Mark
from kg.facts import HOLDS, Access, Bound, Interface, Location, NodeKind, Parameter, Resolution, Role
from kg.holes import ANONYMOUS, PARENT, Hole, is_known, is_partial, written
from kg.names import normalise
from kg.symbolic.form import Literal
from kg.symbolic.names import EMPTY, NODE_NAME, below, namespace_of
from kg.symbolic.operators import COUNT
from kg.symbolic.values import (
    Either,
    Mapping,
    Number,
    Object,
    Sequence,
    Text,
    Truth,
    TypeValue,
    Unknown,
    Value,
    as_text,
)

if TYPE_CHECKING:
    from collections.abc import Iterable
    from collections.abc import Mapping as Counts

    from kg.corpus.files import FilePath
    from kg.symbolic.effects import Declared, Framework
    from kg.symbolic.state import Site

_ROS2: Final = 2
_PARENT: Final = f"{{{PARENT}}}/"
_HOLDS: Final = f" {HOLDS}"
_NUMBERS: Final = {"int", "double"}
_OF_NODE: Final = "the name or namespace of the node is part of it"


class Home(Protocol):
    """The package that a node belongs to."""

    @property
    def repository(self) -> str:
        """The source of the package."""

    def is_own(self, file: FilePath) -> bool:
        """Return whether a file belongs to the package."""


def facts_of(
    declared: Iterable[Declared], home: Home, ros: int, alone: tuple[str, str]
) -> tuple[tuple[Interface, ...], tuple[Parameter, ...]]:
    """Return the interfaces and parameters that calls declared, each once.

    `alone` is the name of the node and its namespace when it is started alone.
    """
    interfaces: dict[tuple[object, ...], Interface] = {}
    parameters: dict[tuple[object, ...], Parameter] = {}
    several: set[tuple[object, ...]] = set()
    for one in declared:
        if one.effect.role is not None:
            interface = _interface(one, one.effect.role, home, ros, alone)
            unnamed = interface.location if interface.name is None and interface.parameter is None else None
            own = (interface.node, interface.role, interface.name)
            key: tuple[object, ...] = (*own, interface.type, interface.parameter, unnamed)
            before = interfaces.get(key)
            if before is None:
                interfaces[key] = interface
                continue
            common = tuple(one for one in before.switches if one in interface.switches)  # either way creates it
            again = before.again
            if interface.location not in (before.location, *again):
                again = (*again, interface.location)
            if common != before.switches or again is not before.again:
                interfaces[key] = replace(before, switches=common, again=again)
        elif one.effect.access is not None:
            parameter = _parameter(one, one.effect.access, home)
            key = (parameter.name, parameter.access, parameter.location if parameter.name is None else None)
            first = parameters.get(key)
            if first is None:
                parameters[key] = parameter
            elif _of_another_type(parameter, first):
                several.add(key)
            elif _worth(parameter) > _worth(first):  # the place stays that of the first access
                parameters[key] = replace(parameter, location=first.location, via=first.via)
    parameters.update((key, replace(parameters[key], type=None)) for key in several)
    typed = {(i.node, i.role, i.name, i.parameter) for i in interfaces.values() if i.type is not None}
    names: dict[tuple[object, ...], set[str | None]] = {}
    for found in interfaces.values():
        names.setdefault((found.role, found.type, found.parameter, found.location), set()).add(found.name)
    completed = (
        _with_one_condition(i)
        for i in interfaces.values()
        if i.type is not None or i.name is i.parameter is None or (i.node, i.role, i.name, i.parameter) not in typed
        if i.parameter is None or not _covered(i.name, names[i.role, i.type, i.parameter, i.location])
    )
    types = {one.name: one.type for one in parameters.values() if one.name is not None and one.type is not None}
    stated = (
        one if one.type is not None else replace(one, type=types.get(one.name or "")) for one in parameters.values()
    )
    return tuple(completed), tuple(stated)


def _with_one_condition(interface: Interface) -> Interface:
    """Return an interface with the innermost condition of the code alone, which says most, beside its parameters."""
    outer = [one for one in interface.switches if one.endswith(_HOLDS)][:-1]
    return (
        replace(interface, switches=tuple(one for one in interface.switches if one not in outer))
        if outer
        else interface
    )


def _covered(name: str | None, names: set[str | None]) -> bool:
    """Check whether another name of an interface that a parameter names says all that one says.

    It has the default, or the namespace that code puts in front of a name that is not absolute, and puts there once.
    """
    if name is None:
        return names != {None}
    if name.startswith(_PARENT):
        return name.removeprefix(_PARENT).startswith(_PARENT) and name.removeprefix(_PARENT) in names
    return _PARENT + name in names


def _of_another_type(parameter: Parameter, first: Parameter) -> bool:
    """Check whether two reads take types that no single value has, so that the node accepts either."""
    if parameter.default is not None or first.default is not None or None in (parameter.type, first.type):
        return False
    return parameter.access is Access.READ and parameter.type != first.type and {parameter.type, first.type} != _NUMBERS


def _worth(parameter: Parameter) -> tuple[bool, bool, bool]:
    """Return what an access says about its parameter, the most important first."""
    return (parameter.default is not None, parameter.access is Access.DECLARE, parameter.type is not None)


def names_of(framework: Framework, nodes: Iterable[Object], ros: int, kind: NodeKind) -> tuple[str | None, str | None]:
    """Return the name and the namespace that the code gives to a node, the first of these objects that gets a name.

    Either is None where the code gives none. The name has holes where it is not known, as has that of a program of
    ROS 2 whose node is made by code outside of the build. The namespace is absolute, with a hole where it is not known.
    """
    named = ((_name(one), one) for one in nodes)
    name, node = next(((name, one) for name, one in named if name), (None, None))
    if node is None:
        texts = [shown for value in framework.node_names if (shown := _shown(value))]
        unknown = ANONYMOUS if ros == _ROS2 and kind is not NodeKind.PLUGIN else None
        return next((text for text in texts if is_known(text)), texts[0] if texts else unknown), None
    return name, _namespace(node)


def _name(node: Object) -> str | None:
    own = node.native.get("name")
    return _shown(own) if own is not None else None


def _shown(name: Value) -> str:
    """Return the name that a node is given, with holes for what is not known."""
    return written(Hole() if part == NODE_NAME else part for part in as_text(name).parts)


def _namespace(node: Object) -> str | None:
    own = node.native.get("own namespace")
    return normalise(f"/{own.shown}") if isinstance(own, Text) else None


def bounds_of(reached: Counts[str, Site], home: Home) -> tuple[Bound, ...]:
    """Return the limits that an interpretation reached, with their places."""
    return tuple(Bound(limit, _place(site, home)) for limit, site in sorted(reached.items()))


def evidence(
    stack: tuple[Site, ...], home: Home, name: str | None = None, passed: int | None = None
) -> tuple[Location, tuple[Location, ...]]:
    """Return the innermost call in the node's own package, else the innermost of all, and the calls from there on.

    With a `name`: if that call is in a helper in another file, the innermost call in the package that gives the name as
    a text. Of a parameter, it can be in the same file, and in another package if it gives the whole name; else it is
    the outermost one in the package among those innermost calls that have the name as an argument, `passed` in number.
    """
    sites = [site for site in stack if site.line] or [stack[-1]]
    own = [home.is_own(site.unit.key) for site in sites]
    calls = range(len(sites) - 1, -1, -1)
    innermost = next((at for at in calls if own[at]), -1)
    places = list(calls)
    if passed is None:
        places = [at for at in calls if own[at] and (at == innermost or sites[at].unit is not sites[innermost].unit)]
    start = next((at for at in places if name is not None and _gives(sites[at], name, part=own[at])), None)
    if start is None and passed is not None:
        start = next((at for at in range(max(len(sites) - passed, 0), len(sites)) if own[at]), None)
    start = innermost if start is None else start
    first, *rest = (_place(site, home) for site in sites[start:])
    return first, tuple(dict.fromkeys(rest))


def _gives(site: Site, name: str, *, part: bool) -> bool:
    """Check whether an argument of a call is a name as text, or the last `part` of it."""
    texts = [given.value for given in site.given if isinstance(given, Literal) and isinstance(given.value, str)]
    whole = name.removeprefix("~/")
    return whole in texts or (part and any(text and whole.endswith(("/" + text, "." + text)) for text in texts))


def _place(site: Site, home: Home) -> Location:
    key = site.unit.key
    return Location(key.path, site.line, key.repository if key.repository != home.repository else None)


def mark_of(effect: tuple[str, Object | None, tuple[Site, ...], Value | None], home: Home) -> Mark:
    """Return the use of a framework as a mark."""
    key, node, stack, detail = effect
    place, via = evidence(stack, home)
    if isinstance(detail, Text) and detail.parts[:1] == (NODE_NAME,):
        detail = below(EMPTY, detail)
    if not key.startswith("dynamic_reconfigure"):
        return Mark(key, place, "", detail.shown if isinstance(detail, Text) else None, via)
    namespace = namespace_of(node)
    shown = normalise(namespace.shown) if isinstance(namespace, Text) else ""
    names = [part for part in detail.kind.names if part != "cfg"] if isinstance(detail, TypeValue) else []
    config = "/".join(names[-2:]).removesuffix("Config") if names else None
    return Mark(key, place, shown if node is not None else "~", config, via)


def with_slash(name: str) -> str:
    """Return a name as names are stored: `~/name` for `~name`."""
    return f"~/{name[1:]}" if name.startswith("~") and not name.startswith("~/") and name != "~" else name


def _named(name: Text | Unknown) -> tuple[str | None, Resolution, str | None, str | None]:
    """Return name, resolution, parameter and reason."""
    if isinstance(name, Unknown):
        return None, Resolution.UNRESOLVED, name.parameter, name.reason
    if name.wholly_unknown:
        given = name.parameter is not None and name.parameter.startswith("argv")
        return None, Resolution.LAUNCH_ARGUMENT if given else Resolution.UNRESOLVED, name.parameter, name.reason
    shown = with_slash(name.shown)
    if name.exact is None:
        return shown, Resolution.PARTIAL, name.parameter, name.reason or _OF_NODE
    if not shown:
        empty = f"the parameter {name.parameter} is empty by default" if name.parameter else "the name is empty"
        return None, Resolution.UNRESOLVED, name.parameter, empty
    return shown, name.resolution, name.parameter, name.reason


def _interface(one: Declared, role: Role, home: Home, ros: int, alone: tuple[str, str]) -> Interface:
    name, resolution, parameter, reason = _named(one.name)
    place, via = evidence(one.stack, home, name)
    return Interface(
        role=role,
        name=name,
        type=one.type,
        resolution=resolution,
        location=place,
        written=one.written,
        parameter=parameter,
        implicit=one.effect.implicit,
        origin=one.origin,
        qos=one.qos if ros == _ROS2 else None,
        reason=reason,
        arguments=_least_arguments(one.guards),
        switches=tuple(switch for term in one.guards if (switch := _switch(term, parameter if name is None else None))),
        via=via,
        node=_other_node(one, alone) if ros == _ROS2 else None,
    )


def _other_node(one: Declared, alone: tuple[str, str]) -> str | None:
    """Return the name of the node that has an interface; None for the node of the program that is `alone`.

    It is absolute if the code gives that node a namespace.
    """
    name = _name(one.node) if one.node is not None else None
    namespace = (_namespace(one.node) if one.node is not None else None) or "/"
    if not is_known(name) or (name, namespace) == alone or name.startswith("_") or is_partial(namespace):
        return None
    return name if namespace == "/" else f"{namespace}/{name}"


def _switch(term: str, naming: str | None) -> str | None:
    """Return a term of a guard as a switch; None if it is about the presence of an argument or what is set.

    An interface that only the parameter `naming` names exists if that parameter is set, which is a switch too. Whoever
    sets it wants the interface, so conditions of the code do not count there.
    """
    if term == f"?{naming}":
        return f"{naming} is set"
    if term.endswith(_HOLDS):
        return term if naming is None else None
    about_presence = term.removeprefix("!").startswith(("?", "argv[")) and " == " not in term
    return None if about_presence or COUNT.fullmatch(term) is not None else term


def _parameter(one: Declared, access: Access, home: Home) -> Parameter:
    name, resolution, _, reason = _named(one.name)
    place, via = evidence(one.stack, home, name, one.passed)
    return Parameter(
        name=name,
        type=one.value_type,
        default=_written(one.default) if one.default is not None else None,
        access=access,
        location=place,
        resolution=resolution,
        reason=reason,
        via=via,
    )


def _quoted(text: str) -> str:
    plain = text.replace("_", "").replace("/", "").replace("~", "").replace("-", "")
    words = ("true", "false", "null", "yes", "no", "on", "off")
    if plain.isalnum() and not plain.isdigit() and text.lower() not in words:
        return text
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'


def _least_arguments(guards: tuple[str, ...]) -> int:
    """Return the fewest arguments of the command line, without the program, with which conditions on `argc` hold."""
    most = 0
    for term in guards:
        match = COUNT.fullmatch(term)
        if match is not None and match[2].isdecimal():
            count = int(match[2])
            least = {"==": count, ">=": count, ">": count + 1, "!=": count + 1 if count == 1 else 1}.get(match[1], 1)
            most = max(most, least - 1)
    return most


def _written(value: Value) -> str | None:
    """Return a value as YAML; None for what is not known."""
    if isinstance(value, Either):
        texts = [shown for shown in map(_written, value.items) if shown is not None]
        return texts[0] if texts else None
    if isinstance(value, Text):
        return _quoted(value.exact) if value.exact is not None else None
    if isinstance(value, Number):
        return value.written
    if isinstance(value, Truth):
        return "true" if value.value else "false"
    if isinstance(value, Mapping):
        pairs = [(_written(key), _written(held)) for key, held in value.items]
        complete = all(key is not None and held is not None for key, held in pairs)
        return "{" + ", ".join(f"{key}: {held}" for key, held in pairs) + "}" if complete else None
    if isinstance(value, Sequence):
        items = [_written(item) for item in value.items]
        return None if None in items else "[" + ", ".join(str(item) for item in items) + "]"
    return None
