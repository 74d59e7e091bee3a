"""Terms as people type them: IRIs, prefixed names, literals, or what a thing is called in the store."""

from __future__ import annotations

import re
from itertools import product
from typing import TYPE_CHECKING, Any, Final, Protocol, TypeAlias, cast

from pyoxigraph import Literal, NamedNode, RdfFormat, Triple, parse

from kg.errors import UnknownNameError, UsageError
from kg.similar import did_you_mean
from kg.syntax.names import PREFIXES, shorten

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pyoxigraph import BlankNode, QueryBoolean, QuerySolutions, QueryTriples

    _Term: TypeAlias = NamedNode | BlankNode | Literal

__all__ = ["Askable", "facts", "terms"]

_PREFIXED: Final = re.compile(r"([A-Za-z][\w.-]*):([\w.-]*)")
_WRITTEN: Final = re.compile(r"""["'].*|[+-]?\d[\d.eE+-]*|true|false|<<.*""", re.DOTALL)
_TYPE: Final = NamedNode(PREFIXES["rdf"] + "type")
_CALLED: Final = "SELECT DISTINCT ?t WHERE { VALUES ?name { %s } ?t rdfs:label|rnkg:name ?name } ORDER BY ?t"
"""What has a name, exactly, or with the leading slash of ROS names."""
_ENDING: Final = """SELECT DISTINCT ?t WHERE {
  ?t rdfs:label ?label FILTER(ISIRI(?t) && (STRENDS(STR(?t), %s) || STRENDS(STR(?t), %s)))
} ORDER BY ?t"""
_NAMES: Final = "SELECT DISTINCT ?name WHERE { ?t rdfs:label ?name }"
_PROPERTIES: Final = "SELECT DISTINCT ?name WHERE { ?s ?name ?o }"
_ALL_PROPERTIES: Final = "`kg query 'SELECT DISTINCT ?p { ?s ?p ?o }'` lists the properties that the store has."


class Askable(Protocol):
    """The part of a snapshot that names are looked up in."""

    def query(
        self, text: str, *, prefixes: Mapping[str, str] | None = None
    ) -> QuerySolutions | QueryBoolean | QueryTriples:
        """Run a query over the union of all graphs."""
        ...


def facts(
    snapshot: Askable, subject: str, predicate: str, value: str, *, prefixes: Mapping[str, str] = PREFIXES
) -> tuple[list[Triple], bool]:
    """Return the facts that three typed words may mean, and whether the store holds them.

    A name that several things have means the ones of which the store holds the fact, and of these the ones that
    have exactly this name before those whose name only ends in it; where it holds none, those that the property is used
    with.

    Raises:
        UnknownNameError: KG001 with suggestions for a word that names nothing.
        UsageError: KG003 when the store holds no such fact and the words name several things.
    """
    predicates = terms(snapshot, predicate, property_=True, prefixes=prefixes)
    # What has the names is found at once; to find what only ends in them, all that is named has to be read.
    for having in (True, False):
        subjects = terms(snapshot, subject, exact=having, prefixes=prefixes)
        values = terms(snapshot, value, exact=having, prefixes=prefixes)
        every = _triples(subjects, predicates, values)
        held = [fact for fact in every if snapshot.query(f"ASK {{ {fact.subject} {fact.predicate} {fact.object} }}")]
        if held:
            break
    if held:
        exact = {*_named(snapshot, subject), *_named(snapshot, value)} if len(held) > 1 else set()
        ranks = [(fact.subject not in exact) + (fact.object not in exact) for fact in held]
        return [fact for fact, rank in zip(held, ranks, strict=True) if rank == min(ranks)], True
    if len(predicates) == 1 and max(len(subjects), len(values)) > 1:
        _check_used(snapshot, predicates[0], prefixes)
        subjects = _fitting(snapshot, subjects, f"{{}} {predicates[0]} ?y", f"?x {predicates[0]} ?y", "?x")
        values = _fitting(snapshot, values, f"?x {predicates[0]} {{}}", f"?x {predicates[0]} ?y", "?y")
    subjects, values = _exactly(snapshot, subject, subjects), _exactly(snapshot, value, values)
    for word, found in ((subject, subjects), (predicate, predicates), (value, values)):
        if len(found) > 1:
            ways = "\n".join(str(term) for term in found)
            raise UsageError("KG003", f"{len(found)} things are called `{word}`; choose one", hint=ways)
    return _triples(subjects, predicates, values), False


def _exactly(snapshot: Askable, word: str, found: list[_Term]) -> list[_Term]:
    """Return those of several things that have exactly this name, or all where none has."""
    named = _named(snapshot, word) if len(found) > 1 else []
    return [term for term in found if term in named] or found


def _check_used(snapshot: Askable, predicate: _Term, prefixes: Mapping[str, str]) -> None:
    """Raise KG001 for a property that nothing has: it cannot tell things of one name apart, and is often misspelt."""
    if isinstance(predicate, NamedNode) and not snapshot.query(f"ASK {{ ?s {predicate} ?o }}"):
        rows: Any = snapshot.query(_PROPERTIES)
        known = [shorten(row[0].value, prefixes) for row in rows]
        short = shorten(predicate.value, prefixes)
        raise UnknownNameError("KG001", f"nothing has the property {short}", hint=did_you_mean(short, known))


