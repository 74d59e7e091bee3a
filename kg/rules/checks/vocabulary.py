"""Checks of names: unknown terms (KG211), derived ones that nothing reads (KG215), and variables (KG212, KG217).

KG212 is about parts of a body that share no variable, KG217 about variables that are in one place only.

The terms of RDF, RDFS and OWL: closed vocabularies, so an unknown name is misspelt.

Sources: RDF 1.2 Schema, sections 2 to 5; OWL 2 Mapping to RDF Graphs, tables 1 and 2; RDF 1.2 Concepts for rdf:reifies
and the types of strings.
"""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode

from kg.errors import Fix
from kg.rules.checks.finding import Context, Finding, at_offset, at_rule, names, place_of_name, variables
from kg.rules.dependencies import depends, reads
from kg.rules.form import AUXILIARY, Atom, Exists, Rule, Variable, atoms_of, binds, is_auxiliary, mentions
from kg.similar import misspelt, similar, suggest
from kg.syntax.names import PREFIXES, RDF_TYPE, shorten

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.rules.files import RuleFile

_ELSEWHERE: Final = ("xsd", "sh", "skos", "prov", "dcterms", "schema")
_BUILT_IN: Final = tuple(PREFIXES[name] for name in _ELSEWHERE)
"""Vocabularies that everyone uses and whose ontologies the store does not hold."""

_TERMS: Final = {
    "rdf": """
        type subject predicate object first rest nil value reifies language direction
        Property Statement List Bag Seq Alt XMLLiteral HTML JSON langString dirLangString PlainLiteral CompoundLiteral
        langRange""",
    "rdfs": """
        label comment seeAlso isDefinedBy member domain range subClassOf subPropertyOf
        Class Resource Literal Datatype Container ContainerMembershipProperty Proposition""",
    "owl": """
        AllDifferent AllDisjointClasses AllDisjointProperties Annotation AnnotationProperty AsymmetricProperty Axiom
        Class DataRange DatatypeProperty DeprecatedClass DeprecatedProperty FunctionalProperty
        InverseFunctionalProperty IrreflexiveProperty NamedIndividual NegativePropertyAssertion Nothing ObjectProperty
        Ontology OntologyProperty ReflexiveProperty Restriction SymmetricProperty Thing TransitiveProperty
        allValuesFrom annotatedProperty annotatedSource annotatedTarget assertionProperty backwardCompatibleWith
        bottomDataProperty bottomObjectProperty cardinality complementOf datatypeComplementOf deprecated differentFrom
        disjointUnionOf disjointWith distinctMembers equivalentClass equivalentProperty hasKey hasSelf hasValue imports
        incompatibleWith intersectionOf inverseOf maxCardinality maxQualifiedCardinality members minCardinality
        minQualifiedCardinality onClass onDataRange onDatatype onProperties onProperty oneOf priorVersion
        propertyChainAxiom propertyDisjointWith qualifiedCardinality rational real sameAs someValuesFrom
        sourceIndividual targetIndividual targetValue topDataProperty topObjectProperty unionOf versionIRI versionInfo
        withRestrictions""",
}
STANDARD: Final = {PREFIXES[prefix]: frozenset(names.split()) for prefix, names in _TERMS.items()}
"""Namespace to the local names of its terms."""

_NUMBERED: Final = re.compile(r"_[1-9][0-9]*")


def namespace_of(iri: str) -> str:
    """Return an IRI up to its last `#` or `/`."""
    return iri[: max(iri.rfind("#"), iri.rfind("/")) + 1]


def is_standard(iri: str) -> bool:
    """Return whether an IRI is a term of one of the three vocabularies, `rdf:_1` and so on among them."""
    namespace = namespace_of(iri)
    local = iri.removeprefix(namespace)
    numbered = namespace == PREFIXES["rdf"] and _NUMBERED.fullmatch(local) is not None
    return numbered or local in STANDARD.get(namespace, ())


_OTHERS: Final = (AUXILIARY, *STANDARD)
"""Namespaces of what only decomposition reads, and of what is read everywhere."""


def unknown_terms(file: RuleFile, context: Context) -> Iterator[Finding]:
    """Yield each class and property of a file that nothing defines, with the one that was probably meant."""
    heads = {iri for rule in context.rules.rules if rule.name != file.name for iri in _derived(rule)}
    own = {iri for rule in file.rules for iri in _derived(rule)}
    defined = context.terms | heads
    foreign = {namespace_of(iri) for iri in context.terms}
    read = {iri for rule in file.rules for atom, _ in atoms_of(rule.body) for iri, _ in _terms(atom)}
    wanted: dict[str, str] = {}
    for rule in file.rules:
        for atom in (*rule.head, *(atom for atom, _ in atoms_of(rule.body))):
            wanted |= {iri: "property" if is_property else "class" for iri, is_property in _terms(atom)}
    for iri, kind in wanted.items():
        namespace = namespace_of(iri)
        if namespace in STANDARD:
            if not is_standard(iri):
                terms = (namespace + name for name in STANDARD[namespace])
                yield _finding(file, iri, kind, f"unknown {kind} {shorten(iri)}", terms)
            continue
        if not context.terms or iri in defined or iri.startswith(_BUILT_IN):
            continue
        if iri in own and (iri in read or namespace not in foreign):
            continue  # a term that the rule brings along: it both writes and reads it, or has a namespace of its own
        message = f"no ontology defines the {kind} {shorten(iri)}, and the store does not have it"
        yield _finding(file, iri, kind, message, defined)


