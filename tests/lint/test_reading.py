from __future__ import annotations

from typing import TYPE_CHECKING

from lint.robot import read

from kg.graph.iris import DEFAULT_BASE
from kg.graph.reading.systems import included
from kg.lint.finding import Evidence
from kg.lint.reading import read_findings

if TYPE_CHECKING:
    from pathlib import Path


def test_a_finding_comes_with_its_lines(robot: Path) -> None:
    """It has the message of its rule, starting with its subject, the place to fix, and the evidence as text."""
    with read(robot) as snapshot:
        first, near, *_ = read_findings(snapshot, DEFAULT_BASE)
    assert (first.code, first.severity, first.path, first.line) == ("KG412", "error", "bringup/launch/all.launch", 3)
    assert near.rule == "architecture/near-miss-topic"
    assert near.subjects == ("/scan", "/filter", "/scan_raw")
    line = Evidence(
        "bringup/launch/base.launch", 3, "local/rover", "remaps /input to /scan", "bringup/launch/all.launch:2"
    )
    assert near.place == line
    assert near.evidence == (Evidence("base/src/laser.cpp", 6, "local/rover", "publishes /scan_raw"),)
    assert not near.presumes_whole


def test_findings_are_sorted(robot: Path) -> None:
    """Errors are first, then warnings, then notes; within one severity by file and line."""
    with read(robot) as snapshot:
        found = [f"{one.severity} {one.path}:{one.line}" for one in read_findings(snapshot, DEFAULT_BASE)]
    assert found == [
        "error bringup/launch/all.launch:3",
        "warning bringup/launch/base.launch:3",
        "warning bringup/launch/base.launch:3",
        "note bringup/launch/base.launch:6",
        "note bringup/launch/sim.launch:3",
        "note bringup/launch/sim.launch:4",
    ]


def test_an_end_of_an_instance_stands_in_the_code_of_its_type(robot: Path) -> None:
    """The evidence has the line of the code, and the name of the instance in its system."""
    with read(robot) as snapshot:
        last = read_findings(snapshot, DEFAULT_BASE)[-1]
    assert last.evidence == (Evidence("base/src/laser.cpp", 6, "local/rover", "publishes /laser/scan_raw"),)


def test_configurations_that_others_include(robot: Path) -> None:
    """Included configurations are identified by name."""
    with read(robot) as snapshot:
        assert included(snapshot) == {"bringup/launch/base.launch"}
