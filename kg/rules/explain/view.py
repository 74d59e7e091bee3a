"""Queries of explanations: the graphs of a fact, the matches of a body, the source line of a fact."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Protocol, cast

import pyoxigraph
from pyoxigraph import Literal, NamedNode, QueryBoolean, QuerySolutions, QueryTriples, Triple

from kg.rules.explain.closures import Closures
from kg.rules.explain.proof import Evidence
from kg.rules.form import Element, Rule, Term, Variable
from kg.rules.sparql import brief, select, spelling, substitutions
from kg.syntax.names import PREFIXES, prefixed, shorten

_LABEL: Final = NamedNode("http://www.w3.org/2000/01/rdf-schema#label")
_STRING: Final = "http://www.w3.org/2001/XMLSchema#string"
_GRAPHS: Final = "SELECT ?g ?s ?p ?o WHERE { GRAPH ?g { ?s ?p ?o } } ORDER BY ?g"
_DEFAULT: Final = "SELECT ?s ?p ?o WHERE { ?s ?p ?o }"


class Queryable(Protocol):
    """The part of a snapshot that explanations use."""

    def query(
        self,
        text: str,
        *,
        prefixes: Mapping[str, str] | None = None,
        union: bool = True,
        substitutions: Mapping[pyoxigraph.Variable, Term] | None = None,
    ) -> QuerySolutions | QueryBoolean | QueryTriples:
        """Run a query; variables in `substitutions` stand for those terms."""
        ...


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """Which graphs and properties of a store matter to explanations.

    `inferred` holds what rules derived; graphs `ignored` are not read by rules; `path`, `line` and `repository` are the
    properties that say where in the sources a thing was read; `documents` has the lines of the statements of RDF files.
    """

    inferred: NamedNode
    ignored: tuple[NamedNode, ...] = ()
    path: NamedNode | None = None
    line: NamedNode | None = None
    repository: NamedNode | None = None
    documents: Callable[[Triple], Evidence | None] | None = None
    declared_by: NamedNode | None = None
    """The property that leads from a thing without a line of its own to the one whose line it is."""
    seen_at: NamedNode | None = None
    seen_since: NamedNode | None = None
    """The properties that name the peer which showed a thing while it ran, and since when."""


class View:
    """A snapshot as explanations see it; answers are cached, since a snapshot does not change.

    `rules` are those of the bodies: they define the auxiliary predicates.
    """

    def __init__(
        self,
        snapshot: Queryable,
        vocabulary: Vocabulary,
        rules: Iterable[Rule] = (),
        *,
        prefixes: Mapping[str, str] = PREFIXES,
    ) -> None:
        self.closures = Closures.of(rules)
        self.prefixes = prefixes
        self._snapshot = snapshot
        self._vocabulary = vocabulary
        self._ignored = {graph.value for graph in vocabulary.ignored}
        self._graphs: dict[Triple, tuple[str, ...]] = {}
        self._labels: dict[Term, str] = {}

    def graphs(self, fact: Triple) -> tuple[str, ...]:
        """Return the graphs that hold a fact and that rules read; the default graph is the empty string."""
        result = self._graphs.get(fact)
        if result is None:
            terms = {"s": fact.subject, "p": fact.predicate, "o": fact.object}
            named = [cast("NamedNode", row["g"]).value for row in self._rows(_GRAPHS, terms, union=False)]
            plain = [""] if any(self._rows(_DEFAULT, terms, union=False)) else []
            result = tuple(graph for graph in (*plain, *named) if graph not in self._ignored)
            self._graphs[fact] = result
        return result

    def asserted(self, fact: Triple) -> tuple[str, ...]:
        """Return the graphs in which a fact is asserted."""
        return tuple(graph for graph in self.graphs(fact) if graph != self._vocabulary.inferred.value)

    def _rows(self, text: str, terms: Mapping[str, Term], *, union: bool = True) -> QuerySolutions:
        """Return the rows of a query in which names of variables stand for terms."""
        given = {pyoxigraph.Variable(name): term for name, term in terms.items()}
        return cast("QuerySolutions", self._snapshot.query(text, union=union, substitutions=given))

    def solutions(
        self, body: Sequence[Element], names: Sequence[str], bindings: Mapping[str, Term], limit: int
    ) -> list[dict[str, Term]]:
        """Return up to `limit` solutions of a body under `bindings`: the values of the bound variables in `names`."""
        return list(self.stream(body, names, bindings, limit))

    def stream(
        self, body: Sequence[Element], names: Sequence[str], bindings: Mapping[str, Term], limit: int | None = None
    ) -> Iterator[dict[str, Term]]:
        """Yield the results of `solutions` as the engine finds them, all of them without a limit."""
        given = {Variable(name): term for name, term in bindings.items()}
        blank = substitutions(given)
        wanted = [Variable(name) for name in names if name not in bindings or spelling(Variable(name))[1:] in blank]
        text = select(self.closures.written(body), wanted, given, inferred=self._vocabulary.inferred)
        if wanted and limit is not None:  # a query without columns has its own limit
            text = f"{text}\nLIMIT {limit}"
        for row in self._rows(text, blank):
            values = {variable.name: row[spelling(variable)[1:]] for variable in wanted}
            yield {**bindings, **{name: cast("Term", term) for name, term in values.items() if term is not None}}

    def objects(self, subject: Term, predicate: Term, limit: int) -> list[Term]:
        """Return up to `limit` objects of a subject and a predicate."""
        return self._column("SELECT DISTINCT ?v ?s ?p WHERE { ?s ?p ?v }", limit, s=subject, p=predicate)

    def subjects(self, predicate: Term, value: Term, limit: int) -> list[Term]:
        """Return up to `limit` subjects of a predicate and an object."""
        return self._column("SELECT DISTINCT ?v ?p ?o WHERE { ?v ?p ?o }", limit, p=predicate, o=value)

    def predicates(self, subject: Term, limit: int) -> list[Term]:
        """Return up to `limit` predicates of a subject."""
        return self._column("SELECT DISTINCT ?v ?s WHERE { ?s ?v ?o }", limit, s=subject)

    def _column(self, text: str, limit: int, **terms: Term) -> list[Term]:
        return [cast("Term", row["v"]) for row in self._rows(f"{text} LIMIT {limit}", terms)]

    def evidence(self, fact: Triple) -> Evidence | None:
        """Return the line that a fact was read from, or the peer that reported it at run time.

        An object that is on a line of its own (an interface of a node) is more exact than the subject.
        """
        for thing in (fact.object, fact.subject):
            result = self._place(cast("Term", thing)) if not isinstance(thing, Literal) else None
            if result:
                return result
        return self._vocabulary.documents(fact) if self._vocabulary.documents else None

    def _place(self, thing: Term) -> Evidence | None:
        words = self._vocabulary
        named = thing.value if isinstance(thing, NamedNode) else None
        path, line = self._value(thing, words.path), self._value(thing, words.line)
        if path is not None and line is not None:
            return Evidence(path, int(line), self._value(thing, words.repository), named)
        origins = self.objects(thing, words.declared_by, 2) if words.declared_by else []
        origin = next((one for one in origins if one != thing), None)
        if origin:
            return self._place(origin)
        peer, since = self._value(thing, words.seen_at), self._value(thing, words.seen_since)
        return Evidence(f"{peer}, seen since {since}", thing=named) if peer and since else None

    def _value(self, thing: Term, predicate: NamedNode | None) -> str | None:
        values = self.objects(thing, predicate, 1) if predicate else []
        return values[0].value if values and isinstance(values[0], Literal) else None

    def label(self, term: Term) -> str:
        """Return a term as people call it: its label, else its short form."""
        cached = self._labels.get(term)
        if cached is None:
            cached = self._labels[term] = self._called(term) or self.spelt(term)
        return cached

    def _called(self, term: Term) -> str | None:
        """Return the label of a thing, or that of its whole with the name of the part if no prefix fits the thing."""
        if isinstance(term, Literal):
            return f'"{term.value}"' if term.datatype.value == _STRING else term.value
        if (label := self._value(term, _LABEL)) is not None or not isinstance(term, NamedNode):
            return label
        if prefixed(term.value, self.prefixes) is not None:
            return None
        whole = term.value
        while "#" in whole:
            whole = whole[: max(whole.rfind("/", whole.index("#")), whole.index("#"))]
            if (label := self._value(NamedNode(whole), _LABEL)) is not None:
                return f"{label}#{term.value[len(whole) + 1 :]}"
        return None

    def sentence(self, fact: Triple) -> str:
        """Return a fact as people read it."""
        return f"{self.label(fact.subject)} {self.spelt(fact.predicate)} {self.label(fact.object)}"

    def spelt(self, term: Term) -> str:
        """Return a term as SPARQL spells it, with known prefixes and those of the rules."""
        return shorten(term.value, self.prefixes) if isinstance(term, NamedNode) else str(term)

    def brief(self, element: Element) -> str:
        """Return a part of a body as SPARQL on one line, its IRIs shortened."""
        return brief(element, self.prefixes)
