from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyoxigraph import Literal, NamedNode, Triple
from rules.engine.comparing import columns, inferred, tuples
from rules.engine.oracle import Fact, infer
from rules.forms import atoms, expression, rule, triples
from rules.forms import test as kept_if

from kg.errors import Place, RuleError
from kg.rules.engine import tables
from kg.rules.engine.evaluate import Limits, Program, evaluate
from kg.rules.engine.terms import Dictionary
from kg.rules.form import AUXILIARY, Aggregate, Assignment, Atom, Column, EngineBlock, Expression, Values, Variable


def facts(text: str) -> set[Fact]:
    """Parse triples to tuples."""
    return {(triple.subject, triple.predicate, triple.object) for triple in triples(text)}


XSD = "http://www.w3.org/2001/XMLSchema#"
CHAIN = facts("\n".join(f":n{number} :next :n{number + 1}" for number in range(30)))
COUNTING = rule("?x :n ?m", "?x :n ?k", Assignment(Variable("m"), expression("?k + 1", mints=True)))


def test_a_limit_of_triples_ends_what_would_not_end() -> None:
    """KG205 names the rule and the round; asserted triples are unchanged."""
    dictionary = Dictionary()
    asserted = columns(facts(":a :n 1"), dictionary)
    with pytest.raises(RuleError, match=r"KG205: more than 20 triples are inferred, at rule test/rule, round 2\d;"):
        evaluate(Program([COUNTING]), dictionary, asserted, limits=Limits(max_triples=20))
    assert tuples(asserted, dictionary) == facts(":a :n 1")


def test_a_rule_that_derives_too_much_at_once_is_stopped_before_it_is_through() -> None:
    """All pairs of three thousand nodes are never stored: the first pieces exceed the limit."""
    nodes = {(NamedNode(f"urn:x:n{number}"), NamedNode("urn:x:is"), NamedNode("urn:x:node")) for number in range(3000)}
    with pytest.raises(RuleError, match="KG205: more than 100,000 triples are inferred, at rule test/rule, round 1;"):
        inferred([rule("?x :beside ?y", "?x :is ?c . ?y :is ?d")], nodes, Limits(max_triples=100_000))


def test_known_triples_do_not_count_towards_a_limit() -> None:
    """A rule that derives asserted triples stays within a limit of zero."""
    assert inferred([rule("?x :next ?y", "?x :next ?y")], CHAIN, Limits(max_triples=0)) == set()


def test_a_deadline_ends_a_run() -> None:
    """A run without time left ends with KG205."""
    with pytest.raises(RuleError, match="KG205: the deadline of 0 s is over"):
        inferred([rule("?x :p ?y", "?x :next ?y")], CHAIN, Limits(deadline=0))


def test_making_terms_in_recursion_needs_a_limit() -> None:
    """KG204 before any rule runs."""
    with pytest.raises(RuleError, match="KG204"):
        inferred([COUNTING], facts(":a :n 1"))


def test_reports_tell_rounds_triples_and_where_a_body_ends() -> None:
    """A rule reports the triples it derived first, and the rows after each element of its body."""
    dictionary = Dictionary()
    rules = [
        rule("?x :on ?y", "?x :next ?y", name="t/first"),
        rule("?x :on ?z", "?x :on ?y . ?y :next ?z", name="t/on"),
        rule("?x :never ?y", "?x :next ?y . ?y :missing ?z . ?z :next ?w", name="t/never"),
    ]
    outcome = evaluate(Program(rules), dictionary, columns(CHAIN, dictionary))
    by_name = {report.rule.name: report for report in outcome.reports}
    assert by_name["t/first"].derived == 30
    assert by_name["t/on"].derived == 30 * 29 // 2
    assert by_name["t/on"].rounds == 30
    assert by_name["t/never"].matched == (0, 0, 0)
    assert len(outcome.inferred) == 30 * 31 // 2


def test_each_derivation_of_a_rule_with_two_recursive_atoms_is_tried_once() -> None:
    """The rows joined by the rule are the pairs of steps of the closure, none of them twice."""
    rules = [rule("?x :on ?y", "?x :next ?y"), rule("?x :on ?z", "?x :on ?y . ?y :on ?z", part=2)]
    dictionary = Dictionary()
    outcome = evaluate(Program(rules), dictionary, columns(CHAIN, dictionary))
    assert min(outcome.reports[1].matched[1:]) <= 31 * 30 * 29 // 6


def test_the_same_program_gives_the_same_blank_nodes_again() -> None:
    """Blank nodes of heads depend only on rule, label and solution."""
    rules = [rule("?x :has _:b . _:b :of ?y", "?x :next ?y")]
    assert inferred(rules, CHAIN) == inferred(rules, CHAIN) == infer(rules, CHAIN)
    assert len(inferred(rules, CHAIN)) == 60


