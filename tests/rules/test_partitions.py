"""A rule is local only if each part of a graph gives the same inferences as the whole."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from pyoxigraph import NamedNode, Quad, RdfFormat, parse
from rules.forms import atom, rule

from kg.rules.form import EngineBlock, Exists, Variable
from kg.rules.partitions import Parts, parts_of, verdicts

if TYPE_CHECKING:
    from kg.rules.form import Element

# Two sources, each with a node that has an end, and a topic that both connect to. The second one extends the first.
QUADS = """
<urn:x:n1> <urn:x:part> <urn:x:e1> <urn:g:a> .
<urn:x:e1> <urn:x:to> <urn:x:topic> <urn:g:a> .
<urn:x:n2> <urn:x:part> <urn:x:e2> <urn:g:b> .
<urn:x:e2> <urn:x:to> <urn:x:topic> <urn:g:b> .
<urn:x:n2> <urn:x:extends> <urn:x:n1> <urn:g:b> .
<urn:x:topic> <urn:x:name> "t" <urn:g:shared> .
<urn:x:topic> <urn:x:busy> "yes" <urn:g:inferred> .
"""


@pytest.fixture
def parts() -> Parts:
    """The parts of these quads."""
    quads = [quad for quad in parse(QUADS, RdfFormat.N_QUADS) if isinstance(quad, Quad)]
    return parts_of(
        lambda: quads,
        lambda graph, _: graph if graph in {"urn:g:a", "urn:g:b"} else None,
        frozenset({"urn:g:shared"}),
    )


def reason(parts: Parts, *body: Element) -> str:
    """Return why a rule with this body is not local."""
    (found,) = verdicts([rule("?n :new ?t", *body)], parts, parts)
    return found.reason


def test_what_stays_within_a_source_is_local(parts: Parts) -> None:
    """Ends of a node belong to its source, and names of topics are copied to each."""
    assert not reason(parts, atom("?n :part ?e"), atom("?e :to ?t"), atom("?t :name ?name"))


def test_two_ends_of_one_topic_are_not(parts: Parts) -> None:
    """The reason names both."""
    found = reason(parts, atom("?a :to ?t"), atom("?b :to ?t"))
    assert "?a" in found
    assert "?b" in found
    assert found.endswith("may belong to different sources")


def test_a_property_that_leads_elsewhere_holds_nothing_together(parts: Parts) -> None:
    """The ends of an extended node may belong to another source."""
    assert reason(parts, atom("?n :extends ?m"), atom("?m :part ?e"))


def test_absence_counts_too(parts: Parts) -> None:
    """The absence of other connections to a topic is known only from all sources."""
    assert reason(parts, atom("?a :to ?t"), Exists((atom("?b :to ?t"),), negated=True))


def test_what_is_inferred_about_shared_things_is_not_local(parts: Parts) -> None:
    """Facts about a topic that are not copied may come from any source."""
    assert "busy" in reason(parts, atom("?e :to ?t"), atom("?t :busy ?yes"))


def test_blocks_of_the_engine_are_not_judged(parts: Parts) -> None:
    """A block without decomposition needs the whole graph."""
    assert "engine" in reason(parts, EngineBlock("?a <urn:x:to> ?t", (Variable("a"), Variable("t"))))


def test_what_a_global_rule_infers_may_lead_elsewhere(parts: Parts) -> None:
    """A rule that joins by such a property is not local, even if the store has none of its triples."""
    joins = rule("?a :feeds ?b", "?a :to ?t . ?b :to ?t")
    reads = rule("?a :new ?n", "?a :feeds ?b . ?b :to ?n")
    assert [one.is_local for one in verdicts([joins, reads], parts, parts)] == [False, False]


def test_asserted_facts_are_not_in_doubt(parts: Parts) -> None:
    """A rule that reads only asserted facts is local, whatever other rules infer for the same property."""
    joins = rule("?a :part ?b", "?a :to ?t . ?b :to ?t")
    body = (atom("?n :part ?e", asserted=True), atom("?e :to ?t", asserted=True))
    reads = rule("?n :new ?t", *body)
    assert [one.is_local for one in verdicts([joins, reads], parts, parts)] == [False, True]


def test_names_of_properties_are_told(parts: Parts) -> None:
    """Properties in the test's quads: one stays within a source, one leads to shared entities."""
    assert ("urn:x:part", "") in parts.inner
    assert ("urn:x:to", "") in parts.outward
    assert ("urn:x:extends", "") not in parts.inner | parts.outward
    assert parts.number == 2
    assert NamedNode("urn:x:part").value in {key for key, _ in parts.only}
