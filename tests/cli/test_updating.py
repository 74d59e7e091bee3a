"""Tests of the commands that change, copy and restore a store."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from pathlib import Path

    from cli.program import Program

DATA = """
@prefix ros: <http://data.mksmart.org/onto-ros/class#> . @prefix rnkg: <https://w3id.org/rnkg/ns#> .
<urn:x:driver> a ros:Node ; ros:hasComponent <urn:x:end> .
<urn:x:end> a ros:Publisher ; rnkg:connectsTo <urn:x:scan> .
"""
MOVE = """DELETE { GRAPH ?g { ?end rnkg:connectsTo <urn:x:scan> } }
INSERT { GRAPH ?g { ?end rnkg:connectsTo <urn:x:map> } }
WHERE { GRAPH ?g { ?end a ros:Publisher } }"""
PUBLISHES = "ASK { <urn:x:driver> rnkg:publishes <urn:x:map> }"


def test_an_update_is_tried_and_made(kg: Program, tmp_path: Path) -> None:
    """With --dry-run the changes are listed by graph; without it they are applied, and rules infer the consequences."""
    (tmp_path / "robot.ttl").write_text(DATA)
    (tmp_path / "move.ru").write_text(MOVE)
    kg("import", "robot.ttl")
    tried = kg("update", "-f", "move.ru", "--dry-run")
    assert "https://w3id.org/rnkg/graph/imported-robot.ttl\t1\t1" in tried.out
    assert kg("query", PUBLISHES).out.strip() == "false"
    made = kg("update", MOVE, "--json")
    told = json.loads(made.out)
    assert (told["graph"].rpartition("/")[2], told["removed"], told["added"]) == ("imported-robot.ttl", 1, 1)
    assert "snapshot 2" in made.err
    assert kg("query", PUBLISHES).out.strip() == "true"
    assert "nothing changed" in kg("update", MOVE).err


def test_what_cannot_be_done_is_told(kg: Program, tmp_path: Path) -> None:
    """No store, no text, invalid SPARQL, and a graph of kg's own: each has its code, and nothing changes."""
    (tmp_path / "robot.ttl").write_text(DATA)
    assert kg("update", "CLEAR ALL").code == 4
    kg("import", "robot.ttl")
    assert kg("update").code == 2
    run = kg("update", "INSERT DATA { <urn:x:a> <urn:x:b> }")
    assert (run.code, "KG501" in run.err, "update:1:35" in run.err) == (5, True, True)
    run = kg("update", "DELETE WHERE { GRAPH ?g { ?s rnkg:publishes ?o } }")
    assert (run.code, "KG561" in run.err) == (5, True)
    run = kg("update", "LOAD <http://127.0.0.1/>")
    assert (run.code, "KG502" in run.err) == (5, True)


def test_an_update_without_a_rule_has_findings(kg: Program, tmp_path: Path) -> None:
    """A rule that is left out is a note, and the exit code reports it."""
    (tmp_path / "rules" / "mine").mkdir(parents=True)
    (tmp_path / "robot.ttl").write_text(DATA)
    kg("import", "robot.ttl")
    (tmp_path / "rules" / "mine" / "broken.rq").write_text("CONSTRUCT {")
    run = kg("update", MOVE)
    assert (run.code, "a rule was left out" in run.err) == (1, True)


def test_a_store_is_copied_and_put_back(kg: Program, tmp_path: Path) -> None:
    """A copy opens as a store; restored, it replaces the previous content."""
    (tmp_path / "robot.ttl").write_text(DATA)
    kg("import", "robot.ttl")
    made = kg("backup", "monday", "--json")
    assert json.loads(made.out)["snapshot"] == 1
    kg("update", MOVE)
    assert kg("--store", "monday", "query", PUBLISHES).out.strip() == "false"
    assert kg("restore", "monday").code == 0
    assert kg("query", PUBLISHES).out.strip() == "false"
    assert kg("backup", "monday").code == 4
    assert kg("restore", "tuesday").code == 4
    new = kg("--store", "new", "restore", "monday")
    assert (new.code, "snapshot 1" in new.err) == (0, True)


def test_a_graph_is_a_table_of_quads(kg: Program, tmp_path: Path) -> None:
    """The ending of a file or the name of the format writes Parquet, of the whole store or of one graph."""
    parquet = pytest.importorskip("pyarrow.parquet")
    (tmp_path / "robot.ttl").write_text(DATA)
    kg("import", "robot.ttl")
    done = kg("export", "-o", "all.parquet")
    assert (done.code, "of Parquet to all.parquet" in done.err) == (0, True)
    rows = parquet.read_table(tmp_path / "all.parquet").to_pylist()
    lines = sorted(" ".join(row.values()) + " ." for row in rows)
    assert lines == sorted(kg("export").out.splitlines())
    kg("export", "--format", "parquet", "--graph", "imported-robot.ttl", "--output", "one")
    assert parquet.read_table(tmp_path / "one").num_rows == 4