def _finding(file: RuleFile, iri: str, kind: str, message: str, defined: Iterable[str]) -> Finding:
    near = _suggestions(iri, kind, defined)
    hint = suggest(map(shorten, near)) or "Define it in an ontology, or correct the name."
    # Names in the strings of SHACL rules have no place of their own.
    named = any(term == iri for term, _ in names(file))
    fixes = tuple(Fix(shorten(each, file.prefixes)) for each in near) if named else ()
    return Finding("KG211", "warning", file.name, message, place_of_name(file, iri), hint, fixes=fixes)


def _suggestions(iri: str, kind: str, defined: Iterable[str]) -> list[str]:
    """Return similar terms: those of its kind, by the case of the first letter, come first."""
    namespace = namespace_of(iri)
    # Of terms of one name the one in the namespace that was written is meant.
    ordered = sorted(defined, key=lambda term: (namespace_of(term) == namespace, term))
    locals_ = {term.removeprefix(namespace_of(term)): term for term in ordered}
    alike = [name for name in locals_ if name[:1].isupper() == (kind == "class")]
    matches = similar(iri.removeprefix(namespace), alike)
    if matches:
        return [locals_[name] for name in matches]
    short = {shorten(term): term for term in ordered}
    return [short[each] for each in similar(shorten(iri), short)]


def _derived(rule: Rule) -> Iterator[str]:
    return (iri for atom in rule.head for iri, _ in _terms(atom))


def _terms(atom: Atom) -> Iterator[tuple[str, bool]]:
    """Yield the property of an atom, and the class if the atom is a type."""
    if isinstance(atom.predicate, NamedNode) and not is_auxiliary(atom.predicate):
        yield atom.predicate.value, True
        if atom.predicate == RDF_TYPE and isinstance(atom.object, NamedNode):
            yield atom.object.value, False


def head_never_read(file: RuleFile, context: Context) -> Iterator[Finding]:
    """Yield each property or class that a file derives and nothing else mentions; reports are read by people."""
    if file.documentation.severity:
        return
    reported: set[str] = set()
    for atom in (atom for rule in file.rules for atom in rule.head):
        what = atom.object if atom.predicate == RDF_TYPE else atom.predicate
        if not isinstance(what, NamedNode) or what.value in reported or what.value.startswith(_OTHERS):
            continue
        if what.value not in context.read and not _read_by_rules(atom, file, context):
            reported.add(what.value)
            message = f"nothing reads {shorten(what.value)}: no other rule, no stored query"
            hint = "Write a stored query that shows it, or leave it out."
            yield Finding("KG215", "note", file.name, message, place_of_name(file, what.value), hint)


def _read_by_rules(head: Atom, file: RuleFile, context: Context) -> bool:
    others = (rule for rule in context.cut or context.rules.rules if rule.name != file.name)
    read = (read.atom for rule in others for read in reads(rule))
    # An atom of variables alone reads all triples, as a copy under another name does.
    return any(depends(atom, head) for atom in read if not all(isinstance(one, Variable) for one in atom.positions))


def cartesian_product(file: RuleFile, _context: Context) -> Iterator[Finding]:
    """Yield one finding for a file in which a body falls into parts without a common variable."""
    for rule in file.rules:
        parts = _parts(rule)
        if len(parts) > 1:
            named = ({variable for variable in part if not variable.name.startswith(".")} or part for part in parts)
            shown = " and ".join(", ".join(sorted(map(str, part))) for part in named)
            message = f"nothing joins {shown}: every match of one goes with every match of the other"
            second = (each.place for each in rule.body if isinstance(each, Atom) and binds(each) & parts[1])
            hint = "Join them by a variable, or by a filter that compares them."
            yield Finding("KG212", "warning", file.name, message, next(second, None) or at_rule(file), hint)
            return


def _parts(rule: Rule) -> list[set[Variable]]:
    """Return the variables that atoms bind, in groups that some element of the body joins."""
    groups: list[set[Variable]] = []
    for element in rule.body:
        together = set(mentions(element) if isinstance(element, Exists) else mentions(element) | binds(element))
        if isinstance(element, Exists) or not together:
            continue
        joined = [group for group in groups if group & together]
        groups = [group for group in groups if not group & together]
        groups.append(together.union(*joined))
    return groups


def variable_used_once(file: RuleFile, _context: Context) -> Iterator[Finding]:
    """Yield each variable that occurs once in a file; a `_` before the name marks it as intended."""
    occurrences = list(variables(file))
    blank = {variable.name for variable in _replaceable(file)}
    uses = Counter(token.text[1:] for token in occurrences)
    for token in occurrences:
        sign, name = token.text[0], token.text[1:]
        if uses[name] == 1 and not name.startswith("_"):
            others = [other for other in uses if other != name]
            near = misspelt(name, others)
            intended = [f"{sign}_{name}", *["[]"] * (name in blank)]
            fixes = (*(Fix(f"{sign}{each}") for each in near), *map(Fix, intended))
            message = f"the variable ?{name} is used only here"
            advice = (
                f"Write `[]`, or ?_{name} if that is meant." if name in blank else f"Write ?_{name} if it is meant."
            )
            place, hint = at_offset(file, token.start), suggest(near) or advice
            yield Finding("KG217", "warning", file.name, message, place, hint, fixes=fixes)


def _replaceable(file: RuleFile) -> set[Variable]:
    """Return the variables that `[]` may replace: those that are only subjects or objects."""
    atoms = [atom for rule in file.rules for atom, _ in atoms_of(rule.body)]
    ends = {end for atom in atoms for end in (atom.subject, atom.object) if isinstance(end, Variable)}
    return ends - {atom.predicate for atom in atoms if isinstance(atom.predicate, Variable)}
