"""Small stores for explanations: data in Turtle, and rules as CONSTRUCT queries applied up to the fixpoint."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, cast

from pyoxigraph import NamedNode, Quad, RdfFormat, Store, Triple

from kg.errors import Place
from kg.rules.explain.view import View, Vocabulary
from kg.rules.form import Assignment, Atom, Exists, Expression, Filter, Rule, Variable
from kg.rules.sparql import construct

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pyoxigraph
    from pyoxigraph import QueryBoolean, QuerySolutions, QueryTriples

    from kg.rules.form import Element, Pattern, Term

EX = "https://example.org/"
ASSERTED = NamedNode(EX + "graph/asserted")
INFERRED = NamedNode(EX + "graph/inferred")
BUILDS = NamedNode(EX + "graph/builds")
PREFIXES = f"@prefix : <{EX}> . @prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .\n"


def name(local: str) -> NamedNode:
    """Return a name of the examples."""
    return NamedNode(EX + local)


def fact(text: str) -> Triple:
    """Return the fact written as three words."""
    subject, predicate, value = map(name, text.split())
    return Triple(subject, predicate, value)


def pattern(word: str) -> Pattern:
    """Return the variable `?x` or a name."""
    return Variable(word[1:]) if word.startswith("?") else name(word)


def atom(text: str) -> Atom:
    """Return the triple pattern written as three words."""
    subject, predicate, value = map(pattern, text.split())
    return Atom(subject, predicate, value)


def expression(text: str) -> Expression:
    """Return an expression; its variables are the words that begin with `?`."""
    words = text.replace("(", " ").replace(")", " ").replace(",", " ").split()
    return Expression(text, tuple(dict.fromkeys(word[1:] for word in words if word.startswith("?"))))


def where(text: str) -> Filter:
    """Return a filter."""
    return Filter(expression(text))


def without(*atoms: str) -> Exists:
    """Return a negated block."""
    return Exists(tuple(map(atom, atoms)), negated=True)


def bound(variable: str, text: str) -> Assignment:
    """Return an assignment."""
    return Assignment(Variable(variable), expression(text))


def rule(title: str, head: str, *body: str | Element) -> Rule:
    """Return a rule; parts of its body that are texts are atoms."""
    elements = tuple(atom(part) if isinstance(part, str) else part for part in body)
    return Rule(title, (atom(head),), elements, Place(f"rules/{title}.rq", 7))


@dataclass
class World:
    """A store with the derivations of `rules` from its data in the graph of inferred facts."""

    data: str
    rules: tuple[Rule, ...]
    store: Store = field(default_factory=Store)

    def __post_init__(self) -> None:
        self.store.load(PREFIXES + self.data, RdfFormat.TURTLE, to_graph=ASSERTED)
        size = -1
        while size != len(self.store):
            size = len(self.store)
            for each in self.rules:
                self._apply(each)

    def _apply(self, each: Rule) -> None:
        text = construct(each, inferred=INFERRED)
        derived = cast("QueryTriples", self.store.query(text, use_default_graph_as_union=True))
        for triple in list(derived):
            if not any(self.store.quads_for_pattern(triple.subject, triple.predicate, triple.object)):
                self.store.add(Quad(triple.subject, triple.predicate, triple.object, INFERRED))

    def query(
        self,
        text: str,
        *,
        prefixes: Mapping[str, str] | None = None,
        union: bool = True,
        substitutions: Mapping[pyoxigraph.Variable, Term] | None = None,
    ) -> QuerySolutions | QueryBoolean | QueryTriples:
        """Run a query like a snapshot."""
        given = dict(substitutions) if substitutions else None
        return self.store.query(
            text, prefixes=dict(prefixes or {}), use_default_graph_as_union=union, substitutions=given
        )

    @property
    def view(self) -> View:
        """The store in the form used by explanations."""
        return View(self, Vocabulary(INFERRED, (BUILDS,), name("path"), name("line"), name("repository")), self.rules)

    def inferred(self) -> list[Triple]:
        """Return the derived triples."""
        return [quad.triple for quad in self.store.quads_for_pattern(None, None, None, INFERRED)]
