"""Anything of the graph by its IRI, with the facts about it, page by page: the views `resource` and `about`."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from pyoxigraph import BlankNode, Literal, NamedNode

from kg.errors import UnknownNameError
from kg.facts import DescriptionKind, Location
from kg.graph import vocabulary as v
from kg.graph.fields import one
from kg.graph.iris import Iris
from kg.graph.reading.queries import column, grouped, texts, values
from kg.graph.texts import descriptions_of
from kg.query.rows import rows
from kg.similar import did_you_mean
from kg.syntax.names import PREFIXES, shorten
from kg.views.arguments import whole
from kg.views.evidence import places
from kg.views.terms import called, named_node
from kg.views.tree import alike

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

_MOST: Final = 500
_SORTED: Final = 2000
"""So many facts of one property are sorted by label; more come in the order of the store, which is always the same."""
_ANYWHERE: Final = "{ GRAPH ?g { %(pattern)s } } UNION { %(pattern)s }"
_PLACES: Final = """SELECT ?thing ?said ?value {
  VALUES ?thing { %s } GRAPH ?g { ?thing ?said ?value }
  FILTER(?said IN (rnkg:path, rnkg:line, rnkg:declaredIn, rnkg:repository))
}"""
_PLACE: Final = (v.PATH, v.LINE, v.DECLARED_IN, v.IN_REPOSITORY)
_COMMENTS: Final = (
    "SELECT ?text { VALUES ?said { rdfs:comment skos:definition dcterms:description } GRAPH ?g { %s ?said ?text } }"
)


def resource(  # noqa: PLR0913 - the part of the facts
    snapshot: EmbeddedSnapshot,
    settings: Settings,
    *,
    iri: str,
    predicate: str = "",
    direction: str = "",
    offset: str = "0",
    limit: str = "25",
) -> dict[str, Any]:
    """Return the facts of the store about an IRI (whole, in angle brackets, or with a known prefix).

    Facts are in groups, one for each property: `out` where it is the subject, `in` where it is the object. With
    `predicate` and `direction` (out or in) there is this group alone, `limit` facts from `offset` on; otherwise the
    first `limit` (500 at most) of each.

    The keys: `iri`, `short` (with prefix), `label`, `kind` (repository, package, topic, ..., empty for what is none of
    the kinds of docs/graph-model.md), `types` (`iri`, `label`), `comment`, `evidence` (its own line, or None), `out`,
    `in`, and `uses`: how many facts have it as their property.

    A group has `predicate` (`iri`, `label`), `count`, `offset`, `facts`. A fact has `value`, the thing at the other
    end: `{"iri", "label", "kind"}`, or of a literal or a blank node `{"text", "datatype", "language"}`; `inferred` (no
    graph but that of what rules derived has it), `graphs`, `evidence` (the line of the thing at the other end, None
    without one), and `fact`, its three terms as the view `why` takes them.

    Raises:
        UnknownNameError: KG001 with suggestions when the store does not mention it.
        UsageError: KG003 for what is not an IRI.
    """
    about = _About(snapshot, Iris(settings.base), named_node(iri))
    start, most = whole(offset, 0), max(1, min(whole(limit, 25), _MOST))
    sides = [direction] if direction in _SIDES else list(_SIDES)
    only = named_node(predicate).value if predicate else ""
    groups = {side: about.groups(side, only, start if only else 0, most) for side in sides}
    uses = about.uses()
    if not uses and not any(groups.values()) and not any(about.counts(side) for side in _SIDES):
        thing = about.iris.parse(about.node.value.partition("#")[0])
        similar_names = alike(snapshot, about.iris, thing.kind) if thing else ()
        hint = did_you_mean(thing.parts[-1], similar_names) if thing and similar_names else None
        message = f"the store does not mention {about.node.value}"
        raise UnknownNameError("KG001", message, hint=hint or "`/search` finds what it has.")
    return {**about.header(), "out": groups.get("out", []), "in": groups.get("in", []), "uses": uses}


_SIDES: Final = {"out": "{thing} {predicate} ?other", "in": "?other {predicate} {thing}"}


@dataclass(frozen=True, slots=True)
class _About:
    snapshot: EmbeddedSnapshot
    iris: Iris
    node: NamedNode

    def counts(self, side: str) -> dict[str, int]:
        """Return the number of facts of each property."""
        pattern = _SIDES[side].format(thing=self.node, predicate="?p")
        where = _ANYWHERE % {"pattern": pattern}
        query = f"SELECT ?p (COUNT(DISTINCT ?other) AS ?n) {{ {where} }} GROUP BY ?p"
        return {predicate: int(number) for predicate, number in rows(self.snapshot, query) if predicate}

    def uses(self) -> int:
        """Return how many facts have it as their property."""
        (row,) = rows(self.snapshot, f"SELECT (COUNT(*) AS ?n) {{ GRAPH ?g {{ ?s {self.node} ?o }} }}")
        return int(row[0])

    def groups(self, side: str, only: str, offset: int, most: int) -> list[dict[str, Any]]:
        """Return the groups of a side, sorted by property, each with a page of its facts."""
        counted = {key: number for key, number in self.counts(side).items() if only in {"", key}}
        groups = [self._group(side, key, number, offset, most) for key, number in counted.items()]
        self._complete([fact for group in groups for fact in group["facts"]])
        for group in groups:
            if group["count"] <= _SORTED:
                group["facts"].sort(key=_order)
        return sorted(
            groups, key=lambda group: (group["predicate"]["iri"] != v.bare(v.TYPE), group["predicate"]["label"])
        )

    def _group(self, side: str, predicate: str, number: int, offset: int, most: int) -> dict[str, Any]:
        facts: dict[str, dict[str, Any]] = {}
        for term, graph in self._page(side, predicate, number, offset, most):
            fact = facts.setdefault(str(term), self._fact(side, predicate, term))
            if graph:
                fact["graphs"].append(graph)
        for fact in facts.values():
            fact["graphs"].sort()
            fact["inferred"] = fact["graphs"] == [self.iris.graph("inferred")]
        return {
            "predicate": {"iri": predicate, "label": shorten(predicate)},
            "count": number,
            "offset": offset,
            "facts": list(facts.values()),
        }

    def _page(self, side: str, predicate: str, number: int, offset: int, most: int) -> list[tuple[Any, str | None]]:
        """Return the terms at the other end, with each graph that states them."""
        pattern = _SIDES[side].format(thing=self.node, predicate=NamedNode(predicate))
        where = _ANYWHERE % {"pattern": pattern}
        if number > _SORTED:
            terms = [
                term for term, _ in self._terms(f"SELECT DISTINCT ?other {{ {where} }} LIMIT {most} OFFSET {offset}")
            ]
            # VALUES cannot name blank nodes, so they are left out of such a page.
            listed = " ".join(str(term) for term in terms if not isinstance(term, BlankNode))
            return self._terms(f"SELECT ?other ?g {{ VALUES ?other {{ {listed} }} GRAPH ?g {{ {pattern} }} }}")
        others = self._terms(f"SELECT ?other ?g {{ {where} }}")
        chosen = set(sorted({str(term) for term, _ in others})[offset : offset + most])
        return [(term, graph) for term, graph in others if str(term) in chosen]

    def _terms(self, query: str) -> list[tuple[Any, str | None]]:
        answer: Any = self.snapshot.query(query, union=False)
        return [(row[0], row[1].value if len(row) > 1 and row[1] else None) for row in answer]

    def _fact(self, side: str, predicate: str, term: Any) -> dict[str, Any]:
        ends = (str(self.node), str(term)) if side == "out" else (str(term), str(self.node))
        value: dict[str, Any] = {"text": str(term), "datatype": None, "language": None}
        if isinstance(term, NamedNode):
            value = {"iri": term.value}
        if isinstance(term, Literal):
            value = {"text": term.value, "datatype": shorten(term.datatype.value), "language": term.language}
        fact = {"subject": ends[0], "predicate": f"<{predicate}>", "object": ends[1]}
        return {"value": value, "inferred": False, "graphs": [], "evidence": None, "fact": fact}

    def _complete(self, facts: Iterable[dict[str, Any]]) -> None:
        """Give things at the other end of facts their labels, kinds and lines."""
        things = [fact for fact in facts if "iri" in fact["value"]]
        iris = {fact["value"]["iri"] for fact in things}
        names, lines = called(self.snapshot, iris), self._lines(iris)
        for fact in things:
            iri = fact["value"]["iri"]
            fact["value"] |= {"label": names[iri], "kind": self._kind(iri)}
            fact["evidence"] = lines.get(iri)

    def _kind(self, iri: str) -> str:
        thing = self.iris.parse(iri)
        return thing.kind if thing else ""

    def _lines(self, iris: Iterable[str]) -> dict[str, dict[str, Any]]:
        """Return the evidence of those things that are on a line of their own."""
        query = _PLACES % " ".join(str(NamedNode(iri)) for iri in sorted(iris))
        where, evidence = places(self.snapshot), {}
        answer: Any = self.snapshot.query(query, prefixes=PREFIXES, union=False)
        for thing, own in grouped(values(answer)).items():
            path, line, file, repository = (one(own, term) for term in _PLACE)
            if path and line:
                holder = self.iris.parse(file) if file else None
                place = Location(path, int(line), repository)
                evidence[thing] = where.evidence(holder.parts[0] if holder else "", place)
        return evidence

    def header(self) -> dict[str, Any]:
        """Return the head of the page."""
        iri = self.node.value
        query = f"SELECT DISTINCT ?kind {{ {_ANYWHERE % {'pattern': f'{self.node} a ?kind'}} }}"
        kinds = [kind for (kind,) in rows(self.snapshot, query)]
        names = called(self.snapshot, {iri, *kinds})
        comments = sorted(text for (text,) in rows(self.snapshot, _COMMENTS % self.node))
        return {
            "iri": iri,
            "short": shorten(iri),
            "label": names[iri],
            "kind": self._kind(iri),
            "types": sorted(
                ({"iri": kind, "label": names[kind]} for kind in kinds), key=lambda kind: (kind["label"], kind["iri"])
            ),
            "comment": comments[0] if comments else None,
            "evidence": self._lines([iri]).get(iri),
        }


def _order(fact: dict[str, Any]) -> tuple[str, str]:
    value = fact["value"]
    return str(value.get("label", value.get("text", ""))), str(value.get("iri", ""))


_LITERALS: Final = {
    "version": "rnkg:version",
    "licenses": "rnkg:licenseName",
    "maintainers": "rnkg:maintainer/rdfs:label",
    "authors": "rnkg:author/rdfs:label",
    "build_types": "rnkg:buildType",
    "deprecated": "rnkg:deprecated",
}
_NEEDS: Final = """SELECT DISTINCT ?label ?other ?kind {
  %s rnkg:hasDependency ?entry . ?entry rnkg:onPackage ?name ; rnkg:dependencyKind ?kind . ?name rdfs:label ?label
  OPTIONAL { ?other rnkg:hasPackageName ?name }
} ORDER BY ?label ?other ?kind"""
_TESTED: Final = frozenset({"test_depend", "doc_depend"})
_BUILT: Final = _TESTED | {"buildtool_depend", "build_depend", "buildtool_export_depend"}
_NEEDED: Final = """SELECT DISTINCT ?label ?other {
  %s rnkg:hasPackageName ?name . ?other rnkg:dependsOn ?name ; a rnkg:Package ; rdfs:label ?label
} ORDER BY ?label ?other"""
_FIELDS: Final = """SELECT DISTINCT ?section ?type ?name ?value ?comment ?repository ?path ?line {
  ?definition rnkg:defines %s ; rnkg:path ?path ; rnkg:hasField ?field .
  ?package rnkg:contains ?definition . ?source rnkg:contains ?package ; a rnkg:Repository ; rnkg:name ?repository .
  ?field rnkg:section ?section ; rnkg:position ?position ; rnkg:name ?name ; rnkg:fieldType ?type ; rnkg:line ?line .
  OPTIONAL { ?field rnkg:defaultValue|rnkg:constantValue ?value }
  OPTIONAL { ?field rdfs:comment ?comment }
} ORDER BY ?repository ?path xsd:integer(?line) xsd:integer(?position)"""


def about(snapshot: EmbeddedSnapshot, settings: Settings, *, iri: str) -> dict[str, Any]:
    """Return what a package says of itself, needs and is needed by, and the fields of a type, by IRI.

    A package has `repository`, `version`, `licenses`, `maintainers`, `authors`, `build_types`, `deprecated` (lists of
    texts), `descriptions` (`text`, `heading` and `evidence` of the paragraphs of its README and manual), `requires` and
    `required_by`: objects with `label` and `iri`, None for packages that are not in the store; those of `requires` also
    have `only`: `tests` or `build` if the package needs them for nothing else, else empty. A type has `fields`: objects
    with `section`, `type`, `name`, `value` (of a constant, or the default), `comment` and `evidence`. Anything else has
    an empty object.
    """
    node, thing, where = named_node(iri), Iris(settings.base).parse(iri), places(snapshot)
    if thing and thing.kind == "package" and "#" not in iri:
        return {
            "repository": thing.parts[0],
            **{
                key: sorted(column(snapshot, f"SELECT DISTINCT ?value {{ {node} {path} ?value }}"))
                for key, path in _LITERALS.items()
            },
            "descriptions": [
                {"text": one.text, "heading": one.heading, "evidence": where.evidence(thing.parts[0], one.location)}
                for one in descriptions_of(snapshot, f"VALUES ?node {{ {node} }}").get(iri, ())
                if one.kind is not DescriptionKind.MANIFEST
            ],
            "requires": _required(snapshot, node),
            "required_by": [{"label": label, "iri": other} for label, other in texts(snapshot, _NEEDED % node)],
        }
    fields = list(texts(snapshot, _FIELDS % node))
    if not fields:
        return {}
    keys = ("section", "type", "name", "value", "comment")
    return {
        "fields": [
            {
                **dict(zip(keys, row, strict=False)),
                "evidence": where.evidence(repository, Location(path, int(line))),
            }
            for *row, repository, path, line in fields
        ]
    }


def _required(snapshot: EmbeddedSnapshot, node: NamedNode) -> list[dict[str, str | None]]:
    kinds: defaultdict[tuple[str, str | None], set[str]] = defaultdict(set)
    for label, other, kind in texts(snapshot, _NEEDS % node):
        kinds[label, other].add(kind)
    return [
        {"label": label, "iri": other, "only": "tests" if those <= _TESTED else "build" if those <= _BUILT else ""}
        for (label, other), those in kinds.items()
    ]
