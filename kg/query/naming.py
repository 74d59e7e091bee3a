"""Resolve terms typed by users: IRIs, prefixed names, literals, and names in the store."""

from __future__ import annotations

import re
from itertools import product
from typing import TYPE_CHECKING, Any, Final, TypeAlias, cast

from pyoxigraph import (
    BlankNode,
    Literal,
    NamedNode,
    RdfFormat,
    Triple,
    parse,
)

from kg.errors import UnknownNameError, UsageError, choices
from kg.similar import did_you_mean
from kg.syntax.names import PREFIXES, RDF_TYPE, shorten

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kg.store.interface import Queryable

    _Term: TypeAlias = NamedNode | BlankNode | Literal

_PREFIXED: Final = re.compile(r"([A-Za-z][\w.-]*):([\w.-]*)")
_WRITTEN: Final = re.compile(r"""["'].*|[+-]?\d[\d.eE+-]*|true|false|<<.*""", re.DOTALL)
_CALLED: Final = "SELECT DISTINCT ?t WHERE { VALUES ?name { %s } ?t rdfs:label|rnkg:name ?name } ORDER BY ?t"
"""Things with exactly this name, or with the leading slash of ROS names."""
_ENDING: Final = """SELECT DISTINCT ?t WHERE {
  %s ?t rdfs:label ?label
  FILTER(STRENDS(STR(?t), %s) && ISIRI(?t) && (STRENDS(STR(?t), %s) || STRENDS(STR(?t), %s)))
} ORDER BY ?t"""
"""Things whose IRI ends in a name. The first filter excludes nearly all, as each filter decodes the IRI again."""
_PLACES: Final = (("?t {0} ?any", "?other {0} ?any"), ("?any {0} ?t", "?any {0} ?other"))
"""For the subject and the object of a property: what is used there, as `?t` and as `?other`."""
_KINDS: Final = "SELECT DISTINCT ?kind WHERE {{ {{ SELECT ?other WHERE {{ {0} }} {1} }} ?other a ?kind }}"
_SAMPLE: Final = "LIMIT 200"
_CHANNELS: Final = "SELECT DISTINCT ?channel { VALUES ?end { %s } ?end rnkg:connectsTo ?channel }"
"""What ends connect to, which have the names that the code gives: a topic for `~/odom` of a publisher."""
_JOINED: Final = ("?t {0} ?end VALUES ?end {{ {1} }}", "?end {0} ?t VALUES ?end {{ {1} }}")
"""The same: what has the property with one of some values at its other end."""
_NAMES: Final = "SELECT DISTINCT ?name WHERE { ?t rdfs:label ?name }"
_PROPERTIES: Final = "SELECT DISTINCT ?name WHERE { ?s ?name ?o }"
_ALL_PROPERTIES: Final = "`kg query 'SELECT DISTINCT ?p { ?s ?p ?o }'` lists the properties that the store has."


def facts(
    snapshot: Queryable, subject: str, predicate: str, value: str, *, prefixes: Mapping[str, str] = PREFIXES
) -> tuple[list[Triple], bool]:
    """Return the facts that three typed words may mean, and whether the store holds them.

    A name that several things have means the ones of which the store holds the fact, and of these the ones that
    have exactly this name before those whose name only ends in it; where it holds none, those that the property is used
    with. Of two names that things have, at least one means one of these. The name of an end in the code also means the
    topic, service or action that the end connects to.

    Raises:
        UnknownNameError: KG001 with suggestions for a word that names nothing.
        UsageError: KG003 when the store holds no such fact and the words name several things.
    """
    predicates = terms(snapshot, predicate, property_=True, prefixes=prefixes)
    words = (subject, value)
    subjects, values = ends = [terms(snapshot, word, among=None, prefixes=prefixes) for word in words]
    stored = _stored(snapshot, _triples(subjects, predicates, values))
    if not stored and values:
        listed = " ".join(str(one) for one in values if isinstance(one, NamedNode))
        channels: Any = snapshot.query(_CHANNELS % listed, prefixes=PREFIXES)
        stored = _stored(snapshot, _triples(subjects, predicates, [row[0] for row in channels]))
    if not stored and subjects and values:
        # At least one of two names that things have is meant as it is, so the store has few things to look at.
        ended = [
            terms(snapshot, word, among=_among(use, predicates, other), prefixes=prefixes)
            for word, use, other in zip(words, _JOINED, (values, subjects), strict=True)
        ]
        stored = _stored(snapshot, [*_triples(ended[0], predicates, values), *_triples(subjects, predicates, ended[1])])
    elif not stored:
        # Among things whose IRI only ends in the names, the property selects.
        subjects, values = ends = [
            terms(snapshot, word, among=_among(places[0], predicates), prefixes=prefixes)
            for word, places in zip(words, _PLACES, strict=True)
        ]
        stored = _stored(snapshot, _triples(subjects, predicates, values))
    if stored:
        exact = {*_named(snapshot, subject), *_named(snapshot, value)} if len(stored) > 1 else set()
        ranks = [(fact.subject not in exact) + (fact.object not in exact) for fact in stored]
        return [fact for fact, rank in zip(stored, ranks, strict=True) if rank == min(ranks)], True
    subjects, values = (
        _used_with(snapshot, word, terms_of_word, [place.format(predicates[0]) for place in places], prefixes)
        if len(predicates) == 1
        else terms(snapshot, word, prefixes=prefixes)
        for word, terms_of_word, places in zip(words, ends, _PLACES, strict=True)
    )
    if len(predicates) == 1 and max(len(subjects), len(values)) > 1:
        _check_used(snapshot, predicates[0], prefixes)
    subjects, values = _exactly(snapshot, subject, subjects), _exactly(snapshot, value, values)
    subjects, values = _in_same_launch(subjects, values), _in_same_launch(values, subjects)
    for word, terms_of_word in ((subject, subjects), (predicate, predicates), (value, values)):
        if len(terms_of_word) > 1:
            ways = choices([str(term) for term in terms_of_word])
            raise UsageError("KG003", f"{len(terms_of_word)} things are called `{word}`; choose one", hint=ways)
    return _triples(subjects, predicates, values), False


