"""Why facts hold: proofs are sound, end in asserted facts, and have the guaranteed length."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyoxigraph import Quad
from rules.explain.worlds import BUILDS, EX, INFERRED, World, bound, fact, rule, where, without

from kg.errors import RuleError
from kg.rules.explain.proof import Condition, Proof
from kg.rules.explain.view import View, Vocabulary
from kg.rules.explain.why import why, why_all
from kg.rules.reading import read_text

if TYPE_CHECKING:
    from pyoxigraph import Triple

    from kg.rules.form import Rule

PARENT = rule("family/parent", "?x ancestor ?y", "?x parent ?y")
LINEAR = rule("family/linear", "?x ancestor ?z", "?x ancestor ?y", "?y parent ?z")
ADOPTED = rule("family/adopted", "?x ancestor ?y", "?x adopted ?y")
KNOWN = rule("family/known", "?x knows ?y", "?x ancestor ?y")
DOUBLE = rule("family/double", "?x ancestor ?z", "?x ancestor ?y", "?y ancestor ?z")
SAME = rule("family/same", "?y knows ?x", "?x knows ?y")


def leaves(proof: Proof) -> set[Triple]:
    """Return the asserted facts at the leaves of a proof."""
    return {each.fact for _, each in proof.walk() if isinstance(each, Proof) and each.derivation is None}


def check(proof: Proof, above: tuple[Triple, ...] = ()) -> None:
    """Assert that a proof is valid: no fact rests on itself, and facts not derived are asserted."""
    assert proof.fact not in above
    if proof.derivation is None:
        assert proof.graphs
        return
    premises = [premise for premise in proof.premises if isinstance(premise, Proof)]
    assert [premise.fact for premise in premises] == list(proof.derivation.facts)
    for premise in premises:
        check(premise, (*above, proof.fact))


def test_an_asserted_fact_is_its_own_proof_with_its_line() -> None:
    """An asserted fact is explained by its graph and the line of code it was read from."""
    world = World(':n :has :p . :p :path "src/a.cpp" ; :line 128 .', ())
    proof = why(world.view, (), fact("n has p"))
    assert (proof.graphs, str(proof.evidence)) == (("https://example.org/graph/asserted",), "src/a.cpp:128")


def test_a_chain_ends_in_what_was_asserted() -> None:
    """A fact derived by recursion depends on each step of the chain."""
    world = World(":a :parent :b . :b :parent :c . :c :parent :d .", (PARENT, LINEAR))
    proof = why(world.view, world.rules, fact("a ancestor d"))
    check(proof)
    assert leaves(proof) == {fact("a parent b"), fact("b parent c"), fact("c parent d")}
    assert proof.derivation is not None
    assert (proof.derivation.rule.name, proof.derivation.bindings["y"]) == ("family/linear", fact("c c c").subject)


def test_cycles_prove_nothing() -> None:
    """Two facts that derive each other depend on the asserted one."""
    world = World(":a :knows :b .", (SAME,))
    check(why(world.view, world.rules, fact("b knows a")))
    world.store.remove(next(iter(world.store.quads_for_pattern(None, None, fact("b b b").object))))
    with pytest.raises(RuleError, match="does not contain"):
        why(world.view, world.rules, fact("a knows b"))
    with pytest.raises(RuleError, match="no active rule derives"):
        why(world.view, world.rules, fact("b knows a"))


def test_all_ways() -> None:
    """Every derivation of a fact is returned, the smallest first."""
    world = World(
        ":a :parent :b . :b :parent :c . :a :adopted :c .",
        (PARENT, LINEAR, ADOPTED),
    )
    ways = why_all(world.view, world.rules, fact("a ancestor c"))
    assert [way.derivation.rule.name for way in ways if way.derivation] == ["family/adopted", "family/linear"]


def test_the_shortest_proof() -> None:
    """The shortest proof has the fewest steps, despite recursion."""
    world = World(" ".join(f":n{i} :parent :n{i + 1} ." for i in range(8)), (PARENT, DOUBLE))
    proof = why(world.view, world.rules, fact("n0 ancestor n8"), shortest=True)
    check(proof)
    assert len({each.fact for _, each in proof.walk() if isinstance(each, Proof)}) == 8 + 8 + 7


def test_conditions_are_told() -> None:
    """Filters, assignments and absent facts are conditions in the proof."""
    parts = ("?x parent ?y", where("?x != ?y"), without("?y parent ?z"), bound("s", "STR(?y)"))
    world = World(":a :parent :b .", (rule("x/y", "?x child ?s", *parts),))
    proof = why(world.view, world.rules, world.inferred()[0])
    texts = [premise.text for premise in proof.premises if isinstance(premise, Condition)]
    assert [text.split()[0] for text in texts] == ["FILTER(?x", "FILTER", "BIND(STR(?y)"]


def test_graphs_that_rules_do_not_read_prove_nothing() -> None:
    """A fact only in the graph of builds is not a premise."""
    world = World(":a :parent :b . :b :parent :c .", (PARENT, LINEAR))
    moved = fact("b parent c")
    world.store.remove(next(iter(world.store.quads_for_pattern(moved.subject, moved.predicate, moved.object))))
    world.store.add(Quad(moved.subject, moved.predicate, moved.object, BUILDS))
    with pytest.raises(RuleError, match="no active rule derives"):
        why(world.view, world.rules, fact("a ancestor c"))


def test_a_long_chain() -> None:
    """A proof of a thousand steps is found and traversed."""
    world = World(" ".join(f":n{i} :next :n{i + 1} ." for i in range(1200)) + " :n0 :reached :n0 .", ())
    step = rule("x/step", "?y reached ?y", "?x reached ?x", "?x next ?y")
    for i in range(1, 1201):
        each = fact(f"n{i} reached n{i}")
        world.store.add(Quad(each.subject, each.predicate, each.object, INFERRED))
    proof = why(world.view, (step,), fact("n1200 reached n1200"))
    assert len(list(proof.walk())) == 2 * 1200 + 1


EDGES = st.lists(st.tuples(st.integers(0, 4), st.integers(0, 4)), min_size=1, max_size=8, unique=True)
RULES = st.lists(st.sampled_from([PARENT, LINEAR, DOUBLE, SAME, KNOWN]), min_size=1, unique=True)


@settings(deadline=None, max_examples=40)
@given(EDGES, RULES)
def test_every_inferred_fact_has_a_sound_proof(edges: list[tuple[int, int]], chosen: list[Rule]) -> None:
    """Every inference of any rules from any graph has a proof that ends in asserted facts."""
    world = World(" ".join(f":n{a} :parent :n{b} ." for a, b in edges), tuple(chosen))
    for each in world.inferred():
        check(why(world.view, world.rules, each))
        assert all(leaves(way) for way in why_all(world.view, world.rules, each))


def test_paths_of_any_length() -> None:
    """A path of any length is proved by the triples of a shortest route."""
    text = f"PREFIX : <{EX}> CONSTRUCT {{ ?x :reaches ?y }} WHERE {{ ?x (:next|^:before/:next)+ ?y . ?y :is :goal }}"
    rules = read_text(text, Path("x/reaches.rq"), "x/reaches").rules
    world = World(":a :next :b . :c :before :b ; :next :d . :b :next :e . :d :is :goal .", ())
    each = fact("a reaches d")
    world.store.add(Quad(each.subject, each.predicate, each.object, INFERRED))
    view = View(world, Vocabulary(INFERRED), rules)
    proof = why(view, rules, each)
    assert leaves(proof) == {fact("a next b"), fact("c before b"), fact("c next d"), fact("d is goal")}


EQUALITY = (
    rule("equal/symmetry", "?y same ?x", "?x same ?y"),
    rule("equal/transitivity", "?x same ?z", "?x same ?y", "?y same ?z"),
    rule("equal/subject", "?y ?p ?o", "?x same ?y", "?x ?p ?o"),
    rule("equal/object", "?s ?p ?y", "?x same ?y", "?s ?p ?x"),
)


@pytest.mark.parametrize("text", ["a same e", "e same a", "c same c", "a has p", "a has q"])
def test_what_equal_terms_share_is_proven_from_what_was_asserted(text: str) -> None:
    """Terms at the ends of a chain, a term and itself, and triples replaced in subject and object."""
    world = World(":a :same :b . :b :same :c . :c :same :d . :d :same :e . :e :has :p . :q :same :p .", EQUALITY)
    proof = why(world.view, world.rules, fact(text))
    check(proof)
    assert leaves(proof) <= {
        fact(each) for each in ("a same b", "b same c", "c same d", "d same e", "e has p", "q same p")
    }