def test_what_no_triple_can_be_is_left_out() -> None:
    """A literal as subject or a blank node as predicate gives nothing, as in CONSTRUCT."""
    rules = [rule("?y :p ?x", "?x :n ?y"), rule("?x ?y ?x", "?x :n ?y", part=2)]
    assert inferred(rules, facts(":a :n 1")) == set()
    assert inferred(rules, facts(":a :n _:b")) == facts("_:b :p :a")


def test_auxiliary_triples_are_read_by_name_only() -> None:
    """A variable predicate does not match predicates of decomposition."""
    helper = NamedNode(AUXILIARY + "1")
    first = rule("?x :p ?y", "?x :next ?y")
    hidden = type(first)("t/a", (Atom(Variable("x"), helper, Variable("y")),), first.body, first.place)
    copied = rule("?x :all ?p", "?x ?p ?y", name="t/b")
    named = type(first)("t/c", first.head, (Atom(Variable("x"), helper, Variable("y")),), first.place)
    found = inferred([hidden, copied, named], facts(":a :next :b"))
    seen = {fact[2] for fact in found if fact[1] == NamedNode("urn:x:all")}
    assert seen == {NamedNode(f"urn:x:{name}") for name in ("next", "p", "all")}


def test_a_block_of_sparql_joins_like_an_atom() -> None:
    """Its unbound variables give no triple; a monotone block may be recursive."""
    reads = frozenset({NamedNode("urn:x:next"), NamedNode("urn:x:name")})
    block = EngineBlock(
        "?x <urn:x:next> ?y OPTIONAL { ?y <urn:x:name> ?n }",
        (Variable("x"), Variable("y"), Variable("n")),
        (Variable("n"),),
        reads,
        monotone=True,
    )
    rules = [rule("?x :named ?n . ?x :to ?y . ?y :next ?y", block, "?x :next ?y")]
    asserted = CHAIN | facts(":n3 :name :three")
    assert inferred(rules, asserted) == infer(rules, asserted)


def test_a_block_that_the_engine_cannot_evaluate_is_an_error_at_its_place() -> None:
    """The engine fails where a row of VALUES has a literal as the subject of a triple term."""
    text = "?z <urn:x:r> <<( ?x <urn:x:p> ?y )>> . VALUES (?x ?y) { (1 <urn:x:a>) (1 <urn:x:b>) }"
    place = Place("rule.rq", 2, 3)
    reads = frozenset({NamedNode("urn:x:r")})
    block = EngineBlock(text, (Variable("x"), Variable("y"), Variable("z")), reads=reads, place=place)
    statement = Triple(NamedNode("urn:x:a"), NamedNode("urn:x:p"), NamedNode("urn:x:b"))
    with pytest.raises(RuleError, match="cannot evaluate") as caught:
        inferred([rule("?z :h ?y", block)], [(NamedNode("urn:x:c"), NamedNode("urn:x:r"), statement)])
    assert (caught.value.code, caught.value.place) == ("KG209", place)


def test_a_join_that_grows_is_chosen_by_the_rows_of_the_terms_at_hand() -> None:
    """Friends are joined before members of a crowded hub, although the average hub is smaller."""
    lines = [f":n{n} :at :hub\n:n{n} :friend :m{n}\n:n{n} :friend :x{n}" for n in range(100)]
    lines += [f":hub :member :m{n}" for n in range(1000)]
    lines += [f":hub{n} :member :m{n}" for n in range(4000)]
    dictionary = Dictionary()
    meeting = rule("?n :meets ?m", "?n :at ?h . ?h :member ?m . ?n :friend ?m")
    (report,) = evaluate(Program([meeting]), dictionary, columns(facts("\n".join(lines)), dictionary)).reports
    assert (report.derived, max(report.matched)) == (100, 200)


def test_a_cycle_costs_the_shorter_side_of_each_row() -> None:
    """A hub with 500 neighbours each way costs 500 triangles, not 250,000 paths."""
    lines = [f":in{n} :to :hub\n:hub :to :out{n}\n:out{n} :to :in{n}" for n in range(500)]
    dictionary = Dictionary()
    triangle = rule("?x :with ?y", "?x :to ?y . ?y :to ?z . ?z :to ?x")
    (report,) = evaluate(Program([triangle]), dictionary, columns(facts("\n".join(lines)), dictionary)).reports
    assert (report.derived, sum(report.matched)) == (1500, 4500)