def _stored(snapshot: Queryable, facts: list[Triple]) -> list[Triple]:
    """Return those facts that the store holds, each once."""
    stored: set[Triple] = set()
    for predicate in dict.fromkeys(fact.predicate for fact in facts):
        # Names may have hundreds of things on either side, and few of the pairs are facts.
        subjects = " ".join(dict.fromkeys(str(fact.subject) for fact in facts))
        rows: Any = snapshot.query(f"SELECT ?s ?o {{ VALUES ?s {{ {subjects} }} ?s {predicate} ?o }}")
        stored.update(Triple(row[0], predicate, row[1]) for row in rows)
    return [fact for fact in dict.fromkeys(facts) if fact in stored]


def _among(pattern: str, predicates: list[_Term], ends: list[_Term] | None = None) -> str:
    """Return a pattern of `?t` for any of some properties."""
    listed = " ".join(str(one) for one in ends or () if isinstance(one, NamedNode | Literal))
    return " UNION ".join(f"{{ {pattern.format(one, listed)} }}" for one in predicates)


def _exactly(snapshot: Queryable, word: str, candidates: list[_Term]) -> list[_Term]:
    """Return the things with exactly this name, or all if none has it."""
    named = _named(snapshot, word) if len(candidates) > 1 else []
    return [term for term in candidates if term in named] or candidates


def _in_same_launch(candidates: list[_Term], others: list[_Term]) -> list[_Term]:
    """Return the things in the launch configuration of the only other end (or in none, as it), or all if none is."""
    if len(others) != 1 or not isinstance(others[0], NamedNode):
        return candidates
    near: list[_Term] = [one for one in candidates if isinstance(one, NamedNode) and _system(one) == _system(others[0])]
    return near or candidates


def _system(term: NamedNode) -> str:
    """Return the IRI of the launch configuration that has a thing, or an empty text."""
    whole, _, _ = term.value.partition("#")
    return whole if "/configuration/" in whole else ""


def _check_used(snapshot: Queryable, predicate: _Term, prefixes: Mapping[str, str]) -> None:
    """Raise KG001 for a property without triples: it cannot resolve ambiguous names, and is often misspelt."""
    if isinstance(predicate, NamedNode) and not snapshot.query(f"ASK {{ ?s {predicate} ?o }}"):
        rows: Any = snapshot.query(_PROPERTIES)
        properties = [shorten(row[0].value, prefixes) for row in rows]
        short = shorten(predicate.value, prefixes)
        raise UnknownNameError("KG001", f"nothing has the property {short}", hint=did_you_mean(short, properties))


def _triples(subjects: list[_Term], predicates: list[_Term], values: list[_Term]) -> list[Triple]:
    return [
        Triple(one, two, three)
        for one, two, three in product(subjects, predicates, values)
        if isinstance(one, NamedNode) and isinstance(two, NamedNode)
    ]


