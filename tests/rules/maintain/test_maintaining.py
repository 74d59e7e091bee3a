"""Effects of changes of asserted triples on inferred ones."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from pyoxigraph import BlankNode, NamedNode
from rules.engine.comparing import columns, tuples
from rules.forms import atom, expression, rule, triples
from rules.forms import test as keep

from kg.errors import RuleError
from kg.rules.engine.evaluate import Limits, Program, evaluate
from kg.rules.engine.facts import Facts
from kg.rules.engine.terms import Dictionary
from kg.rules.form import AUXILIARY, Aggregate, Assignment, Column, EngineBlock, Exists, Variable
from kg.rules.maintain import Maintained

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.rules.form import Rule

ANCESTORS = [
    rule("?x :ancestor ?y", "?x :parent ?y", name="family/direct"),
    rule("?x :ancestor ?z", "?x :parent ?y . ?y :ancestor ?z", name="family/further"),
]
COUNT = Column(Variable("n"), "COUNT", None)


class Kept:
    """Rules over triples written as text; each change returns the inferred triples added and removed."""

    def __init__(self, rules: Sequence[Rule], asserted: str) -> None:
        self.dictionary = Dictionary()
        self.program = Program(rules)
        begin = self.facts(asserted)
        self.state = Maintained(
            self.program, self.dictionary, begin, evaluate(self.program, self.dictionary, begin).inferred
        )

    def facts(self, text: str) -> Facts:
        """Return triples as columns."""
        read = triples(text) if text else []
        return columns(((triple.subject, triple.predicate, triple.object) for triple in read), self.dictionary)

    def shown(self, facts: Facts, sign: str) -> list[str]:
        """Return triples in the notation of these tests, sorted; blank nodes all alike."""
        found = tuples(facts, self.dictionary)
        return sorted(sign + " ".join("[]" if isinstance(t, BlankNode) else _short(t) for t in fact) for fact in found)

    def change(self, inserted: str = "", deleted: str = "", limits: Limits | None = None) -> list[str]:
        """Apply a change and compare with starting over."""
        change = self.state.apply(self.facts(inserted), self.facts(deleted), limits=limits)
        again = evaluate(self.program, self.dictionary, self.state.asserted, limits=limits).inferred
        assert tuples(self.state.inferred, self.dictionary) == tuples(again, self.dictionary)
        return self.shown(change.added, "+") + self.shown(change.removed, "-")


def _short(term: object) -> str:
    return str(getattr(term, "value", term)).replace("urn:x:", ":")


def test_insertion_goes_through_recursion() -> None:
    """A link between two chains adds an ancestor for each pair across it."""
    kept = Kept(ANCESTORS, ":a :parent :b\n:c :parent :d")
    assert kept.change(":b :parent :c") == [
        "+:a :ancestor :c",
        "+:a :ancestor :d",
        "+:b :ancestor :c",
        "+:b :ancestor :d",
    ]


def test_deletion_keeps_what_has_another_derivation() -> None:
    """After deleting one of two routes, the triple is still derived by the other."""
    kept = Kept(ANCESTORS, ":a :parent :b\n:b :parent :c\n:a :parent :d\n:d :parent :c")
    assert kept.change(deleted=":b :parent :c") == ["-:b :ancestor :c"]


def test_deletion_ends_what_only_supports_itself() -> None:
    """On a cycle every ancestor is derived from another; without a link all are removed."""
    kept = Kept(ANCESTORS, ":a :parent :b\n:b :parent :a\n:x :parent :a")
    assert kept.change(deleted=":x :parent :a\n:a :parent :b") == [
        "-:a :ancestor :a",
        "-:a :ancestor :b",
        "-:b :ancestor :b",
        "-:x :ancestor :a",
        "-:x :ancestor :b",
    ]


def test_what_is_asserted_leaves_the_inferred_graph_and_comes_back() -> None:
    """Asserting an inferred triple, and retracting it, changes no dependent inference."""
    kept = Kept([*ANCESTORS, rule("?x :has :ancestors", "?x :ancestor ?y")], ":a :parent :b\n:b :parent :c")
    assert kept.change(":a :ancestor :c") == ["-:a :ancestor :c"]
    assert kept.change(deleted=":b :parent :c") == ["-:b :ancestor :c", "-:b :has :ancestors"]
    assert kept.change(":b :parent :c", ":a :ancestor :c") == [
        "+:a :ancestor :c",
        "+:b :ancestor :c",
        "+:b :has :ancestors",
    ]


def test_what_is_asserted_twice_or_was_not_there_changes_nothing() -> None:
    """A triple in both sets remains asserted."""
    kept = Kept(ANCESTORS, ":a :parent :b")
    assert kept.change(":a :parent :b", ":x :parent :y") == []
    assert kept.change(":a :parent :b", ":a :parent :b") == []


def test_negation_turns_comings_into_goings() -> None:
    """NOT over two atoms and a filter on a variable from outside."""
    friend = Exists((atom("?y :knows ?z"), atom("?z :is :kind"), keep("?z != ?x")), negated=True)
    kept = Kept([rule("?x :alone ?y", "?x :likes ?y", friend)], ":a :likes :b\n:c :likes :b\n:b :knows :c")
    assert kept.change(":c :is :kind") == ["-:a :alone :b"]
    assert kept.change(":b :knows :a\n:a :is :kind") == ["-:c :alone :b"]
    assert kept.change(deleted=":b :knows :c") == ["+:a :alone :b"]


def test_negation_inside_negation() -> None:
    """Nodes with only good parts."""
    bad = Exists((atom("?x :part ?y"), Exists((atom("?y :is :good"),), negated=True)), negated=True)
    kept = Kept([rule("?x :is :fine", "?x :a :Thing", bad)], ":t :a :Thing\n:t :part :p\n:t :part :q\n:p :is :good")
    assert kept.change(":q :is :good") == ["+:t :is :fine"]
    assert kept.change(":t :part :r") == ["-:t :is :fine"]
    assert kept.change(":r :is :good\n:u :a :Thing", ":p :is :good") == ["+:u :is :fine"]
    assert kept.change(deleted=":t :part :p") == ["+:t :is :fine"]


def test_aggregates_change_by_group() -> None:
    """A changed group replaces its value; an empty one is removed; without keys one group remains."""
    by_key = Aggregate((Variable("x"),), (COUNT,), (atom("?x :p ?y"),))
    everything = Aggregate((), (COUNT,), (atom("?x :p ?y"),))
    kept = Kept([rule("?x :count ?n", by_key), rule(":all :count ?n", everything)], ":a :p :b\n:a :p :c\n:b :p :c")
    assert kept.change(deleted=":a :p :b") == ["+:a :count 1", "+:all :count 2", "-:a :count 2", "-:all :count 3"]
    assert kept.change(deleted=":a :p :c\n:b :p :c") == [
        "+:all :count 0",
        "-:a :count 1",
        "-:all :count 2",
        "-:b :count 1",
    ]


def test_an_aggregate_without_a_value_derives_nothing() -> None:
    """A sum over IRIs has no value, so its variable in the head derives nothing."""
    total = Aggregate((Variable("x"),), (Column(Variable("n"), "SUM", expression("?y")),), (atom("?x :p ?y"),))
    kept = Kept([rule("?x :total ?n", total)], ":a :p :b\n:a :total :a")
    assert kept.change(deleted=":a :total :a") == []


def test_an_aggregate_of_an_aggregate() -> None:
    """The number of entities with a given number of parts."""
    inner = Aggregate((Variable("x"),), (COUNT,), (atom("?x :p ?y"),))
    outer = Aggregate((Variable("n"),), (Column(Variable("m"), "COUNT", None),), (inner,))
    kept = Kept([rule(":k :times ?m", outer)], ":a :p :b\n:a :p :c\n:b :p :c")
    assert kept.change(":c :p :d\n:d :p :a") == ["+:k :times 3"]
    assert kept.change(deleted=":a :p :b") == ["+:k :times 4", "-:k :times 1", "-:k :times 3"]


def test_blank_nodes_come_and_go_with_their_solutions() -> None:
    """The same solution gives the same blank node again."""
    kept = Kept([rule("?x :has _:n . _:n :of ?y", "?x :p ?y")], ":a :p :b")
    before = tuples(kept.state.inferred, kept.dictionary)
    assert kept.change(":a :p :c") == ["+:a :has []", "+[] :of :c"]
    assert kept.change(deleted=":a :p :b") == ["-:a :has []", "-[] :of :b"]
    assert kept.change(":a :p :b", ":a :p :c") == ["+:a :has []", "+[] :of :b", "-:a :has []", "-[] :of :c"]
    assert tuples(kept.state.inferred, kept.dictionary) == before


def test_assignments_variable_predicates_and_asserted_atoms() -> None:
    """Changed solutions get values; added and removed predicates are seen; `WHERE DATA` sees assertions."""
    plus = Assignment(Variable("m"), expression("?n + 1", mints=True))
    rules = [
        rule("?x :next ?m", "?x :age ?n", plus, name="test/plus"),
        rule("?p :used :yes", "?x ?p 1", name="test/used"),
        rule("?x :stated ?n", atom("?x :next ?n", asserted=True), name="test/stated"),
    ]
    kept = Kept(rules, ":a :age 1")
    assert kept.change(":b :age 0\n:a :size 1") == ["+:b :next 1", "+:next :used :yes", "+:size :used :yes"]
    assert kept.change(":b :next 1") == ["+:b :stated 1", "+:stated :used :yes", "-:b :next 1"]
    assert kept.change(deleted=":b :age 0\n:b :next 1\n:a :size 1") == [
        "-:b :stated 1",
        "-:next :used :yes",
        "-:size :used :yes",
        "-:stated :used :yes",
    ]


def test_blocks_of_sparql_are_run_again() -> None:
    """When an input predicate of a block changes, its derivations are compared."""
    block = EngineBlock(
        "?x <urn:x:p>+ ?y FILTER NOT EXISTS { ?y <urn:x:p> ?z }",
        (Variable("x"), Variable("y")),
        reads=frozenset({NamedNode("urn:x:p")}),
    )
    kept = Kept([rule("?x :ends ?y", block)], ":a :p :b\n:b :p :c")
    assert kept.change(":c :p :d") == ["+:a :ends :d", "+:b :ends :d", "+:c :ends :d", "-:a :ends :c", "-:b :ends :c"]
    assert kept.change(":c :q :d") == []


def test_auxiliary_triples_are_maintained_like_others() -> None:
    """They are part of the state and of the change, and omitted when writing to a store."""
    helper = f"={AUXILIARY}path"
    rules = [
        rule(f"?x {helper} ?y", "?x :parent ?y", part=1),
        rule(f"?x {helper} ?z", f"?x {helper} ?y . ?y :parent ?z", part=2),
        rule("?x :reaches ?y", f"?x {helper} ?y", part=3),
    ]
    kept = Kept(rules, ":a :parent :b")
    assert [line for line in kept.change(":b :parent :c") if ":reaches" in line] == [
        "+:a :reaches :c",
        "+:b :reaches :c",
    ]


def test_two_strata_may_derive_the_same_triple() -> None:
    """After one derivation is removed, that of the other stratum remains."""
    rules = [
        rule("?x :is :seen", "?x :p ?y", name="test/early"),
        rule("?x :is :seen", "?x :q ?y", Exists((atom("?y :is :hidden"),), negated=True), name="test/late"),
        rule("?x :is :hidden", "?x :r ?y", name="test/hidden"),
        rule("?x :looks :good", "?x :is :seen", name="test/reader"),
    ]
    kept = Kept(rules, ":a :p :b\n:a :q :b")
    assert kept.change(":b :r :c") == ["+:b :is :hidden"]
    assert kept.change(deleted=":b :r :c") == ["-:b :is :hidden"]
    assert kept.change(deleted=":a :p :b") == []
    assert kept.change(":b :r :c") == ["+:b :is :hidden", "-:a :is :seen", "-:a :looks :good"]
    assert kept.change(":a :p :c", ":b :r :c") == ["+:a :is :seen", "+:a :looks :good", "-:b :is :hidden"]


def test_limits_leave_the_state_as_it_was() -> None:
    """Terms created in recursion need a limit; exceeding it is KG205."""
    up = Assignment(Variable("m"), expression("IF(?n < 9, ?n + 1, ?n)", mints=True))
    kept = Kept([rule("?x :b ?y", "?x :a ?y")], ":a :a 1")
    kept.state = Maintained(
        Program([rule("?x :n ?m", "?x :n ?n", up)]), kept.dictionary, kept.facts(":a :m 1"), Facts()
    )
    with pytest.raises(RuleError, match="KG204"):
        kept.state.apply(kept.facts(":a :n 1"), Facts())
    for limits in (Limits(max_triples=5), Limits(deadline=0.0)):
        with pytest.raises(RuleError, match="KG205"):
            kept.state.apply(kept.facts(":a :n 1"), Facts(), limits=limits)
    assert not len(kept.state.inferred)
    change = kept.state.apply(kept.facts(":a :n 1"), Facts(), limits=Limits(max_triples=20))
    assert len(change.added) == 8


def test_one_change_by_itself() -> None:
    """The initial sets of a state remain unchanged."""
    kept = Kept(ANCESTORS, ":a :parent :b")
    asserted, inferred = kept.state.asserted, kept.state.inferred
    state = Maintained(kept.program, kept.dictionary, asserted, inferred)
    change = state.apply(kept.facts(":b :parent :c"), Facts())
    assert kept.shown(change.added, "+") == ["+:a :ancestor :c", "+:b :ancestor :c"]
    assert len(asserted) == 1
    assert len(inferred) == 1
