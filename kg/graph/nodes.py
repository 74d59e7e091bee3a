"""Node types with their interfaces and parameters become triples (RNKG, section 3)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from kg.facts import Interface, NodeType, Parameter
from kg.graph import vocabulary as v
from kg.graph.chains import chain_text
from kg.graph.fields import NODE, PARAMETER
from kg.graph.interfaces import interface
from kg.graph.plugin_slots import plugin_slot

if TYPE_CHECKING:
    from kg.graph.scope import Scope


@dataclass(frozen=True, slots=True)
class Stated:
    """A node type as the graph has it, its parts in the order in which they are read back, and the IRIs of all."""

    node: NodeType
    iri: str
    ends: tuple[str, ...]
    """The IRIs of its interfaces."""
    settable: tuple[str, ...]
    """The IRIs of its parameters."""


def order(fact: Interface | Parameter) -> tuple[str, str, str, int, str]:
    """Return what the interfaces, or the parameters, of a node are sorted by."""
    role = str(fact.role if isinstance(fact, Interface) else fact.access)
    return role, fact.name or "~~", fact.location.path, fact.location.line, fact.type or ""


def node(scope: Scope, package: str, fact: NodeType) -> Stated:
    """Write a node type of the package whose spelled IRI is `package`, with all it declares."""
    iri = scope.unique(scope.iris.node(scope.repository, scope.package, fact.name))
    subject, writer = f"<{iri}>", scope.writer
    writer.add(package, v.CONTAINS, subject)
    writer.described(subject, fact.name, v.NODE, v.NODE_TYPE)
    NODE.write(writer, subject, fact)
    if fact.exported is not None:
        writer.text(subject, v.EXPORTED_AT, chain_text((fact.exported,)))
    for bound in fact.bounds:
        writer.text(subject, v.BOUND, f"{bound.limit} {chain_text((bound.location,))}")
    _imports(scope, subject, fact)
    scope.evidence(subject, fact.location)
    if fact.executable is not None:
        executable = f"<{scope.iris.executable(scope.repository, scope.package, fact.executable)}>"
        scope.writer.add(subject, v.HAS_EXECUTABLE, executable)
        if scope.writer.described(executable, fact.executable, v.EXECUTABLE):
            scope.writer.text(executable, v.NAME, fact.executable)
    for path in fact.sources:
        writer.add(subject, v.HAS_SOURCE, scope.file(path))
    ends = [(each, interface(scope, iri, each)) for each in fact.interfaces]
    settable = [(parameter, _parameter(scope, iri, parameter)) for parameter in fact.parameters]
    for slot in fact.slots:
        plugin_slot(scope, iri, slot)
    ends.sort(key=lambda pair: order(pair[0]))
    settable.sort(key=lambda pair: order(pair[0]))
    interfaces, parameters = tuple(one for one, _ in ends), tuple(one for one, _ in settable)
    return Stated(
        replace(fact, aliases=tuple(sorted(fact.aliases)), interfaces=interfaces, parameters=parameters),
        iri,
        tuple(part for _, part in ends),
        tuple(part for _, part in settable),
    )


def _imports(scope: Scope, subject: str, fact: NodeType) -> None:
    """Write what a node imports, with the modules and folders that hold it, and each name with its place."""
    holders: dict[str, None] = {}
    for each in fact.imports:
        holders.update(dict.fromkeys(_holders(each.name)))
        scope.writer.text(subject, v.IMPORTED_AT, f"{each.name} {chain_text((each.location,))}")
    for name in holders:
        scope.writer.text(subject, v.IMPORTS, name)


def _holders(name: str) -> list[str]:
    """Return a name and what holds it: `RPi` for `RPi.GPIO`, `pcl` for `pcl/point_types.h`."""
    mark = "/" if "/" in name else "."
    if mark == "." and name.endswith((".h", ".hpp", ".hh")):
        return [name]
    parts = name.split(mark)
    return [mark.join(parts[:count]) for count in range(1, len(parts) + 1)]


def _parameter(scope: Scope, owner: str, fact: Parameter) -> str:
    writer, part = scope.writer, scope.part(owner, "parameter", fact.name)
    writer.add(f"<{owner}>", v.HAS_PARAMETER, part)
    writer.add(part, v.TYPE, v.PARAMETER)
    PARAMETER.write(writer, part, fact)
    scope.evidence(part, fact.location, fact.via)
    return part[1:-1]