def _used_with(
    snapshot: Queryable, word: str, candidates: list[_Term], places: list[str], prefixes: Mapping[str, str]
) -> list[_Term]:
    """Return the things called `word` that a property is used with, or else those of a kind that it is, or else all.

    `candidates` have the name, or their IRI ends in it and the property is used with them.
    Where what has exactly the name is of such a kind, nothing else is meant, and not all that is named has to be read.
    """
    used, other = places
    if passed := _passing(snapshot, candidates, used):
        return passed
    named = [one for one in _named(snapshot, word) if one in candidates]
    for limit in (_SAMPLE, ""):
        if named and (passed := _alike(snapshot, named, _KINDS.format(other, limit))):
            return passed
    if passed := _passing(snapshot, terms(snapshot, word, among=f"{{ {used} }}", prefixes=prefixes), used):
        return passed
    every = terms(snapshot, word, prefixes=prefixes)
    return _alike(snapshot, every, _KINDS.format(other, "")) or every


def _passing(snapshot: Queryable, candidates: Sequence[_Term], test: str) -> list[_Term]:
    """Return the IRIs for which a pattern of `?t` has a match in the store."""
    iris = [one for one in candidates if isinstance(one, NamedNode)]
    return [one for one in iris if snapshot.query(f"ASK {{ {test.replace('?t', str(one))} }}")]


def _alike(snapshot: Queryable, candidates: Sequence[_Term], query: str) -> list[_Term]:
    """Return those IRIs that are of one of the kinds that a query finds."""
    rows: Any = snapshot.query(query)
    kinds = {row[0] for row in rows}
    listed = " ".join(str(one) for one in candidates if isinstance(one, NamedNode))
    pairs: Any = snapshot.query(f"SELECT ?t ?kind WHERE {{ VALUES ?t {{ {listed} }} ?t a ?kind }}")
    alike = {row[0] for row in pairs if row[1] in kinds}
    return [one for one in candidates if one in alike]


def terms(
    snapshot: Queryable,
    word: str,
    *,
    property_: bool = False,
    among: str | None = "",
    prefixes: Mapping[str, str] = PREFIXES,
) -> list[_Term]:
    """Return the possible terms for a word: `<iri>`, `ros:Node`, `"text"`, `5`, `a`, or a name in the store.

    A name resolves to things with that name, and to things whose IRI ends in it if they match the pattern `among` (of
    `?t`). With a pattern, or with None for exact names only, the result may be empty.

    Raises UnknownNameError: KG001 with suggestions if nothing is found.
    """
    if property_ and word == "a":
        return [RDF_TYPE]
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
    return _called(snapshot, word, among)


def _literal(word: str) -> Literal:
    prefixes = "".join(f"@prefix {name}: <{namespace}> .\n" for name, namespace in PREFIXES.items())
    try:
        term = next(iter(parse(f"{prefixes}<x:s> <x:p> {word} .", RdfFormat.TURTLE))).object
    except SyntaxError as error:
        raise UsageError("KG003", f"`{word}` is not a literal as Turtle writes it") from error
    return cast("Literal", term)


def _property(snapshot: Queryable, word: str) -> list[NamedNode]:
    """Return the properties that end in `word`: with a known prefix, or else all in the store."""
    if re.fullmatch(r"[\w.-]+", word):
        prefixed = [NamedNode(namespace + word) for namespace in PREFIXES.values()]
        if used := [iri for iri in prefixed if snapshot.query(f"ASK {{ ?s {iri} ?o }}")]:
            return used
    rows: Any = snapshot.query(_PROPERTIES)
    properties = [row[0] for row in rows]
    matches = [iri for iri in properties if re.split(r"[/#]", iri.value)[-1] == word]
    if not matches:
        hint = did_you_mean(word, [shorten(iri.value) for iri in properties]) or _ALL_PROPERTIES
        raise UnknownNameError("KG001", f"unknown property `{word}`", hint=hint)
    return matches


def _named(snapshot: Queryable, word: str, *others: str) -> list[NamedNode]:
    """Return the things with exactly this name, or one of some other names."""
    names = [Literal(word), Literal(word, language="en"), *map(Literal, others)]
    rows: Any = snapshot.query(_CALLED % " ".join(map(str, names)), prefixes=PREFIXES)
    return [row[0] for row in rows if isinstance(row[0], NamedNode)]


def _called(snapshot: Queryable, word: str, among: str | None) -> list[_Term]:
    """Return the things called `word`, or whose IRI ends in it; see `terms`."""
    things = _named(snapshot, word, f"/{word}")  # ROS names may be typed without their leading slash
    if among is not None:
        ends = (Literal(word), Literal("#" + word), Literal("/" + word))
        ended: Any = snapshot.query(_ENDING % (among, *ends), prefixes=PREFIXES)
        things += [row[0] for row in ended if row[0] not in things]
    if not things and among == "":
        names: Any = snapshot.query(_NAMES, prefixes=PREFIXES)
        hint = did_you_mean(word, [row[0].value for row in names])
        raise UnknownNameError("KG001", f"nothing in the store is called `{word}`", hint=hint)
    return list(things)
