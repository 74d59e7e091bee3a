"""Rules run whenever a command changes their input."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

from kg.resources import folder

if TYPE_CHECKING:
    from pathlib import Path

    from cli.program import Program

DATA = """
@prefix ros: <http://data.mksmart.org/onto-ros/class#> . @prefix rnkg: <https://w3id.org/rnkg/ns#> .
<urn:x:driver> a ros:Node ; ros:hasComponent <urn:x:end> .
<urn:x:end> a ros:Publisher ; rnkg:connectsTo <urn:x:scan> .
"""
DRONE = str(folder("examples") / "workspace" / "drone")
PUBLISHES = "ASK { <urn:x:driver> rnkg:publishes <urn:x:scan> }"


def test_what_is_imported_is_inferred_from(kg: Program, tmp_path: Path) -> None:
    """After `kg import` rules run, unless --no-rules; `kg rules run` then catches up."""
    (tmp_path / "robot.ttl").write_text(DATA)
    assert kg("--store", "one", "import", "robot.ttl").code == 0
    assert kg("--store", "one", "query", PUBLISHES).out.strip() == "true"
    kg("--store", "two", "import", "robot.ttl", "--no-rules")
    assert kg("--store", "two", "query", PUBLISHES).out.strip() == "false"
    assert kg("--store", "two", "rules", "run").code == 0
    assert kg("--store", "two", "query", PUBLISHES).out.strip() == "true"


def test_the_graph_of_inferences_takes_no_import(kg: Program, tmp_path: Path) -> None:
    """--graph refuses it; quads of it in a file, which the rules do not infer, are removed with a note."""
    (tmp_path / "robot.ttl").write_text(DATA)
    (tmp_path / "robot.nq").write_text("<urn:x:a> <urn:x:b> <urn:x:c> <https://w3id.org/rnkg/graph/inferred> .\n")
    run = kg("import", "robot.ttl", "--graph", "inferred")
    assert (run.code, "KG561" in run.err) == (5, True)
    run = kg("import", "robot.nq")
    assert (run.code, "1 inferred triple removed" in run.err) == (0, True)


@pytest.mark.parametrize("name", ["", "a b", "https://example.org/a b"])
def test_a_graph_needs_a_name(kg: Program, tmp_path: Path, name: str) -> None:
    """A name that is not an IRI, in full or after the base, is refused."""
    (tmp_path / "robot.ttl").write_text(DATA)
    run = kg("import", "robot.ttl", "--graph", name)
    assert (run.code, "KG003" in run.err) == (2, True)


def test_a_build_says_how_much_it_inferred(kg: Program) -> None:
    """The report has a line of text, and an object with --json."""
    run = kg("--store", "built", "build", DRONE, "--json")
    assert "inferred" in run.err
    assert json.loads(run.out)["inferred"]["triples"] > 0


def test_a_broken_rule_is_a_warning(kg: Program, tmp_path: Path) -> None:
    """The data is stored without the rule, and the exit code reports a problem."""
    (tmp_path / "robot.ttl").write_text(DATA)
    (tmp_path / "rules" / "mine").mkdir(parents=True)
    (tmp_path / "rules" / "mine" / "broken.rq").write_text("CONSTRUCT {")
    run = kg("import", "robot.ttl")
    assert (run.code, "warning[KG201]" in run.err) == (1, True)
    assert kg("query", PUBLISHES).out.strip() == "true"
    run = kg("build", DRONE, "--json")
    assert (run.code, json.loads(run.out)["inferred"]["problems"][0]["code"]) == (1, "KG201")
    assert "broken.rq:1" in run.err
    run = kg("why", "<urn:x:driver>", "rnkg:publishes", "<urn:x:scan>")
    assert (run.code, "warning[KG201]" in run.err) == (0, True)
    assert kg("forget", "local/drone").code == 1


def test_the_status_tells_of_rules_that_changed(kg: Program, tmp_path: Path) -> None:
    """The status reports changed rules until they run again."""
    kg("build", DRONE)
    assert "rules have changed since they last ran" not in kg("status").err
    (tmp_path / "rules" / "mine").mkdir(parents=True)
    (tmp_path / "rules" / "mine" / "new.rq").write_text("CONSTRUCT { ?x <urn:p> ?y } WHERE { ?x <urn:q> ?y }")
    assert "rules have changed since they last ran" in kg("status").err
    assert kg("rules", "run").code == 0
    assert "rules have changed since they last ran" not in kg("status").err


def test_an_import_brings_the_ontologies(kg: Program, tmp_path: Path) -> None:
    """A store never filled by a build gets the ontologies; an imported ontology remains unchanged."""
    (tmp_path / "robot.ttl").write_text(DATA)
    kg("import", "robot.ttl")
    assert kg("query", "ASK { GRAPH <https://w3id.org/rnkg/graph/ontology> { ?c a owl:Class } }").out.strip() == "true"
    own = ("--graph", "ontology", "--store", "own")
    assert kg("import", "robot.ttl", *own).code == 0
    held = "SELECT (COUNT(*) AS ?n) { GRAPH <https://w3id.org/rnkg/graph/ontology> { ?s ?p ?o } }"
    assert kg("query", held, "--store", "own", "--format", "csv").out.split()[-1] == "4"
