"""`kg why` and `kg why-not` as users call them, on a store of the example workspace."""

from __future__ import annotations

import json
import shutil
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

import pytest
from cli.program import Program
from workspaces import example

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture(scope="module", name="built")
def build(tmp_path_factory: pytest.TempPathFactory) -> Program:
    """Return the program in a folder with a store of the example workspace."""
    folder: Path = tmp_path_factory.mktemp("why")
    shutil.copytree(example(tmp_path_factory) / ".kg", folder / ".kg")
    return Program(folder)


def test_a_proof_ends_in_lines_of_code_and_of_ontologies(built: Program) -> None:
    """An inferred capability leads to the lines of the publisher and the ontology; those of code are listed again."""
    run = built("why", "base_controller", "hasCapability", "know where it is")
    assert run.code == 0, run.err
    assert "base_controller.cpp:" in run.out
    assert "capability.ttl:" in run.out
    assert "by rule capability/general" in run.out
    summary = run.out.partition("rules, from ")[2]
    assert "odometry.cpp:15\n    odometry_pub_ = nh.advertise" in summary


def test_all_ways_as_one_picture_and_as_lines_of_json(built: Program) -> None:
    """Several proofs are one well-formed picture, one chart, and one JSON object each."""
    asked = ("why", "patrol", "subscribes", "scan_filtered", "--all")
    assert ET.fromstring(built(*asked, "--format", "svg").out).tag.endswith("svg")  # noqa: S314 - our own
    assert built(*asked, "--format", "mermaid").out.count("flowchart") == 1
    facts = [json.loads(line)["facts"] for line in built(*asked, "--json").out.splitlines()]
    assert facts[0][0]["rule"] == "communication/subscribes"


def test_proofs_that_read_the_same_are_shown_once(built: Program) -> None:
    """A node that two launch files start has one proof in words, and one for each of them as JSON."""
    asked = ("why", "/drone1/gimbal", "publishes", "/drone1/gimbal/angles")
    assert built(*asked).out.count("by rule communication/publishes") == 1
    assert len(built(*asked, "--json").out.splitlines()) == 2


def test_a_row_of_an_answer(built: Program) -> None:
    """The facts matched by a query for one of its rows are explained."""
    run = built("why", "--query", "evidence-of-topic", "--param", "topic=/odom", "--row", "1")
    assert run.code == 0, run.err
    assert "rnkg:connectsTo /odom" in run.out
    assert "row 1: " in run.err
    of_all = built("why", "--query", "SELECT (COUNT(*) AS ?n) { ?s ?p ?o }")
    assert "one of 1,000 or more solutions" in of_all.err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("why-not", "patrol", "rnkg:feeds", "patrol", "--depth", "x"), "whole number from 1 to 20"),
        (("why-not", "patrol", "rnkg:feeds", "patrol", "--depth", "99"), "whole number from 1 to 20"),
        (("why", "--query", "who-publishes", "--row", "9999"), "not 9999"),
        (("why", "patrol", "subscribes"), "kg why patrol subscribes scan_filtered"),
        (("why", "patrol", "subscribes", "odom", "--query", "x"), "a fact and --query are mutually exclusive"),
        (("why", "patrol", "subscribes", "odom", "--format", "png"), "unknown format `png`"),
    ],
)
def test_wrong_calls(built: Program, arguments: tuple[str, ...], words: str) -> None:
    """An invalid call is a usage error with the reason."""
    run = built(*arguments)
    assert (run.code, run.out) == (2, "")
    assert words in run.err


def test_a_fact_that_is_not_there_leads_to_why_not(built: Program) -> None:
    """The error of `why` suggests `why-not`, which names the missing facts and the nearest ones."""
    run = built("why", "patrol", "rnkg:feeds", "flight_controller")
    assert run.code == 1
    assert "kg why-not" in run.err
    missing = built("why-not", "patrol", "rnkg:feeds", "flight_controller")
    assert "fails: no flight_controller rnkg:rosVersion 1" in missing.out
    assert "owl/" not in missing.out


def test_a_name_without_a_label_is_shown_with_its_prefix(built: Program) -> None:
    """A term that no ontology has is named as users write it."""
    run = built("why", "patrol", "usesHardware", "hardware:none")
    assert "does not contain patrol rnkg:usesHardware hardware:none" in run.err


def test_a_fact_that_is_there_needs_no_why_not(built: Program) -> None:
    """`why-not` of a fact that holds reports that it holds."""
    run = built("why-not", "patrol", "subscribes", "scan_filtered")
    assert run.code == 1
    assert "kg why" in run.err
