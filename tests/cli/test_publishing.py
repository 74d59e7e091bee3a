"""Published graphs, and queries over several stores, on the command line."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING

import pytest
from workspaces import example

if TYPE_CHECKING:
    from pathlib import Path

    from cli.program import Program


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The store of the example workspace."""
    return example(tmp_path_factory)


def test_a_pulled_graph_answers_as_the_published_one(kg: Program, store: Path) -> None:
    """Digests, nodes and hits are equal; the publisher's index is used on request."""
    published = kg("--store", str(store), "publish", "out")
    pulled = kg("pull", "out", "--store", "copy", "--index")
    digests = [re.search(r"with digest (\w+)", run.err) for run in (published, pulled)]
    assert all(digests)
    assert len({digest[1] for digest in digests if digest}) == 1
    for command in (["nodes", "--json"], ["search", "laser", "--json"]):
        assert kg("--store", "copy", *command).out == kg("--store", str(store), *command).out


def test_rules_of_a_publisher_do_not_run(kg: Program, store: Path) -> None:
    """A publisher's rules are stored and listed in a note, and infer nothing by themselves."""
    (kg.folder / "rules" / "mine").mkdir(parents=True)
    (kg.folder / "rules" / "mine" / "spy.rq").write_text("CONSTRUCT { ?s <urn:spied> true } WHERE { ?s a <urn:x> }")
    kg("--store", str(store), "publish", "out", "--no-index", "--rules", "rules")
    (kg.folder / "other").mkdir()
    run = kg("pull", str(kg.folder / "out"), folder=kg.folder / "other")
    assert "of the publisher in" in run.err
    listed = kg("rules", "list", "--json", folder=kg.folder / "other").out
    assert "mine/spy" not in listed
    assert list((kg.folder / "other" / ".kg" / "published" / "rules" / "mine").iterdir())


def test_a_limit_that_is_no_size_is_refused(kg: Program) -> None:
    """KG002 names the option and the syntax."""
    run = kg("pull", "out", "--max-bytes", "much")
    assert run.code == 2
    assert "error[KG002]: --max-bytes is 'much', which is not a size" in run.err


def test_several_stores_are_asked_as_one(kg: Program, store: Path) -> None:
    """A query sees the quads of each named store; a server cannot be one of them."""
    (kg.folder / "mine.nt").write_text("<urn:a> <urn:knows> <urn:b> .\n")
    kg("import", "mine.nt", "--no-rules", "--store", "mine")
    text = "SELECT ?o ?node { { <urn:a> <urn:knows> ?o } UNION { ?node a rnkg:NodeType } } LIMIT 500"
    found = [kg("query", "--json", *stores, text).out.splitlines() for stores in (
        ["--store", "mine"], ["--store", str(store)], ["--store", "mine", "--store", str(store)])]  # fmt: skip
    assert sorted(found[2]) == sorted([*found[0], *found[1]])
    assert len(found[0]) == 1
    refused = kg("query", "--store", "mine", "--store", "http://127.0.0.1:9/", "ASK {}")
    assert "error[KG309]" in refused.err


def test_the_plan_tells_which_rules_are_local(kg: Program, store: Path) -> None:
    """Every rule has a verdict, with a reason unless it is local; the note warns of a store with one source."""
    run = kg("--store", str(store), "rules", "plan", "--cluster", "--json")
    found = {(one["rule"], one["part"]): one for one in map(json.loads, run.out.splitlines())}
    assert found["communication/subscribes", 1]["local"]
    assert "may belong to different sources" in found["communication/agrees-on-topic", 1]["why"]
    assert all(one["local"] == (not one["why"]) for one in found.values())
    assert "the store has one source" in run.err
