"""Shapes graphs and data for comparison with another implementation, as hypothesis strategies of Turtle.

Shapes have different orders, which fixes the order of evaluation. A rule of shape n derives `ex:e{n}` (with names as
values), `ex:v{n}` (any values) or the type `ex:T{n}`; conditions read derivations of earlier shapes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hypothesis import strategies as st

if TYPE_CHECKING:
    from hypothesis.strategies import SearchStrategy

__all__ = ["data", "shapes_graphs"]

PREFIXES = """@prefix ex: <http://example.org/> .
@prefix sh: <http://www.w3.org/ns/shacl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
"""
FUNCTION = """ex: sh:declare [ sh:prefix "ex" ; sh:namespace "http://example.org/" ] .
ex:join a sh:SPARQLFunction ;
    sh:parameter [ sh:path ex:one ] , [ sh:path ex:two ] ;
    sh:select "SELECT ?result WHERE { BIND(CONCAT(STR($one), STR($two)) AS ?result) }" .
"""
RDF_TYPE = "http://www.w3.org/1999/02/22-rdf-syntax-ns#type"
DERIVED = "ex:e1 ex:e2 ex:e3 ex:v1 ex:v2 ex:v3"
NODES = [f"ex:n{number}" for number in range(5)]
LITERALS = ["1", "2", "30", '"x"', '"yes"', '"yes"@en', '"ja"@de', '"da"@ru']
CLASSES = ["ex:A", "ex:B", "ex:C"]
LINKS = ["ex:p0", "ex:p1"]
NUMBERS = ["ex:i0", "ex:i1"]

one_of = st.sampled_from


def data() -> SearchStrategy[str]:
    """Draw data as Turtle: links between a few nodes, literals, types and a class hierarchy."""
    link = st.builds("{} {} {} .".format, one_of(NODES), one_of(LINKS), one_of(NODES))
    literal = st.builds("{} ex:l0 {} .".format, one_of(NODES), one_of(LITERALS))
    number = st.builds("{} {} {} .".format, one_of(NODES), one_of(NUMBERS), one_of(LITERALS[:3]))
    kind = st.builds("{} a {} .".format, one_of(NODES), one_of(CLASSES))
    below = st.builds("{} rdfs:subClassOf {} .".format, one_of(CLASSES), one_of(CLASSES))
    lines = st.lists(st.one_of(link, link, literal, number, kind, kind, below), min_size=6, max_size=18)
    return lines.map(lambda found: PREFIXES + "\n".join(found))


def _paths(names: list[str]) -> SearchStrategy[str]:
    name = one_of(names)
    step = st.one_of(name, name, name.map("[ sh:inversePath {} ]".format))
    pairs = st.lists(step, min_size=2, max_size=3).map(" ".join)
    return st.one_of(
        step,
        step,
        pairs.map("( {} )".format),
        pairs.map("[ sh:alternativePath ( {} ) ]".format),
        step.map("[ sh:zeroOrMorePath {} ]".format),
        step.map("[ sh:oneOrMorePath {} ]".format),
        step.map("[ sh:zeroOrOnePath {} ]".format),
    )


def _links(level: int) -> list[str]:
    return [*LINKS, *(f"ex:e{number}" for number in range(1, level + 1))]


def _values(level: int) -> list[str]:
    return ["ex:l0", *NUMBERS, *(f"ex:v{number}" for number in range(1, level + 1))]


def _tests(level: int, *, classes: bool) -> SearchStrategy[str]:
    """Draw constraints on value nodes."""
    found = [
        one_of(["IRI", "Literal", "BlankNode", "IRIOrLiteral", "BlankNodeOrIRI"]).map("sh:nodeKind sh:{}".format),
        one_of(["integer", "string"]).map("sh:datatype xsd:{}".format),
        st.builds(
            "sh:{} {}".format, one_of(["minInclusive", "minExclusive", "maxInclusive", "maxExclusive"]), one_of("12")
        ),
        st.builds("sh:{} {}".format, one_of(["minLength", "maxLength"]), st.integers(0, 20)),
        one_of(['"n[0-2]$"', '"^[A-Y]" ; sh:flags "i"']).map("sh:pattern {}".format),
        one_of(['"en"', '"de" "en"']).map("sh:languageIn ( {} )".format),
        st.lists(one_of([*NODES, *LITERALS]), min_size=1, max_size=4).map(lambda all_: f"sh:in ( {' '.join(all_)} )"),
        one_of(NODES).map("sh:hasValue {}".format),
        one_of(_links(level)).map("sh:disjoint {}".format),
        one_of(_links(level)).map("sh:equals {}".format),
    ]
    if classes:
        found.append(one_of(CLASSES).map("sh:class {}".format))
    return st.one_of(found)


def _property(level: int, *, classes: bool) -> SearchStrategy[str]:
    counts = st.builds("sh:{} {}".format, one_of(["minCount", "maxCount"]), st.integers(0, 3))
    qualified = st.builds(
        "sh:qualifiedValueShape [ {} ] ; sh:{} {}".format,
        _tests(level, classes=classes),
        one_of(["qualifiedMinCount", "qualifiedMaxCount"]),
        st.integers(0, 2),
    )
    less = st.builds("sh:{} {}".format, one_of(["lessThan", "lessThanOrEquals"]), one_of(NUMBERS))
    numeric = st.builds("sh:path {} ; {}".format, one_of(NUMBERS), less)
    constraint = st.one_of(counts, counts, qualified, st.just("sh:uniqueLang true"), _tests(level, classes=classes))
    path = st.one_of(_paths(_links(level)), one_of(_values(level)))
    return st.one_of(st.builds("sh:path {} ; {}".format, path, constraint), numeric)


def _shape(level: int, *, classes: bool, depth: int = 2) -> SearchStrategy[str]:
    """Draw the content of a shape."""
    closed = one_of(
        [f"sh:closed true ; sh:ignoredProperties ( ex:p0 ex:l0 <{RDF_TYPE}> {DERIVED} )", "sh:closed false"]
    )
    leaf = st.one_of(
        _property(level, classes=classes).map("sh:property [ {} ]".format), _tests(level, classes=classes), closed
    )
    if depth == 0:
        return leaf
    inner = _shape(level, classes=classes, depth=depth - 1).map("[ {} ]".format)
    several = st.lists(inner, min_size=1, max_size=3).map(" ".join)
    nested = st.builds("sh:property [ sh:path {} ; sh:node {} ]".format, _paths(_links(level)), inner)
    junction = st.builds("sh:{} ( {} )".format, one_of(["and", "or", "xone"]), several)
    return st.one_of(leaf, leaf, leaf, inner.map("sh:not {}".format), inner.map("sh:node {}".format), junction, nested)


def _expressions(names: list[str], depth: int = 1) -> SearchStrategy[str]:
    leaf = st.one_of(st.just("sh:this"), one_of(NODES), _paths(names).map("[ sh:path {} ]".format))
    if depth == 0:
        return leaf
    inner = st.lists(_expressions(names, depth - 1), min_size=2, max_size=3)
    return st.one_of(leaf, leaf, inner.map(lambda found: f"[ sh:union ( {' '.join(found)} ) ]"))


def _triple_rules(level: int, *, types: bool) -> SearchStrategy[str]:
    link = st.builds(
        f"a sh:TripleRule ; sh:subject {{}} ; sh:predicate ex:e{level} ; sh:object {{}}".format,
        _expressions(_links(level)),
        _expressions(_links(level)),
    )
    both = [*_links(level - 1), *_values(level - 1)]
    call = st.builds("[ ex:join ( {} {} ) ]".format, *[_expressions(both, 0)] * 2)
    value = st.builds(
        f"a sh:TripleRule ; sh:subject {{}} ; sh:predicate ex:v{level} ; sh:object {{}}".format,
        _expressions(_links(level)),
        st.one_of(_expressions(_values(level)), one_of(LITERALS), call),
    )
    kind = _expressions(_links(level)).map(
        f"a sh:TripleRule ; sh:subject {{}} ; sh:predicate <{RDF_TYPE}> ; sh:object ex:T{level}".format
    )
    return st.one_of(link, value, kind) if types else st.one_of(link, value)


_BODIES = [
    "$this {0} ?y",
    "?y {0} $this",
    "$this {0} ?x . ?x {1} ?y",
    "$this {0} ?y . FILTER($this != ?y)",
    "{{ $this {0} ?y }} UNION {{ ?y {1} $this FILTER(?y != $this) }}",
    "$this {0} ?y . FILTER NOT EXISTS {{ $this {2} ?y }}",
    "$this {0}/{1} ?y",
    "?x {0} ?y . {{ SELECT $this ?x WHERE {{ ?x {1} $this }} }}",
    "$this {0} ?y OPTIONAL {{ ?y {1} ?z }} FILTER(!BOUND(?z) || ?z != $this)",
]


def _sparql_rules(level: int) -> SearchStrategy[str]:
    name, base = one_of(_links(level)), one_of(LINKS)
    body = st.builds(lambda form, *names: form.format(*names), one_of(_BODIES), name, base, base)
    start = f'a sh:SPARQLRule ; sh:prefixes ex: ; sh:construct "CONSTRUCT {{ $this ex:e{level} ?y }} WHERE'
    return body.map(lambda pattern: f'{start} {{ {pattern} }}"')


def _rule(level: int, *, types: bool) -> SearchStrategy[str]:
    condition = _shape(level - 1, classes=not types).map(" ; sh:condition [ a sh:NodeShape ; {} ]".format)
    conditions = st.lists(condition, max_size=2).map("".join)
    extra = one_of(["", "", "", " ; sh:deactivated true", " ; sh:order 1", " ; sh:order -0.5"])
    rule = st.one_of(_triple_rules(level, types=types), _sparql_rules(level))
    return st.builds("sh:rule [ {}{}{} ]".format, rule, conditions, extra)


def _targets(level: int) -> SearchStrategy[str]:
    return st.one_of(
        one_of(NODES).map("sh:targetNode {}".format),
        one_of(CLASSES).map("sh:targetClass {}".format),
        one_of(_links(level)).map("sh:targetSubjectsOf {}".format),
        one_of(_links(level)).map("sh:targetObjectsOf {}".format),
    )


def _node_shape(level: int, *, types: bool) -> SearchStrategy[str]:
    parts = st.tuples(
        st.lists(_targets(level), min_size=1, max_size=2), st.lists(_rule(level, types=types), min_size=1, max_size=2)
    )
    return parts.map(
        lambda found: (
            f"ex:S{level} a sh:NodeShape ; sh:order {level} ;\n    " + " ;\n    ".join([*found[0], *found[1]]) + " ."
        )
    )


@st.composite
def shapes_graphs(draw: st.DrawFn) -> str:
    """Draw a shapes graph of one to three shapes with rules, as Turtle."""
    types = draw(st.booleans())
    levels = draw(st.integers(1, 3))
    found = [draw(_node_shape(level, types=types)) for level in range(1, levels + 1)]
    return "\n".join([PREFIXES + FUNCTION, *found])
