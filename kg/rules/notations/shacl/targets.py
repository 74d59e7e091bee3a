"""Targets: which nodes a shape is about, each kind as a pattern that binds `?this` (SHACL 2.1.3, SHACL-AF 3)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from pyoxigraph import BlankNode, NamedNode

from kg.rules.notations.shacl.functions import Functions
from kg.rules.notations.shacl.query import check_prebound, query_of, rename, spell
from kg.rules.notations.shacl.vocabulary import CLASSES, SUBCLASS, local_name, sh
from kg.syntax.names import RDF_TYPE

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.rules.form import Term
    from kg.rules.notations.shacl.graph import ShapesGraph

INSTANCE: Final = f"({RDF_TYPE}|({RDF_TYPE}/{SUBCLASS}+))"
"""The path from a node to the classes that it is a SHACL instance of; no part of it is empty, for that would be a read
of all nodes."""


def targets(graph: ShapesGraph, shape: Term) -> list[str]:
    """Return one pattern for each target of a shape; none for a shape without targets."""
    return [*_core(graph, shape), *(_custom(graph, target, shape) for target in graph.values(shape, sh("target")))]


def _core(graph: ShapesGraph, shape: Term) -> Iterator[str]:
    if nodes := [_constant(graph, node, shape, "targetNode") for node in graph.values(shape, sh("targetNode"))]:
        yield f"VALUES ?this {{ {' '.join(nodes)} }}"
    classes = [_constant(graph, node, shape, "targetClass") for node in graph.values(shape, sh("targetClass"))]
    if isinstance(shape, NamedNode) and any(graph.is_instance(shape, kind) for kind in CLASSES):
        classes.append(str(shape))
    yield from (f"?this {INSTANCE} {name} ." for name in dict.fromkeys(classes))
    for node in graph.values(shape, sh("targetSubjectsOf")):
        yield f"?this {_constant(graph, node, shape, 'targetSubjectsOf')} ?target ."
    for node in graph.values(shape, sh("targetObjectsOf")):
        yield f"?target {_constant(graph, node, shape, 'targetObjectsOf')} ?this ."


def _constant(graph: ShapesGraph, node: Term, shape: Term, name: str) -> str:
    if isinstance(node, BlankNode) or (name != "targetNode" and not isinstance(node, NamedNode)):
        raise graph.error(f"sh:{name} of {graph.called(shape)} is not named", shape, hint="Give it an IRI.")
    return str(node)


def _custom(graph: ShapesGraph, target: Term, shape: Term) -> str:
    """Return the pattern of a SPARQL-based target, or of a target of a type that the file declares."""
    if graph.is_instance(target, sh("SPARQLTarget")):
        return _selected(graph, target, {})
    kinds = [kind for kind in graph.values(target, RDF_TYPE) if graph.is_instance(kind, sh("SPARQLTargetType"))]
    if not kinds:
        hint = "Use a sh:SPARQLTarget, or an instance of a sh:SPARQLTargetType that this file declares."
        raise graph.unsupported(f"the sh:target of {graph.called(shape)}", shape, hint)
    parameters: dict[str, str] = {}
    for parameter in graph.values(kinds[0], sh("parameter")):
        path = graph.required(parameter, "path")
        values = graph.values(target, path) if isinstance(path, NamedNode) else []
        if len(values) > 1 or any(isinstance(value, BlankNode) for value in values):
            raise graph.error(
                f"a target needs one value of {path}: an IRI or a literal", target, hint="Keep one IRI or literal."
            )
        if not values and not graph.flag(parameter, "optional"):
            hint = "Add a value, or declare the parameter with sh:optional true."
            raise graph.error(f"a target of {kinds[0]} has no value of {path}", target, hint=hint)
        parameters |= {local_name(path): str(value) for value in values}
    if parameters:
        check_prebound(graph, query_of(graph, kinds[0], "select"), parameters)
    return _selected(graph, kinds[0], parameters)


def _selected(graph: ShapesGraph, owner: Term, parameters: dict[str, str]) -> str:
    """Return the query of a target as a sub-SELECT that gives `?this`."""
    query = query_of(graph, owner, "select")
    projected = {word.text for word in query.head if word.text.startswith("?")}
    if "?this" not in projected and "*" not in {word.text for word in query.head}:
        hint = "Name it in the SELECT: SELECT ?this WHERE { ... }."
        raise graph.error("the SELECT of a target does not give the variable ?this", owner, hint=hint)
    functions = Functions(graph)
    group = spell(functions.inside(rename(query.group, parameters), owner))
    modifiers = f" {spell(query.modifiers)}" if query.modifiers else ""
    head = (
        "DISTINCT ?this"
        if projected == {"?this"} and not any(word.text == "(" for word in query.head)
        else spell(query.head)
    )
    return f"{{ SELECT {head.removesuffix('WHERE').strip()} WHERE {{ {group} }}{modifiers} }}"
