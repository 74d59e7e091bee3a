"""Rules over a schema, such as those of OWL 2 RL, cut to the schema of the store.

A rule like `prp-spo1` (`?x ?q ?y` from `?p rdfs:subPropertyOf ?q . ?x ?p ?y`) reads and writes any predicate, so that
it makes one cycle of all other rules: nothing could be stratified any more, and all data would have to be read. For
the few axioms that a store holds it is the same as one plain rule for each, `?x rnkg:needs ?y` from
`?x rnkg:subscribes ?y`. So atoms about the schema are solved once, and the rules that are
left name the predicates they read and write.

It is exact as long as no rule derives schema from data; where one does, rules are left as they are.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace
from itertools import count
from typing import Any, Final, TypeGuard

from pyoxigraph import BlankNode, NamedNode, Quad, Store, Triple

from kg.rules import form
from kg.rules.files import RuleSet
from kg.rules.sparql import construct, select
from kg.syntax.names import RDF_TYPE

_OWL: Final = "http://www.w3.org/2002/07/owl#"
_RDFS: Final = "http://www.w3.org/2000/01/rdf-schema#"
SCHEMA_PREDICATES: Final = frozenset(
    NamedNode(iri)
    for iri in (
        *(_RDFS + name for name in ("subClassOf", "subPropertyOf", "domain", "range")),
        *(_OWL + name for name in ("equivalentClass", "equivalentProperty", "inverseOf", "disjointWith")),
        *(_OWL + name for name in ("propertyDisjointWith", "complementOf", "onProperty", "onClass", "hasValue")),
        *(_OWL + name for name in ("someValuesFrom", "allValuesFrom", "maxCardinality", "maxQualifiedCardinality")),
        *(_OWL + name for name in ("unionOf", "intersectionOf", "oneOf", "propertyChainAxiom", "hasKey", "members")),
    )
)
"""What relates classes and properties to each other (OWL 2 Mapping to RDF Graphs, section 2)."""

SCHEMA_CLASSES: Final = frozenset(
    NamedNode(iri)
    for iri in (
        *(_RDFS + name for name in ("Class", "Datatype")),
        *(_OWL + name for name in ("Class", "Restriction", "AllDisjointClasses", "AllDisjointProperties")),
        *(_OWL + name for name in ("AllDifferent", "ObjectProperty", "DatatypeProperty", "AnnotationProperty")),
        *(_OWL + name for name in ("SymmetricProperty", "AsymmetricProperty", "TransitiveProperty")),
        *(_OWL + name for name in ("FunctionalProperty", "InverseFunctionalProperty", "IrreflexiveProperty")),
    )
)
"""What classes, properties and axioms are members of."""


def is_schema(predicate: form.Pattern, value: form.Pattern) -> bool:
    """Return whether a triple with these is about the schema: an axiom, or a thing being a class, a property, ..."""
    if predicate == RDF_TYPE:
        return value in SCHEMA_CLASSES
    return predicate in SCHEMA_PREDICATES


def schema_query() -> str:
    """Return the CONSTRUCT query for the schema of a store: all triples for which `is_schema` holds."""
    return f"CONSTRUCT {{ ?s ?p ?o }} WHERE {schema_pattern()}"


def schema_pattern() -> str:
    """Return the group of SPARQL that binds ?s, ?p and ?o to the triples for which `is_schema` holds."""
    predicates = [f"{{ ?s {one} ?o BIND({one} AS ?p) }}" for one in sorted(map(str, SCHEMA_PREDICATES))]
    classes = [
        f"{{ ?s {RDF_TYPE} {one} BIND({RDF_TYPE} AS ?p) BIND({one} AS ?o) }}"
        for one in sorted(map(str, SCHEMA_CLASSES))
    ]
    # With VALUES the engine reads all triples of a graph: 3 s for a million, and 15 ms this way.
    return f"{{ {' UNION '.join([*predicates, *classes])} }}"


def specialise(rules: Iterable[form.Rule], schema: Iterable[Triple]) -> tuple[form.Rule, ...]:
    """Return the rules with those about any schema replaced by their instances for `schema`, in order.

    `schema` are the triples of the store for which `is_schema` holds; others do no harm. The rules of one name are
    numbered again. Rules are returned as they are where one of them may derive schema from data.
    """
    given = tuple(rules)
    hidden = _hidden(given)
    about_schema = [rule for rule in given if _about_schema(rule, hidden)]
    waiting = [rule for rule in given if not _about_schema(rule, hidden)]
    stated, closed = Store(), Store()
    stated.extend(map(_quad, schema))
    closed.extend(stated)
    _close(closed, about_schema)
    instances = [instance for rule in waiting for instance in _instances(rule, stated, closed, hidden)]
    if any(map(_may_write_schema, instances)):
        return given
    parts: defaultdict[str, Iterator[int]] = defaultdict(lambda: count(1))
    ordered = sorted([*about_schema, *instances], key=lambda rule: rule.name)
    return tuple(replace(rule, part=next(parts[rule.name])) for rule in ordered)


def specialised(rule_set: RuleSet, schema: Iterable[Triple]) -> RuleSet:
    """Return a set of rules in which each file has the rules that `specialise` makes of its own."""
    instances = specialise(rule_set.rules, schema)
    if instances == rule_set.rules:
        return rule_set
    by_name: defaultdict[str, list[form.Rule]] = defaultdict(list)
    for rule in instances:
        by_name[rule.name].append(rule)
    return RuleSet(tuple(replace(file, rules=tuple(by_name[file.name])) for file in rule_set.files))


def _hidden(rules: Sequence[form.Rule]) -> frozenset[NamedNode]:
    """Return the auxiliary predicates that nothing but schema is in: paths such as `rdfs:subClassOf+`."""
    hidden = {atom.predicate for rule in rules for atom in rule.head if form.is_auxiliary(atom.predicate)}
    before = -1
    while before != len(hidden):
        before = len(hidden)
        for rule in rules:
            if not all(_is_axiom(each, hidden) or isinstance(each, form.Filter) for each in rule.body):
                hidden -= {atom.predicate for atom in rule.head if isinstance(atom.predicate, NamedNode)}
    return frozenset(hidden)


def _about_schema(rule: form.Rule, hidden: AbstractSet[NamedNode]) -> bool:
    """Return whether a rule derives schema from nothing but schema."""
    axioms = (_is_axiom(each, hidden) or isinstance(each, form.Filter) for each in rule.body)
    return all(_is_axiom(atom, hidden) for atom in rule.head) and all(axioms)


def _may_write_schema(rule: form.Rule) -> bool:
    """Return whether a triple that a rule derives can be about the schema."""
    harmless = set(_never_schema(rule.body))
    for atom in rule.head:
        open_class = (
            atom.predicate == RDF_TYPE and isinstance(atom.object, form.Variable) and atom.object not in harmless
        )
        if isinstance(atom.predicate, form.Variable) or open_class or is_schema(atom.predicate, atom.object):
            return True
    return False


def _never_schema(body: Sequence[form.Element]) -> Iterator[form.Variable]:
    """Yield the variables whose values are listed, none of them a class that schema is made of."""
    for element in body:
        if isinstance(element, form.Values):
            columns = zip(*element.rows, strict=True)
            yield from (
                name for name, terms in zip(element.variables, columns, strict=False) if not SCHEMA_CLASSES & {*terms}
            )


def _close(store: Store, rules: Sequence[form.Rule]) -> None:
    """Add what rules about the schema derive from it."""
    queries = [construct(rule) for rule in rules]
    before = -1
    while before != len(store):
        before = len(store)
        for query in queries:
            derived: Any = store.query(query)  # a CONSTRUCT gives triples
            store.extend([_quad(triple) for triple in derived])


def _quad(triple: Triple) -> Quad:
    return Quad(triple.subject, triple.predicate, triple.object)


def _instances(rule: form.Rule, stated: Store, closed: Store, hidden: AbstractSet[NamedNode]) -> Iterator[form.Rule]:
    """Yield a rule for each way in which its atoms about the schema hold; the rule itself where it need not be cut."""
    axioms: tuple[form.Atom, ...] = tuple(element for element in rule.body if _is_axiom(element, hidden))
    bound = form.bound_in(axioms)
    asserted = {axiom.asserted for axiom in axioms}
    if len(asserted) != 1 or bound.isdisjoint(form.names_in((*rule.head, *rule.body))):
        yield rule
        return
    schema: tuple[form.Element, ...] = (
        *axioms,
        *(each for each in rule.body if isinstance(each, form.Filter) and form.mentions(each) <= bound),
    )
    rest = tuple(element for element in rule.body if element not in schema)
    variables = sorted(bound, key=str)
    rows = (stated if asserted == {True} else closed).query(select(schema, variables))
    solutions = [dict(zip(variables, row, strict=True)) for row in rows]  # type: ignore[union-attr]  # rows
    for bindings in sorted(solutions, key=lambda row: [str(row[variable]) for variable in variables]):
        instance = _instance(rule, rest, bindings)
        if not set(instance.head) <= {element for element in instance.body if isinstance(element, form.Atom)}:
            yield instance


def _is_axiom(element: form.Element, hidden: AbstractSet[NamedNode]) -> TypeGuard[form.Atom]:
    """Return whether an element is about the schema; `hidden` are the auxiliary predicates that are."""
    return isinstance(element, form.Atom) and (
        element.predicate in hidden or is_schema(element.predicate, element.object)
    )


def _instance(rule: form.Rule, rest: Sequence[form.Element], bindings: Mapping[form.Variable, form.Term]) -> form.Rule:
    """Return a rule with variables replaced by terms in its atoms, and bound by a row where terms are not allowed."""
    written = {variable: value for variable, value in bindings.items() if not isinstance(value, BlankNode)}
    head = tuple(atom.replaced(written) for atom in rule.head)
    body = form.filled(rest, written)
    left = {variable for atom in head for part in atom.positions for variable in form.variables_of(part)}
    needed = sorted(left.union(*map(form.mentions, body)) & bindings.keys(), key=str)
    row = (form.Values(tuple(needed), (tuple(bindings[variable] for variable in needed),)),) if needed else ()
    return replace(rule, head=head, body=(*row, *body))
