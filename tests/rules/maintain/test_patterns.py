"""Rules affected by a change: the others are not evaluated, and no effect is missed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from pyoxigraph import BlankNode, NamedNode
from rules.forms import atom, rule
from rules.forms import test as keep
from rules.maintain.test_maintaining import COUNT, Kept

from kg.rules.engine.facts import Facts, pack
from kg.rules.form import Aggregate, Atom, EngineBlock, Exists, Variable
from kg.rules.maintain.deriving import MaintainedRule
from kg.rules.maintain.patterns import ANY, Patterns, pattern

if TYPE_CHECKING:
    from kg.rules.engine.tables import Table


@pytest.fixture
def solved(monkeypatch: pytest.MonkeyPatch) -> set[str]:
    """Return the names of the evaluated rules."""
    found: set[str] = set()
    solve = MaintainedRule._derived

    def noting(self: MaintainedRule, sources: list[Facts], seeds: Table) -> Facts:
        found.add(self.plan.rule.name)
        return solve(self, sources, seeds)

    monkeypatch.setattr(MaintainedRule, "_derived", noting)
    return found


def test_a_pattern_is_of_a_predicate_and_an_object_that_rules_name() -> None:
    """Objects that no rule names are not distinguished; variables match any."""
    assert pattern("?p", 3) == ANY
    patterns = Patterns([pattern(7, 3), pattern(7, 4), pattern(8, "?x")])
    facts = Facts()
    assert patterns.of(facts) == set()
    facts.replace(7, pack(np.array([1, 2]), np.array([4, 5])))
    facts.replace(8, pack(np.array([1]), np.array([3])))
    assert patterns.of(facts) == {ANY, pattern(7, None), pattern(7, 4), pattern(8, None)}


def test_rules_of_other_classes_are_not_solved(solved: set[str]) -> None:
    """All read the same predicate; only rules of the added class, and then of its consequences, are evaluated."""
    rules = [rule(f"?x :is :d{n}", f"?x :is :c{n}", name=f"test/r{n}") for n in range(5)]
    rules.append(rule("?x :is :e", "?x :is :d3 . ?x :p ?y", name="test/further"))
    kept = Kept(rules, ":b :is :c1\n:a :p :c")
    assert kept.change(":a :is :c3") == ["+:a :is :d3", "+:a :is :e"]
    assert solved == {"test/r3", "test/further"}
    solved.clear()
    assert kept.change(deleted=":a :is :c3") == ["-:a :is :d3", "-:a :is :e"]
    assert "test/r1" not in solved


def test_rules_of_which_no_changed_triple_meets_the_other_atoms_are_not_solved(solved: set[str]) -> None:
    """Each atom that shares a variable with the change needs a triple, at either end or at both."""
    rules = [
        rule("?x :is :far", "?x :is :seen . ?x :p ?y", name="test/from"),
        rule("?x :is :near", "?x :is :seen . ?y :p ?x", name="test/to"),
        rule("?x :is :named", "?x :is :seen . ?x :is :thing", name="test/named"),
        rule("?x :both ?y", "?x :p ?y . ?y :p ?x", name="test/both"),
    ]
    kept = Kept(rules, ":b :p :c\n:c :is :thing")
    assert kept.change(":a :is :seen") == []
    assert solved == set()
    assert kept.change(":b :is :seen") == ["+:b :is :far"]
    assert solved == {"test/from"}
    assert kept.change(":c :is :seen") == ["+:c :is :named", "+:c :is :near"]
    assert kept.change(":c :p :d") == ["+:c :is :far"]
    assert "test/both" not in solved
    assert kept.change(":c :p :b") == ["+:b :both :c", "+:b :is :near", "+:c :both :b"]


def test_what_was_asserted_and_follows_too_stays_though_nothing_that_its_rule_reads_changed() -> None:
    """A stratum is affected by triples it may derive, not only by its input; in recursion, too."""
    rules = [
        rule("?x :is :seen", "?x :p ?y", name="test/seen"),
        rule("?x :is :far", "?x :is :seen", name="test/far"),
        rule("?x :near ?y", "?x :p ?y", name="test/near"),
        rule("?x :near ?z", "?x :near ?y . ?y :near ?z", name="test/nearer"),
    ]
    kept = Kept(rules, ":a :p :b\n:b :p :c\n:a :is :seen\n:a :near :c\n:z :is :seen")
    assert kept.change(deleted=":a :is :seen") == ["+:a :is :seen"]
    assert kept.change(deleted=":a :near :c") == ["+:a :near :c"]
    assert kept.change(deleted=":z :is :seen") == ["-:z :is :far"]


def test_negation_and_aggregates_are_reached_through_what_they_hold() -> None:
    """Only the triples inside are added and removed."""
    rules = [
        rule("?x :is :free", "?x :is :node", Exists((atom("?x :is :taken"),), negated=True), name="test/free"),
        rule("?x :size ?n", Aggregate((Variable("x"),), (COUNT,), (atom("?x :has ?y"),)), name="test/size"),
        rule("?x :is :big", "?x :size 2", name="test/big"),
    ]
    kept = Kept(rules, ":a :is :node\n:a :has :b")
    assert kept.change(":a :is :taken") == ["-:a :is :free"]
    assert kept.change(":a :has :c") == ["+:a :is :big", "+:a :size 2", "-:a :size 1"]
    assert kept.change(deleted=":a :is :taken\n:a :has :b") == [
        "+:a :is :free",
        "+:a :size 1",
        "-:a :is :big",
        "-:a :size 2",
    ]


def test_a_negated_body_in_two_parts_is_reached_from_either() -> None:
    """A part joined with the change only by a filter is not multiplied with it, and decides as before."""
    differ = (atom("?x :type ?one"), atom("?y :type ?two"), keep("?one != ?two"))
    kept = Kept(
        [rule("?x :fits ?y", "?x :to ?y", Exists(differ, negated=True))],
        ":a :to :b\n:a :type :t\n:b :type :t\n:c :to :d\n:c :type :t",
    )
    assert kept.change(":d :type :u") == ["-:c :fits :d"]
    assert kept.change(":d :type :t", ":d :type :u") == ["+:c :fits :d"]
    assert kept.change(":a :type :u") == ["-:a :fits :b"]
    assert kept.change(deleted=":a :type :u\n:a :type :t") == ["+:a :fits :b"]


def test_rules_that_lacked_something_fire_when_it_comes() -> None:
    """Created nodes are added with the last premise of a rule, in any order, and removed with the first."""
    head = Atom(Variable("x"), atom("?x :made ?y").predicate, BlankNode("new"))
    made = rule("?x :made ?y", "?x :p ?y . ?y :q ?z . ?z :is :last", name="test/made")
    kept = Kept([type(made)(made.name, (head,), made.body, made.place)], "")
    for part in (":b :q :c", ":a :p :b"):
        assert kept.change(part) == []
    assert kept.change(":c :is :last") == ["+:a :made []"]
    assert kept.change(deleted=":b :q :c") == ["-:a :made []"]
    assert kept.change(":b :q :c") == ["+:a :made []"]


def test_rules_with_variable_predicates_are_reached_from_any_and_reach_any() -> None:
    """A rule that copies triples of any predicate is affected by, and derives, every change."""
    rules = [
        rule("?p :same ?q", "?q :mirrors ?p", name="test/same"),
        rule("?x ?q ?y", "?p :same ?q . ?x ?p ?y", name="test/copy"),
        rule("?x :is :far", "?x :is :near", name="test/far"),
    ]
    kept = Kept(rules, ":is :mirrors :kind\n:a :kind :near")
    assert kept.change(":b :kind :near") == ["+:b :is :far", "+:b :is :near"]
    assert kept.change(":b :is :near") == ["-:b :is :near"]
    assert kept.change(deleted=":b :is :near") == ["+:b :is :near"]
    assert kept.change(deleted=":b :kind :near") == ["-:b :is :far", "-:b :is :near"]
    assert kept.change(deleted=":is :mirrors :kind") == ["-:a :is :far", "-:a :is :near", "-:kind :same :is"]


def test_negation_and_blocks_are_reached_by_what_other_strata_derive() -> None:
    """Inner predicates are never asserted; strata before and after each other change in one step."""
    x, y, link = Variable("x"), Variable("y"), NamedNode("urn:x:link")
    walk = EngineBlock(f"?x {link}/{link}* ?y", (x, y), reads=frozenset({link}))
    rules = [
        rule("?x :link ?y", "?x :to ?y", name="test/link"),
        rule("?x :is :end", "?x :state :stopped", name="test/end"),
        rule("?x :rank :free", "?x :is :node", Exists((walk, atom("?y :is :end")), negated=True), name="test/free"),
        rule("?k :number ?n", Aggregate((Variable("k"),), (COUNT,), (atom("?x :rank ?k"),)), name="test/number"),
    ]
    kept = Kept(rules, ":a :is :node\n:b :is :node\n:a :to :b")
    assert kept.change(":b :state :stopped") == [
        "+:b :is :end",
        "+:free :number 1",
        "-:a :rank :free",
        "-:free :number 2",
    ]
    assert kept.change(":b :to :c", ":a :to :b") == [
        "+:a :rank :free",
        "+:b :link :c",
        "+:free :number 2",
        "-:a :link :b",
        "-:free :number 1",
    ]
    assert kept.change(":a :rank :free\n:a :to :b") == ["+:a :link :b", "-:a :rank :free"]
    assert kept.change(deleted=":a :rank :free") == ["+:free :number 1", "-:free :number 2"]
    assert kept.change(deleted=":b :state :stopped") == [
        "+:a :rank :free",
        "+:free :number 2",
        "-:b :is :end",
        "-:free :number 1",
    ]
