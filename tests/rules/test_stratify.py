from __future__ import annotations

from dataclasses import replace

import pytest
from pyoxigraph import NamedNode
from rules.forms import atom, atoms, expression, rule

from kg.errors import RuleError
from kg.rules.form import Aggregate, Assignment, Atom, Column, Exists, Variable
from kg.rules.stratify import stratify

NOT_Q = Exists(atoms("?x :q ?x"), negated=True)


def names(*rules: object) -> list[tuple[list[str], bool]]:
    """Return the names in each stratum and whether it is recursive."""
    return [([each.name for each in stratum.rules], stratum.recursive) for stratum in stratify(rules)]  # type: ignore[arg-type]  # rules


def test_rules_run_after_those_that_they_read() -> None:
    """A chain of rules gives one stratum each, in dependency order."""
    last = rule("?x :c ?y", "?x :b ?y", name="t/last")
    first = rule("?x :a ?y", "?x :given ?y", name="t/first")
    middle = rule("?x :b ?y", "?x :a ?y", name="t/middle")
    assert names(last, first, middle) == [(["t/first"], False), (["t/middle"], False), (["t/last"], False)]


def test_rules_that_feed_each_other_are_one_recursive_stratum() -> None:
    """Mutual recursion is one component; its readers come after it."""
    one = rule("?x :a ?y", "?x :b ?y", name="t/one")
    two = rule("?x :b ?y", "?y :a ?x", name="t/two")
    out = rule("?x :c ?y", "?x :a ?y", NOT_Q, name="t/out")
    assert names(out, one, two) == [(["t/one", "t/two"], True), (["t/out"], False)]


def test_constants_keep_rules_apart() -> None:
    """A rule that types as A and reads B does not feed itself."""
    assert names(rule("?x :type :A", "?x :type :B")) == [(["test/rule"], False)]


def test_order_decides_where_dependencies_leave_it_open() -> None:
    """A lower `sh:order` runs first, unless it reads derivations of a higher one."""
    early = replace(rule("?x :a ?y", "?x :given ?y", name="t/early"), order=-1.0)
    late = replace(rule("?x :b ?y", "?x :given ?y", name="t/late"), order=2.0)
    reader = replace(rule("?x :c ?y", "?x :b ?y", name="t/reader"), order=-2.0)
    assert [name for (name,), _ in names(late, reader, early)] == ["t/early", "t/late", "t/reader"]


def test_negation_of_what_a_rule_feeds_is_refused_rule_by_rule() -> None:
    """KG202 has the cycle from the negating rule back to it, at the place of the negated atom."""
    place = replace(rule("?x :p ?x").place, path="p.rq", line=7)
    negated = replace(atom("?x :q ?x"), place=place)
    one = rule("?x :p ?x", "?x :node ?x", Exists((negated,), negated=True), name="t/one")
    two = rule("?x :q ?x", "?x :p ?x", name="t/two")
    with pytest.raises(RuleError) as raised:
        stratify([one, two])
    assert raised.value.code == "KG202"
    assert raised.value.place == place
    assert raised.value.message == (
        "the rules cannot be stratified: t/one negates or counts ?x <urn:x:q> ?x (p.rq:7), which t/two derives; "
        "t/two reads ?x <urn:x:p> ?x, which t/one derives"
    )


def test_the_cycle_has_no_variables_of_kg() -> None:
    """In the words of KG202, a blank node is `[]` and a copy of a variable has the name of the variable."""
    negated = Exists((Atom(Variable(".g1"), NamedNode("urn:x:q"), Variable("x\u00b71")),), negated=True)
    with pytest.raises(RuleError) as raised:
        stratify([rule("?x :p ?x", "?x :node ?x", negated), rule("?x :q ?x", "?x :p ?x")])
    assert "negates or counts [] <urn:x:q> ?x," in raised.value.message


def test_counting_what_a_rule_feeds_is_refused() -> None:
    """An aggregate over its own rule's triples is KG202."""
    count = Aggregate((Variable("x"),), (Column(Variable("n"), "COUNT", None),), atoms("?x :p ?y"))
    with pytest.raises(RuleError, match="KG202"):
        stratify([rule("?x :p ?n", count)])


def test_a_rule_may_negate_asserted_data_of_what_it_derives() -> None:
    """NOT DATA depends on no rule."""
    negated = Exists((atom("?x :p ?y", asserted=True),), negated=True)
    assert names(rule("?x :p ?y", "?x :q ?y", negated)) == [(["test/rule"], False)]


def test_making_terms_in_recursion_is_refused_unless_bounded() -> None:
    """KG204 for a computed value or a blank node in a rule that feeds itself."""
    counting = rule("?x :n ?m", "?x :n ?k", Assignment(Variable("m"), expression("?k + 1", mints=True)))
    blank = rule("_:b :n ?x", "?x :n ?y")
    for each in (counting, blank):
        with pytest.raises(RuleError, match="KG204"):
            stratify([each])
        assert stratify([each], bounded=True)[0].recursive


def test_long_chains_of_rules_need_no_deep_stack() -> None:
    """Five thousand rules in a row are stratified."""
    rules = [rule(f"?x :p{number + 1} ?y", f"?x :p{number} ?y", name=f"t/{number}") for number in range(5000)]
    assert len(stratify(reversed(rules))) == 5000


def test_a_long_cycle_is_told_by_its_first_rules() -> None:
    """KG204 has a shortest way back; rules that derive any property are named as the reason, if any."""
    chain = [rule(f"?x :p{number + 1} ?y", f"?x :p{number} ?y", name=f"t/{number}") for number in range(9)]
    minting = rule("_:new :p0 ?x", "?x :p9 ?y", name="t/mints")
    with pytest.raises(RuleError, match=r"\(through t/8, t/7, t/6, t/5, t/4 and 5 more\)") as caught:
        stratify([*chain, minting])
    assert "rule_families" not in (caught.value.hint or "")
    with pytest.raises(RuleError) as caught:
        stratify([*chain, minting, rule("?x ?q ?y", "?p :sub ?q", "?x ?p ?y", name="t/any")])
    assert "rule_families" in (caught.value.hint or "")


def test_levels_rise_over_negation_alone() -> None:
    """Rules share a level with their input; those that negate or count are one above."""
    base = rule("?x :q ?x", "?x :given ?x", name="t/base")
    reader = rule("?x :r ?x", "?x :q ?x", name="t/reader")
    denier = rule("?x :s ?x", "?x :given ?x", NOT_Q, name="t/denier")
    after = rule("?x :t ?x", "?x :s ?x", name="t/after")
    found = {stratum.rules[0].name: stratum.level for stratum in stratify([after, denier, reader, base])}
    assert found == {"t/base": 1, "t/reader": 1, "t/denier": 2, "t/after": 2}
