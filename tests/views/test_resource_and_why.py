"""Tests of the views of any resource by its IRI, and of proofs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from kg.errors import UnknownNameError
from kg.views.node import node
from kg.views.resource import resource
from kg.views.why import why, why_not

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot


def _group(groups: list[dict[str, Any]], label: str) -> dict[str, Any]:
    return next(one for one in groups if one["predicate"]["label"] == label)


def test_facts_stand_in_groups_with_their_origin(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Facts are grouped by property; inferred ones are marked, and those from a line have it."""
    iri = node(snapshot, settings, name="base_controller")["iri"]
    found = resource(snapshot, settings, iri=iri, limit="100")
    assert (found["kind"], found["label"]) == ("node", "base_controller")
    assert found["evidence"]["path"].endswith(".cpp")
    assert all(one["inferred"] for one in _group(found["out"], "rnkg:hasCapability")["facts"])
    (name,) = _group(found["out"], "rnkg:name")["facts"]
    assert not name["inferred"]
    assert name["value"] == {"text": "base_controller", "datatype": "xsd:string", "language": None}
    assert all(one["evidence"] for one in _group(found["out"], "ros:hasComponent")["facts"])
    assert _group(found["in"], "rnkg:contains")["count"] == 1


def test_pages_of_a_property_are_all_of_it(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """The pages together contain each fact once."""
    whole = _group(resource(snapshot, settings, iri="ros:Publisher", limit="500")["in"], "rdf:type")
    assert whole["count"] == len(whole["facts"]) > 20
    found: list[str] = []
    for offset in range(0, whole["count"], 7):
        page = resource(
            snapshot, settings, iri="ros:Publisher", predicate="rdf:type", direction="in", offset=str(offset), limit="7"
        )
        assert page["out"] == []
        found += [one["value"]["iri"] for one in page["in"][0]["facts"]]
    assert sorted(found) == sorted(one["value"]["iri"] for one in whole["facts"])
    assert len(found) == len(set(found))


def test_properties_and_unknown_things(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A property has its number of uses; an unknown resource gets a suggestion."""
    assert resource(snapshot, settings, iri="rnkg:publishes")["uses"] > 0
    with pytest.raises(UnknownNameError) as caught:
        resource(snapshot, settings, iri="https://w3id.org/rnkg/package/local/x/rover_robt")
    assert "`rover_robot`" in (caught.value.hint or "")


def _leaves(proof: dict[str, Any]) -> Iterator[dict[str, Any]]:
    if not proof["inferred"]:
        yield proof
    for premise in proof.get("premises", ()):
        yield from _leaves(premise)


def test_a_proof_leads_to_lines_of_code(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """An inferred fact has its rule with its text; the leaves are asserted facts with their lines."""
    found = why(snapshot, settings, subject="scan_filter", predicate="rnkg:publishes", object="/scan_filtered")
    (proof,) = found["proofs"]
    assert proof["inferred"]
    assert proof["rule"]["name"] == "communication/publishes"
    assert proof["rule"]["evidence"]["path"] == "rules/communication/publishes.srl"
    assert [one["heading"] for one in proof["rule"]["documentation"]][:2] == ["What it infers", "Why"]
    leaves = list(_leaves(proof))
    assert leaves
    code = [one for one in leaves if one["evidence"] and one["evidence"]["path"].endswith("scan_filter_nodelet.cpp")]
    assert any("advertise" in one["line_text"] for one in code)
    assert found["ways"] == 1


def test_every_inferred_fact_of_a_node_can_be_proven(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """`why` explains every inferred fact offered by a page."""
    found = node(snapshot, settings, name="patrol")
    facts = [one["fact"] for kind in ("functions", "hardware", "capabilities") for one in found[kind]]
    facts += [one["fact"] for one in found["interfaces"] if one["fact"]]
    assert facts
    for fact in facts:
        told = why(snapshot, settings, **fact, every="all")
        assert told["proofs"][0]["inferred"]
        assert len(told["proofs"]) >= 1


def test_why_not_says_what_is_lacking(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Each rule that could derive the fact shows where it fails; a fact that holds has no explanation."""
    asked = {"subject": "scan_filter", "predicate": "rnkg:publishes", "object": "/odom"}
    found = why_not(snapshot, settings, **asked)
    assert not found["held"]
    assert found["attempts"][0]["rule"]["name"] == "communication/publishes"
    assert found["attempts"][0]["fails"]
    held = why_not(snapshot, settings, **{**asked, "object": "/scan_filtered"}, depth="x")
    assert held["held"]
