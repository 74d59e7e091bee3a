from __future__ import annotations

from typing import TYPE_CHECKING

from rules.authoring.worlds import bench, files, write_rules

from kg.rules.authoring.profiling import profile, profile_objects
from kg.rules.authoring.testing import cover, coverage_objects

if TYPE_CHECKING:
    from pathlib import Path

DATA = ":a :next :b . :b :next :c . :c :next :d . :a a :First ."
REACHES = "CONSTRUCT { ?x :reaches ?y } WHERE { ?x :next|(:next/:reaches) ?y }"
LAST = "CONSTRUCT { ?y a :Last } WHERE { ?x :reaches ?y . FILTER NOT EXISTS { ?y :next ?z } }"


def test_a_profile_counts_what_each_rule_did(tmp_path: Path) -> None:
    """Triples, rounds and strata are those of the run; the most expensive rule is first."""
    rules = write_rules(tmp_path / "rules", reaches=REACHES, last=LAST)
    found = profile(bench(tmp_path, DATA), files(rules))
    by_name = {rule.name: rule for rule in found.rules}
    assert by_name["f/reaches"].derived == 6
    assert by_name["f/reaches"].rounds > 1
    assert by_name["f/last"].derived == 1
    assert {rule.stratum for rule in found.rules} == {1}
    assert [rule.seconds for rule in found.rules] == sorted((rule.seconds for rule in found.rules), reverse=True)
    assert (found.asserted, found.inferred) == (3, 7)


def test_the_elements_of_a_rule_have_their_rows(tmp_path: Path) -> None:
    """For a named rule each element reports the rows before and after it, and its place."""
    rules = write_rules(tmp_path / "rules", reaches=REACHES, last=LAST)
    found = profile(bench(tmp_path, DATA), files(rules), ["f/last"])
    last = next(rule for rule in found.rules if rule.name == "f/last")
    assert [(each.text, each.order, each.rows_in, each.rows_out) for each in last.elements] == [
        ("?x :reaches ?y", 1, 1, 6),
        ("FILTER NOT EXISTS { ?y :next ?z . }", 2, 6, 3),
    ]
    assert {each.place.line for each in last.elements} == {12}
    *rest, run = profile_objects(found)
    assert run["inferred"] == 7
    assert {one["rule"]: len(one["elements"]) for one in rest} == {"f/last": 2, "f/reaches": 0}


def test_coverage_names_the_first_element_that_nothing_passes(tmp_path: Path) -> None:
    """For a rule that never fires: the first failing element, in the order of the text, and those after it."""
    never = "CONSTRUCT { ?x a :Never } WHERE { ?x :next ?y . ?x :knows ?y . ?y a :First }"
    rules = write_rules(tmp_path / "rules", last=LAST.replace(":reaches", ":next"), never=never)
    found = cover(bench(tmp_path, DATA), files(rules))
    last, never_fires = found.rules
    assert (last.fired, last.covered, last.parts, last.gaps) == (1, 3, 3, ())
    assert [(gap.kind, gap.text) for gap in never_fires.gaps] == [
        ("element", "?x :knows ?y"),
        ("behind", "?y rdf:type :First"),
        ("head", "?x rdf:type :Never"),
    ]
    assert (found.fired, round(found.share, 3)) == (1, 0.571)
    assert list(coverage_objects(found))[-1] == {"coverage": True, "rules": 2, "fired": 1, "percent": 57.1}


def test_coverage_tells_branches_and_heads_apart(tmp_path: Path) -> None:
    """Each branch of a UNION is a separate part, and so is each triple of a head."""
    body = "{ ?x :next ?y } UNION { ?x :absent ?y } OPTIONAL { ?x :says ?z }"
    text = f"CONSTRUCT {{ ?x a :Found ; :told ?z }} WHERE {{ {body} }}"
    rules = write_rules(tmp_path / "rules", both=text)
    (both,) = cover(bench(tmp_path, DATA), files(rules)).rules
    assert 0 < both.fired < both.rules
    assert "?x :absent ?y" in {gap.text for gap in both.gaps if gap.kind == "element"}


def test_coverage_of_some_rules_runs_all(tmp_path: Path) -> None:
    """A named rule is assessed with the inferences of the others."""
    rules = write_rules(tmp_path / "rules", reaches=REACHES, last=LAST)
    every = files(rules)
    found = cover(bench(tmp_path, DATA), every, [file for file in every if file.name == "f/last"])
    assert [(rule.name, rule.fired) for rule in found.rules] == [("f/last", 1)]
