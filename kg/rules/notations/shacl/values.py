"""Constraints on single value nodes (SHACL, sections 4.1 to 4.4 and 4.8), as filters on a term."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from pyoxigraph import BlankNode, Literal, NamedNode

from kg.rules.notations.shacl.logic import Cases, check, matched
from kg.rules.notations.shacl.targets import INSTANCE
from kg.rules.notations.shacl.vocabulary import RDF, SH, XSD, sh

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from kg.rules.form import Term
    from kg.rules.notations.shacl.graph import ShapesGraph

_KINDS: Final = {
    "IRI": ("isIRI",),
    "BlankNode": ("isBlank",),
    "Literal": ("isLiteral",),
    "BlankNodeOrIRI": ("isBlank", "isIRI"),
    "BlankNodeOrLiteral": ("isBlank", "isLiteral"),
    "IRIOrLiteral": ("isIRI", "isLiteral"),
}
_NAMES: Final = """
integer decimal float double nonPositiveInteger negativeInteger long int short byte
nonNegativeInteger unsignedLong unsignedInt unsignedShort unsignedByte positiveInteger
"""
_NUMBERS: Final = frozenset(f"{XSD}{name}" for name in _NAMES.split())
_DATES: Final = frozenset(f"{XSD}{name}" for name in ("dateTime", "date"))


def constant(graph: ShapesGraph, node: Term, shape: Term, name: str) -> str:
    """Return a term of the shapes graph as SPARQL; KG230 for a blank node, which is not a node of the data."""
    if isinstance(node, BlankNode):
        raise graph.unsupported(f"a blank node as the value of sh:{name}", shape, "Give it an IRI or a literal.")
    return str(node)


def whole_number(graph: ShapesGraph, shape: Term, name: str, value: Term) -> int:
    """Return the number of a constraint; KG201 if it is none."""
    if not isinstance(value, Literal) or not value.value.isdecimal():
        raise graph.error(f"sh:{name} of {graph.called(shape)} is {value}", shape, hint="It is a whole number.")
    return int(value.value)


def _class(graph: ShapesGraph, shape: Term, value: Term, term: str, *, wanted: bool) -> Cases:
    return matched(f"{term} {INSTANCE} {constant(graph, value, shape, 'class')} .", wanted=wanted)


def _datatype(graph: ShapesGraph, shape: Term, value: Term, term: str, *, wanted: bool) -> Cases:
    """Test the datatype and, where SPARQL can tell, that the value is well-formed."""
    name = constant(graph, value, shape, "datatype")
    if name == f"<{RDF}langString>":
        return check(f'isLiteral({term}) && LANG({term}) != ""', wanted=wanted)
    formed = ""
    if name[1:-1] in _NUMBERS:
        formed = f" && isNumeric({term})"
    elif name == f"<{XSD}boolean>":
        formed = f" && ({term} = true || {term} = false)"
    elif name[1:-1] in _DATES:
        formed = f" && YEAR({term}) = YEAR({term})"
    return check(f"isLiteral({term}) && DATATYPE({term}) = {name}{formed}", wanted=wanted)


def _node_kind(graph: ShapesGraph, shape: Term, value: Term, term: str, *, wanted: bool) -> Cases:
    name = value.value.removeprefix(SH) if isinstance(value, NamedNode) else str(value)
    if name not in _KINDS:
        hint = f"It is one of {', '.join(f'sh:{kind}' for kind in _KINDS)}."
        raise graph.error(f"sh:nodeKind of {graph.called(shape)} is {name}", shape, hint=hint)
    return check(" || ".join(f"{function}({term})" for function in _KINDS[name]), wanted=wanted, safe=True)


def _compared(operator: str, name: str) -> Callable[..., Cases]:
    def read(graph: ShapesGraph, shape: Term, value: Term, term: str, *, wanted: bool) -> Cases:
        return check(f"{term} {operator} {constant(graph, value, shape, name)}", wanted=wanted)

    return read


def _length(operator: str, name: str) -> Callable[..., Cases]:
    def read(graph: ShapesGraph, shape: Term, value: Term, term: str, *, wanted: bool) -> Cases:
        length = whole_number(graph, shape, name, value)
        return check(f"!isBlank({term}) && STRLEN(STR({term})) {operator} {length}", wanted=wanted)

    return read


def _pattern(graph: ShapesGraph, shape: Term, value: Term, term: str, *, wanted: bool) -> Cases:
    flags = graph.one(shape, "flags")
    if not isinstance(value, Literal) or not isinstance(flags, Literal | None):
        raise graph.error(
            f"sh:pattern and sh:flags of {graph.called(shape)} are strings", shape, hint="Put them in quotes."
        )
    arguments = ", ".join(str(Literal(one.value)) for one in (value, flags) if one is not None)
    return check(f"!isBlank({term}) && REGEX(STR({term}), {arguments})", wanted=wanted)


def _languages(graph: ShapesGraph, shape: Term, value: Term, term: str, *, wanted: bool) -> Cases:
    tags = [tag.value for tag in graph.members(value, shape) if isinstance(tag, Literal)]
    matches = " || ".join(f"LANGMATCHES(LANG({term}), {Literal(tag)})" for tag in tags) or "false"
    return check(f"isLiteral({term}) && ({matches})", wanted=wanted)


def _in(graph: ShapesGraph, shape: Term, value: Term, term: str, *, wanted: bool) -> Cases:
    """Test that a term is one of some constants: the term itself, and not its value."""
    members = [constant(graph, member, shape, "in") for member in graph.members(value, shape)]
    names = [member for member in members if member.startswith("<")]
    others = [f"sameTerm({term}, {member})" for member in members if not member.startswith("<")]
    listed = [f"{term} IN ({', '.join(names)})"] if names else []
    return check(" || ".join([*listed, *others]) or "false", wanted=wanted, safe=True)


VALUE_TESTS: Final[Mapping[NamedNode, Callable[..., Cases]]] = {
    sh("class"): _class,
    sh("datatype"): _datatype,
    sh("nodeKind"): _node_kind,
    sh("minExclusive"): _compared(">", "minExclusive"),
    sh("minInclusive"): _compared(">=", "minInclusive"),
    sh("maxExclusive"): _compared("<", "maxExclusive"),
    sh("maxInclusive"): _compared("<=", "maxInclusive"),
    sh("minLength"): _length(">=", "minLength"),
    sh("maxLength"): _length("<=", "maxLength"),
    sh("pattern"): _pattern,
    sh("languageIn"): _languages,
    sh("in"): _in,
}
"""Constraint to its test: graph, shape, value of the constraint and term to cases."""