@given(st.lists(st.integers(0, 99)), st.sets(st.integers(0, 99)))
def test_what_a_sorted_array_has_is_told_for_few_and_many(values: list[int], ordered: set[int]) -> None:
    """The hash table excludes only missing values."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tables, "_MANY", 0)
        found = tables.among(np.array(values * 5, np.int64), np.array(sorted(ordered), np.int64))
    assert found.tolist() == [value in ordered for value in values * 5]


def test_large_joins_are_done_in_pieces() -> None:
    """A join of many rows gives the same result as one of few: all pairs of two thousand nodes that share a hub."""
    spokes = {(NamedNode(f"urn:x:s{number}"), NamedNode("urn:x:in"), NamedNode("urn:x:hub")) for number in range(2200)}
    pairs = rule("?x :big :yes", "?x :in ?h . ?y :in ?h", kept_if("?x != ?y"))
    assert len(inferred([pairs], spokes)) == 2200


@pytest.mark.parametrize(
    ("function", "values", "expected"),
    [
        ("SUM", "1 2", '"3"^^<http://www.w3.org/2001/XMLSchema#integer>'),
        ("MIN", "2 1", '"1"^^<http://www.w3.org/2001/XMLSchema#integer>'),
        ("SUM", "1 2.5", '"3.5"^^<http://www.w3.org/2001/XMLSchema#decimal>'),
        ("AVG", "1 2", '"1.5"^^<http://www.w3.org/2001/XMLSchema#decimal>'),
        ("MAX", "1 2.0e0", '"2"^^<http://www.w3.org/2001/XMLSchema#double>'),
        ("GROUP_CONCAT", '"b" "a"', '"a b"'),
        ("SAMPLE", '"b" "a"', '"a"'),
    ],
)
def test_aggregates_have_the_types_of_sparql(function: str, values: str, expected: str) -> None:
    """Numbers are promoted, strings are ordered by their spelling."""
    texts = {"1": Literal(1), "2": Literal(2), "2.5": Literal("2.5", datatype=NamedNode(XSD + "decimal"))}
    texts |= {"2.0e0": Literal(2.0), '"a"': Literal("a"), '"b"': Literal("b")}
    rows = Values((Variable("v"),), tuple((texts[value],) for value in values.split()))
    column = Column(Variable("r"), function, Expression("?v", ("v",)))
    ((_, _, value),) = inferred([rule(":a :is ?r", Aggregate((), (column,), (rows,)))], set())
    assert str(value) == expected


@pytest.mark.parametrize("atoms_first", [True, False])
@pytest.mark.parametrize(("least", "expected"), [("", ":a :is 1\n:b :is 2"), (":c :limit 2", ":b :is 2")])
def test_an_aggregate_without_a_value_agrees_with_any(least: str, expected: str, *, atoms_first: bool) -> None:
    """MIN of nothing leaves its variable unbound, and the next atom binds it; MIN of values restricts it."""
    column = Column(Variable("y"), "MIN", expression("?l"), distinct=False)
    smallest = Aggregate((), (column,), atoms("?z :limit ?l"))
    atom = "?x :size ?y"
    body = (atom, smallest) if atoms_first else (smallest, atom)
    assert inferred([rule("?x :is ?y", *body)], facts(f":a :size 1\n:b :size 2\n{least}")) == facts(expected)


def test_counting_nothing_is_zero_without_keys_and_no_group_with_them() -> None:
    """SPARQL 1.1, section 11.2."""
    column = Column(Variable("n"), "COUNT", None)
    alone = rule(":all :count ?n", Aggregate((), (column,), atoms("?x :missing ?y")))
    keyed = rule("?x :count ?n", Aggregate((Variable("x"),), (column,), atoms("?x :missing ?y")), part=2)
    assert inferred([alone, keyed], CHAIN) == facts(":all :count 0")


def test_many_values_join_with_many_triples() -> None:
    """Each of a hundred values joins with each of eighty triples, if neither restricts the other."""
    values = Values((Variable("v"),), tuple((NamedNode(f"urn:x:v{number}"),) for number in range(100)))
    asserted = facts("\n".join(f":n{number} :p :o" for number in range(80)))
    assert len(inferred([rule("?x :with ?v", "?x :p ?o", values)], asserted)) == 8000


@pytest.mark.parametrize("body", ["?x :q ?y", "?x :p :c", "?x :absent :c", ":c :q ?x", "?x :p ?y . ?y :q :b"])
def test_a_rule_is_planned_only_if_each_of_its_atoms_has_triples(body: str) -> None:
    """Most rules of a small workspace lack some; they run, and match nothing."""
    dictionary, given = Dictionary(), rule("?x :r ?x", body)
    program = Program([given])
    every = ":a :p :b\n:a :p :c\n:b :q :b\n:c :q :a\n:d :absent :c"
    for text, planned in ((":a :p :b", False), (every, True)):
        (report,) = evaluate(program, dictionary, columns(facts(text), dictionary)).reports
        assert (given in program.plans(dictionary), report.rounds, report.derived > 0) == (planned, 1, planned)


def test_an_atom_of_asserted_triples_needs_asserted_triples() -> None:
    """Triples that another rule derived do not count."""
    dictionary = Dictionary()
    reads = rule("?x :r ?y", *(replace(atom, asserted=True) for atom in atoms("?x :q ?y")))
    program = Program([rule("?x :q ?y", "?x :p ?y"), reads])
    assert not len(evaluate(program, dictionary, columns(facts(":a :r :b"), dictionary)).inferred)
    assert reads not in program.plans(dictionary)
