"""Message, service and action definitions as triples; their fields are the parameters of onto-ros.

The type is shared by all sources, the definition belongs to one source: copies may differ.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.graph import vocabulary as v
from kg.graph.interfaces import interface_type
from kg.graph.ntriples import integer, literal

if TYPE_CHECKING:
    from kg.facts import Field, InterfaceDefinition
    from kg.graph.scope import Scope

_SIZES: Final = ("8", "16", "32", "64")
_PRIMITIVES: Final = frozenset(
    {"bool", "byte", "char", "float32", "float64", "string", "wstring", "time", "duration", "octet", "float", "double"}
    | {f"{sign}int{size}" for sign in ("", "u") for size in _SIZES}
)


def definition(scope: Scope, package: str, fact: InterfaceDefinition) -> None:
    """Write a definition that the package with the spelled IRI `package` holds."""
    iri = scope.unique(scope.iris.definition(scope.repository, fact.package, fact.kind, fact.name))
    subject, writer = f"<{iri}>", scope.writer
    writer.add(package, v.CONTAINS, subject)
    writer.described(subject, f"{fact.package}/{fact.name}", v.DEFINITION)
    writer.add(subject, v.NAME, literal(fact.name))
    writer.add(subject, v.DEFINITION_KIND, literal(fact.kind))
    writer.add(subject, v.DEFINES, interface_type(scope, fact.kind, f"{fact.package}/{fact.name}"))
    scope.evidence(subject, fact.location)
    for position, each in enumerate(fact.fields, 1):
        _field(scope, iri, fact.package, position, each)


def _field(scope: Scope, owner: str, package: str, position: int, fact: Field) -> None:
    writer, part = scope.writer, scope.part(owner, fact.section, fact.name)
    writer.add(f"<{owner}>", v.HAS_FIELD, part)
    writer.described(part, fact.name, v.FIELD)
    writer.add(part, v.NAME, literal(fact.name))
    writer.add(part, v.SECTION, literal(fact.section))
    writer.add(part, v.POSITION, integer(position))
    writer.add(part, v.FIELD_TYPE, literal(fact.type))
    writer.add(part, v.LINE, integer(fact.line))
    writer.text(part, v.DEFAULT_VALUE, fact.default)
    writer.text(part, v.CONSTANT_VALUE, fact.constant)
    writer.text(part, v.COMMENT, fact.comment)
    message = message_of(fact.type, package)
    if message:
        writer.add(part, v.HAS_FIELD_TYPE, interface_type(scope, "msg", message))


def message_of(kind: str, package: str) -> str | None:
    """Return the message `package/Type` that a field of type `kind` in `package` holds, None for a primitive.

    `Header` means `std_msgs/Header` (wiki.ros.org/msg), any other bare name for a message of the same package.
    """
    name = kind.partition("[")[0].partition("<")[0].strip()
    if name in _PRIMITIVES or not name:
        return None
    parts = [part for part in name.split("/") if part != "msg"]
    if len(parts) > 1:
        return "/".join(parts)
    return "std_msgs/Header" if name == "Header" else f"{package}/{name}"
