"""Rules of a shapes graph as CONSTRUCT queries: one for each target of the shape and each case of the conditions.

From the text of a file to rules: its queries are parsed and decomposed, their places put back into the file.

Pre-binding (SHACL, appendix A): `$this` has its value everywhere in a query, also inside its groups.

The patterns that bind the focus node are at the beginning of the whole group. SPARQL joins from inside to outside,
so a group inside it that uses the variable in an expression must bind it too, in a sub-SELECT once for each node,
since aggregates count solutions.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, fields, is_dataclass, replace
from itertools import pairwise, product
from operator import itemgetter
from typing import TYPE_CHECKING, Any, Final

from pyoxigraph import Literal, NamedNode

from kg.errors import Place, RuleError
from kg.rules.decompose import decompose
from kg.rules.notations.shacl.conditions import Conditions
from kg.rules.notations.shacl.expressions import Expressions
from kg.rules.notations.shacl.functions import Functions
from kg.rules.notations.shacl.graph import ShapesGraph
from kg.rules.notations.shacl.paths import Names
from kg.rules.notations.shacl.query import PREBOUND, Query, Words, check_prebound, closing, plain, query_of, variables
from kg.rules.notations.shacl.targets import targets
from kg.rules.notations.shacl.vocabulary import RDFS, SUBCLASS, sh
from kg.syntax.lexer import Kind
from kg.syntax.names import RDF_TYPE
from kg.syntax.parser import parse_rq
from kg.syntax.position import offset_of, place_at

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from kg.rules.form import Rule, Term

_REGIME: Final = "http://www.w3.org/ns/entailment/"
_PROPERTY: Final = f"<{RDFS}subPropertyOf>"

_RDFS: Final = (
    f"CONSTRUCT {{ ?x {RDF_TYPE} ?c }} WHERE {{ ?p <{RDFS}domain> ?c . ?x ?p ?y . }}",
    f"CONSTRUCT {{ ?y {RDF_TYPE} ?c }} WHERE {{ ?p <{RDFS}range> ?c . ?x ?p ?y . FILTER(!isLiteral(?y)) }}",
    f"CONSTRUCT {{ ?p {_PROPERTY} ?r }} WHERE {{ ?p {_PROPERTY} ?q . ?q {_PROPERTY} ?r . }}",
    f"CONSTRUCT {{ ?x ?q ?y }} WHERE {{ ?p {_PROPERTY} ?q . ?x ?p ?y . }}",
    f"CONSTRUCT {{ ?x {RDF_TYPE} ?d }} WHERE {{ ?c {SUBCLASS} ?d . ?x {RDF_TYPE} ?c . }}",
    f"CONSTRUCT {{ ?c {SUBCLASS} ?e }} WHERE {{ ?c {SUBCLASS} ?d . ?d {SUBCLASS} ?e . }}",
)
"""rdfs2, 3, 5, 7, 9 and 11 of RDF 1.1 Semantics (section 9.2.1). Those that say of each name that it is a resource, a
property or a class, and a part of itself, derive nothing that a rule could tell apart."""

_THIS: Final = "this"


def rules(text: str, name: str, path: Path | str) -> tuple[Rule, ...]:
    """Return the rules of a shapes graph in Turtle, their parts numbered from one through the file.

    `name` is that of the rules, `path` the path in errors. Raises `RuleError`: KG201 for text that does not parse and
    shapes that are ill-formed, KG230 for features that are not supported, with the node and the way out.
    """
    graph = ShapesGraph(text, str(path))
    unique: dict[tuple[object, ...], Rule] = {}
    for statement in statements(graph):
        for rule in _compiled(graph, statement, name):
            unique.setdefault((rule.head, rule.body), rule)
    return tuple(replace(rule, part=part) for part, rule in enumerate(unique.values(), 1))


def _compiled(graph: ShapesGraph, statement: Statement, name: str) -> tuple[Rule, ...]:
    """Return the rules of one query."""

    def moved(place: Place) -> Place:
        offset = offset_of(statement.text, place.line or 1, place.column or 1)
        return place_at(graph.text, statement.source(offset), graph.path)

    try:
        unit = parse_rq(statement.text, graph.path)
        compiled = decompose(unit.rules[0], name, graph.path, statement.text)
    except RuleError as error:
        where = moved(error.place) if error.place else None
        fixes = [each for each in error.fixes if each.place is None]
        raise RuleError(error.code, error.message, place=where, hint=error.hint, fixes=fixes) from None
    return tuple(replace(_with_places(rule, moved), order=statement.order) for rule in compiled)


def _with_places(part: Any, moved: Callable[[Place], Place]) -> Any:
    """Return a part of the internal form with other places."""
    if isinstance(part, Place):
        return moved(part)
    if isinstance(part, tuple):
        return tuple(_with_places(one, moved) for one in part)
    if is_dataclass(part) and not isinstance(part, type):
        changed = {field.name: _with_places(getattr(part, field.name), moved) for field in fields(part)}
        return replace(part, **changed)
    return part


class _Groups:
    """Puts `binder` at the beginning of each inner group that needs `$this`."""

    def __init__(self, graph: ShapesGraph, owner: Term, binder: str) -> None:
        self._graph = graph
        self._owner = owner
        self._binder = plain(binder)
        self._once = plain(f"{{ SELECT DISTINCT ?this WHERE {{ {binder} }} }}")

    def inside(self, words: Words) -> Words:
        """Return words, which are between braces, with the binder in their inner groups.

        Raises `RuleError` KG201 for a sub-SELECT that uses `$this` and does not project it.
        """
        if words and words[0].text.upper() == "SELECT":
            return self._select(words)
        result: Words = []
        index = 0
        while index < len(words):
            if words[index].text != "{":
                result.append(words[index])
                index += 1
                continue
            end = closing(words, index)
            inner = words[index + 1 : end]
            before = words[index - 1].text.upper() if index else ""
            result.append(words[index])
            if before == "EXISTS":
                result += inner
            else:
                result += [self._binder] * _needs(inner) + self.inside(inner)
            result += words[end : end + 1]
            index = end + 1
        return result

    def _select(self, words: Words) -> Words:
        opening = next((index for index, word in enumerate(words) if word.text == "{"), len(words))
        end = closing(words, opening)
        head = words[:opening]
        uses = _THIS in variables(words[opening:end])
        if uses and _THIS not in variables(head) and "*" not in [word.text for word in head]:
            hint = "Project it, and group by it to aggregate: SELECT $this (COUNT(?x) AS ?n) ... GROUP BY $this."
            raise self._graph.error(
                "a sub-SELECT uses $this and does not project it", self._owner, hint=hint, offset=words[0].offset
            )
        start = [self._once] if _needs(words[opening + 1 : end]) else []
        return [*head, *words[opening : opening + 1], *start, *self.inside(words[opening + 1 : end]), *words[end:]]


def _needs(words: Words) -> bool:
    """Return whether a group uses `$this` in an expression of its own: inside brackets, or inside EXISTS."""
    if words and words[0].text.upper() == "SELECT":
        return False
    index = depth = 0
    while index < len(words):
        word = words[index]
        if word.text == "{":
            end = closing(words, index)
            if words[index - 1].text.upper() == "EXISTS" and _THIS in variables(words[index:end]):
                return True
            index = end
        elif word.text in {"(", ")"}:
            depth += 1 if word.text == "(" else -1
        elif depth > 0 and word.kind is Kind.VARIABLE and word.text[1:] == _THIS:
            return True
        index += 1
    return False


def entailed(graph: ShapesGraph) -> tuple[tuple[str, ...], int]:
    """Return the rules of the regimes that the file asks for, and where it does.

    Raises `RuleError` KG230 for a regime that is not supported: SHACL wants a failure.
    """
    rules: tuple[str, ...] = ()
    offset = 0
    for node in graph.subjects(sh("entailment")):
        for regime in graph.values(node, sh("entailment")):
            if regime == sh("Rules"):
                continue
            place = graph.places.of_name(regime.value) if isinstance(regime, NamedNode) else None
            if regime != NamedNode(f"{_REGIME}RDFS"):
                hint = f"There are sh:Rules and <{_REGIME}RDFS>; for OWL 2 RL put the rules of rules/owl in force."
                what = f"the entailment regime {regime} is not supported"
                raise graph.error(what, node, code="KG230", hint=hint, offset=place)
            rules, offset = _RDFS, place or 0
    return rules, offset


_SHAPES_APART: Final = 1e6
"""How far the orders of two shapes move their rules apart: rules of shapes come after each other, not mixed."""


@dataclass(frozen=True, slots=True)
class Statement:
    """A CONSTRUCT query in full; `anchors` pairs offsets of its text with offsets of the file, rising."""

    text: str
    anchors: tuple[tuple[int, int], ...]
    order: float

    def source(self, offset: int) -> int:
        """Return the offset in the file of the character at `offset`."""
        index = bisect_right(self.anchors, offset, key=itemgetter(0)) - 1
        return self.anchors[max(index, 0)][1]


def statements(graph: ShapesGraph) -> Iterator[Statement]:
    """Yield the queries of all rules, and of the entailment regimes asked for, in the order of the file.

    Raises `RuleError`: KG201 for what the standard calls ill-formed, KG209 for parts of SPARQL that rules cannot have,
    KG230 for what is not supported.
    """
    result: list[Statement] = []
    for shape in graph.subjects(sh("rule")):
        if not graph.flag(shape, "deactivated"):
            binders = targets(graph, shape)
            for rule in graph.values(shape, sh("rule")):
                if not graph.flag(rule, "deactivated"):
                    result += _Rule(graph, shape, rule).statements(binders)
    _check_orders(graph)
    queries, offset = entailed(graph)
    before = min((one.order for one in result), default=0.0) - 1
    yield from (Statement(text, ((0, offset),), before) for text in queries)
    yield from result


def _check_orders(graph: ShapesGraph) -> None:
    """Refuse orders that one number cannot distinguish."""
    pairs = {
        (graph.order(shape), graph.order(rule)): rule
        for shape in graph.subjects(sh("rule"))
        for rule in graph.values(shape, sh("rule"))
    }
    ranks = [shape * _SHAPES_APART + rule for shape, rule in sorted(pairs)]
    if any(one >= two for one, two in pairwise(ranks)):
        rule = pairs[max(pairs)]
        raise graph.unsupported("an order beyond half a million", rule, "Use small numbers for sh:order.")


class _Rule:
    """One rule of one shape."""

    def __init__(self, graph: ShapesGraph, shape: Term, rule: Term) -> None:
        self._graph = graph
        self._rule = rule
        self._offset = graph.offset(rule)
        self._order = graph.order(shape) * _SHAPES_APART + graph.order(rule)
        self._functions = Functions(graph)

    def statements(self, binders: list[str]) -> Iterator[Statement]:
        """Yield the queries for each way to find focus nodes."""
        sparql = self._graph.is_instance(self._rule, sh("SPARQLRule"))
        if not sparql and not self._graph.is_instance(self._rule, sh("TripleRule")):
            kinds = ", ".join(str(kind) for kind in self._graph.values(self._rule, RDF_TYPE)) or "no type"
            hint = "Give it the type sh:TripleRule or sh:SPARQLRule."
            raise self._graph.unsupported(f"a rule of {kinds}", self._rule, hint)
        for binder in binders:
            yield from self._constructs(binder) if sparql else self._triples(binder)

    def _conditions(self, names: Names, binder: str) -> tuple[Conditions, list[list[str]]]:
        conditions = Conditions(self._graph, self._functions, names, binder)
        cases: list[list[str]] = [[]]
        for value in self._graph.values(self._rule, sh("condition")):
            shapes = self._graph.members(value, self._rule) if self._graph.is_list(value) else [value]
            for shape in shapes:
                cases = [[*one, *two] for one, two in product(cases, conditions.conforms(shape, "?this"))]
        return conditions, cases

    def _triples(self, binder: str) -> Iterator[Statement]:
        names = Names({"this", "target"})
        conditions, cases = self._conditions(names, binder)
        expressions = Expressions(self._graph, self._functions, names, conditions, binder)
        branches = [
            expressions.branches(self._graph.required(self._rule, name), "?this")
            for name in ("subject", "predicate", "object")
        ]
        if any(isinstance(self._graph.one(self._rule, name), Literal) for name in ("subject", "predicate")):
            hint = "Give sh:subject and sh:predicate an IRI, sh:this or a node expression."
            raise self._graph.error(
                "a literal cannot be the subject or the predicate of a triple", self._rule, hint=hint
            )
        for case, chosen in product(cases, product(*branches)):
            head = " ".join(branch.term for branch in chosen)
            patterns = dict.fromkeys(branch.pattern for branch in chosen if branch.pattern)
            text = f"CONSTRUCT {{ {head} }} WHERE {{ {' '.join([binder, *case, *patterns])} }}"
            yield Statement(text, ((0, self._offset),), self._order)

    def _constructs(self, binder: str) -> Iterator[Statement]:
        query = query_of(self._graph, self._rule, "construct")
        check_prebound(self._graph, query, PREBOUND)
        template, group = self._parts(query)
        names = Names(variables([*template, *group]) | {"this", "target"})
        target = names.fresh()
        binder = binder.replace("?target", target)
        _, cases = self._conditions(names, binder)
        group = _Groups(self._graph, self._rule, binder).inside(self._functions.inside(group, self._rule))
        if group and group[0].text.upper() == "SELECT":
            group = [plain("{"), *group, plain("}")]
        for case in cases:
            before = plain(f"}} WHERE {{ {' '.join([binder, *case])}")
            words = [plain("CONSTRUCT {"), *template, before, *group, plain("}")]
            yield self._statement(words)

    def _parts(self, query: Query) -> tuple[Words, Words]:
        """Return template and group; in the short form the group is both."""
        head = query.head
        refused = next((word for word in head if word.text.upper() == "FROM"), None)
        if refused is not None:
            hint = "Rules read all of the data; take FROM away."
            raise self._graph.error(
                "FROM is not allowed in a rule", self._rule, code="KG209", hint=hint, offset=refused.offset
            )
        if any(word.text.upper() in {"LIMIT", "OFFSET", "GROUP", "HAVING"} for word in query.modifiers):
            hint = "Put a sub-SELECT into the group."
            offset = query.modifiers[0].offset
            message = "a solution modifier after the group is not supported"
            raise self._graph.error(message, self._rule, code="KG230", hint=hint, offset=offset)
        if not head or head[0].text != "{":
            return query.group, query.group
        return head[1 : closing(head, 0)], query.group

    def _statement(self, words: Words) -> Statement:
        text = ""
        anchors = []
        for word in words:
            text += word.text if word.joined or not text else f" {word.text}"
            anchors.append((len(text) - len(word.text), self._offset if word.offset is None else word.offset))
        return Statement(text, tuple(anchors), self._order)
