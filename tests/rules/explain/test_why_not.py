"""Why facts do not hold: the first failing part of each rule, and the nearest existing fact."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st
from rules.explain.worlds import World, fact, rule, where, without

from kg.rules.explain.why_not import why_not

HEARS = rule("wiring/hears", "?b hears ?a", "?a publishes ?t", "?b subscribes ?t", where("?a != ?b"))
ALONE = rule("wiring/alone", "?a speaksInto void", "?a publishes ?t", without("?b subscribes ?t"))
DATA = ":camera :publishes :image_raw . :viewer :subscribes :image_rwa, :odom . :base :publishes :odom ."


def test_the_nearest_match_is_named() -> None:
    """The explanation names a topic with a similar spelling."""
    world = World(DATA, (HEARS,))
    (attempt,) = why_not(world.view, world.rules, fact("viewer hears camera")).attempts
    assert (
        attempt.text
        == "no <https://example.org/viewer> <https://example.org/subscribes> <https://example.org/image_raw>"
    )
    assert "image_rwa" in attempt.nearest[0]
    assert attempt.matched == (fact("camera publishes image_raw"),)


def test_labels_are_what_people_read() -> None:
    """Sentences use labels if they exist."""
    world = World(DATA + ' :image_rwa rdfs:label "/image_rwa" . :viewer rdfs:label "viewer" .', (HEARS,))
    (attempt,) = why_not(world.view, world.rules, fact("viewer hears camera")).attempts
    assert attempt.nearest[0] == "viewer has <https://example.org/subscribes> /image_rwa"


def test_a_filter_tells_its_values() -> None:
    """A failing filter is reported with the values of its variables."""
    world = World(":a :publishes :t ; :subscribes :t .", (HEARS,))
    (attempt,) = why_not(world.view, world.rules, fact("a hears a")).attempts
    assert attempt.text.startswith("FILTER(?a != ?b) is not true where ?a = ")


def test_what_must_be_absent_is_named() -> None:
    """A fact that violates a negation is named."""
    world = World(DATA, (ALONE,))
    (attempt,) = why_not(world.view, world.rules, fact("base speaksInto void")).attempts
    assert [text.split("/")[-1] for text in attempt.nearest] == ["odom>"]


def test_missing_premises_are_followed() -> None:
    """A derivable premise is explained in turn, up to the allowed depth."""
    rules = (rule("x/a", "?x p ?y", "?x q ?y"), rule("x/b", "?x q ?y", "?x r ?y"))
    world = World(":n :other :m .", rules)
    (attempt,) = why_not(world.view, rules, fact("n p m")).attempts
    assert attempt.deeper is not None
    assert [each.rule.name for each in attempt.deeper.attempts] == ["x/b"]
    (shallow,) = why_not(world.view, rules, fact("n p m"), depth=1).attempts
    assert shallow.deeper is None


def test_no_rule_and_a_misspelt_property() -> None:
    """If no rule derives the property, a similarly named one is suggested."""
    world = World(DATA, (HEARS,))
    answer = why_not(world.view, world.rules, fact("camera publishs image_raw"))
    assert answer.attempts == ()
    assert answer.nearest == ("did you mean <https://example.org/publishes>?",)


def test_rules_that_have_not_run() -> None:
    """If all conditions hold, the explanation is that rules have not run."""
    world = World(":a :publishes :t . :b :subscribes :t .", ())
    (attempt,) = why_not(world.view, (HEARS,), fact("b hears a")).attempts
    assert (attempt.failing, len(attempt.matched)) == (None, 2)


PAIRS = st.lists(st.tuples(st.sampled_from("abc"), st.sampled_from(["publishes", "subscribes"]), st.sampled_from("tu")))


@settings(deadline=None, max_examples=40)
@given(PAIRS, st.sampled_from("abc"), st.sampled_from("abc"))
def test_each_fact_holds_or_has_a_failing_part(triples: list[tuple[str, str, str]], one: str, other: str) -> None:
    """After rules have run, each rule that could derive an absent fact has a failing part."""
    world = World(" ".join(f":{s} :{p} :{o} ." for s, p, o in triples), (HEARS, ALONE))
    for asked in (fact(f"{one} hears {other}"), fact(f"{one} speaksInto void")):
        if not world.view.graphs(asked):
            answer = why_not(world.view, world.rules, asked)
            assert answer.attempts
            assert all(attempt.failing is not None for attempt in answer.attempts)