def _triples(subjects: list[_Term], predicates: list[_Term], values: list[_Term]) -> list[Triple]:
    return [
        Triple(one, two, three)
        for one, two, three in product(subjects, predicates, values)
        if isinstance(one, NamedNode) and isinstance(two, NamedNode)
    ]


def _fitting(snapshot: Askable, found: list[_Term], used: str, pattern: str, place: str) -> list[_Term]:
    """Return those of several things that stand in this place of the property, or else are of a kind that does."""
    for test in (f"{used}", f"{pattern} . {place} a ?kind . {{}} a ?kind"):
        fitting = [term for term in found if snapshot.query(f"ASK {{ {test.format(term)} }}")]
        if len(found) > 1 and fitting:
            return fitting
    return found


def terms(
    snapshot: Askable,
    word: str,
    *,
    property_: bool = False,
    exact: bool = False,
    prefixes: Mapping[str, str] = PREFIXES,
) -> list[_Term]:
    """Return the terms that a word may mean: `<iri>`, `ros:Node`, `"text"`, `5`, `a`, or a name in the store.

    With `exact` a name means what has it, which may be nothing, and not what only ends in it.

    Raises:
        UnknownNameError: KG001 with suggestions when it means nothing.
    """
    if property_ and word == "a":
        return [_TYPE]
    if word.startswith("<") and word.endswith(">"):
        return [NamedNode(word[1:-1])]
    prefixed = _PREFIXED.fullmatch(word)
    if prefixed and prefixed[1] in prefixes:
        return [NamedNode(prefixes[prefixed[1]] + prefixed[2])]
    if "://" in word:
        return [NamedNode(word)]
    if prefixed and property_:
        hint = did_you_mean(prefixed[1], prefixes) or "Write the whole IRI, in angle brackets."
        raise UnknownNameError("KG001", f"`{prefixed[1]}:` is not a known prefix", hint=hint)
    if _WRITTEN.fullmatch(word):
        return [_literal(word)]
    if property_:
        return list(_property(snapshot, word))
    return list(_having(snapshot, word) if exact else _called(snapshot, word))


def _literal(word: str) -> Literal:
    prefixes = "".join(f"@prefix {name}: <{namespace}> .\n" for name, namespace in PREFIXES.items())
    try:
        found = next(iter(parse(f"{prefixes}<x:s> <x:p> {word} .", RdfFormat.TURTLE))).object
    except SyntaxError as error:
        raise UsageError("KG003", f"`{word}` is not a literal as Turtle writes it") from error
    return cast("Literal", found)


def _property(snapshot: Askable, word: str) -> list[NamedNode]:
    """Return the properties that end in `word`: those of known prefixes, or else of all that the store has."""
    if re.fullmatch(r"[\w.-]+", word):
        prefixed = [NamedNode(namespace + word) for namespace in PREFIXES.values()]
        if used := [iri for iri in prefixed if snapshot.query(f"ASK {{ ?s {iri} ?o }}")]:
            return used
    rows: Any = snapshot.query(_PROPERTIES)
    known = [row[0] for row in rows]
    found = [iri for iri in known if re.split(r"[/#]", iri.value)[-1] == word]
    if not found:
        hint = did_you_mean(word, [shorten(iri.value) for iri in known]) or _ALL_PROPERTIES
        raise UnknownNameError("KG001", f"unknown property `{word}`", hint=hint)
    return found


def _named(snapshot: Askable, word: str) -> list[NamedNode]:
    """Return what has a name, exactly."""
    rows: Any = snapshot.query(_CALLED % f"{Literal(word)} {Literal(word, language='en')}", prefixes=PREFIXES)
    return [row[0] for row in rows if isinstance(row[0], NamedNode)]


def _having(snapshot: Askable, word: str) -> list[NamedNode]:
    """Return what is called `word`; the leading slash of a ROS name may be left out."""
    names = f"{Literal(word)} {Literal('/' + word)} {Literal(word, language='en')}"
    rows: Any = snapshot.query(_CALLED % names, prefixes=PREFIXES)
    return [row[0] for row in rows if isinstance(row[0], NamedNode)]


def _called(snapshot: Askable, word: str) -> list[NamedNode]:
    """Return what is called `word`, or whose IRI ends in it."""
    found = _having(snapshot, word)
    ended: Any = snapshot.query(_ENDING % (Literal("#" + word), Literal("/" + word)), prefixes=PREFIXES)
    found += [row[0] for row in ended if row[0] not in found]
    if not found:
        known: Any = snapshot.query(_NAMES, prefixes=PREFIXES)
        hint = did_you_mean(word, [row[0].value for row in known])
        raise UnknownNameError("KG001", f"nothing in the store is called `{word}`", hint=hint)
    return found
