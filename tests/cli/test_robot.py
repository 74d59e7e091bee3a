from __future__ import annotations

import json
import shutil
from typing import TYPE_CHECKING

import pytest
from cli.program import Program

from kg.errors import Exit
from kg.resources import folder

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture(scope="module")
def rover(tmp_path_factory: pytest.TempPathFactory) -> Program:
    """The program in a folder with a store of the example workspace."""
    root: Path = tmp_path_factory.mktemp("robot")
    shutil.copytree(folder("examples") / "workspace" / "rover", root / "rover")
    program = Program(root)
    assert program("build", "rover").code == Exit.OK
    return program


def test_a_launch_file_is_asked_before_it_runs(rover: Program) -> None:
    """The table lists the capabilities of the started nodes with their topics, and omits general ones."""
    run = rover("robot", "capabilities", "--launch", "rover.launch")
    lines = [line.split("\t") for line in run.out.splitlines()]
    assert run.code == Exit.OK
    assert lines[0] == ["kind", "capability", "what", "way", "parameters", "through"]
    named = {line[1]: line for line in lines[1:]}
    assert "localizing" not in named
    assert named["drivingAtVelocity"][3:5] == ["write", "forward m/s, left m/s, up m/s, turn rad/s"]
    assert named["sensingPose"][5] == "/rover1/odom of /rover1/base_controller"
    assert "laserScanning" not in named, "a filter of scans does not scan"


def test_json_has_every_capability_with_its_ways(rover: Program) -> None:
    """Each line is one capability, including general ones, with all keys."""
    run = rover("robot", "capabilities", "--launch", "rover.launch", "--json")
    found = {one["name"]: one for one in map(json.loads, run.out.splitlines())}
    assert found["localizing"]["implied_by"] == ["sensingPose"]
    assert found["sensingPose"]["ways"][0]["fields"]["x"] == "pose.pose.position.x"
    assert set(found["sensingPose"]) == {
        "iri", "name", "label", "comment", "alternatives", "kinds", "modality", "parameters", "ways",
        "implied_by", "moves", "unavailable",
    }  # fmt: skip


def test_other_arguments_give_other_capabilities(rover: Program) -> None:
    """A launch file is evaluated again with an argument, and nothing is written."""
    whole = rover("robot", "capabilities", "--launch", "rover.launch").out
    other = rover("robot", "capabilities", "--launch", "rover.launch", "--arg", "name:=scout")
    assert other.code == Exit.OK
    assert "/rover1/odom" in whole
    assert "/rover1/odom" not in other.out
    assert "\tsensingPose\t" in other.out


def test_why_shows_the_line_of_code(rover: Program) -> None:
    """The proof of a capability ends in the line that creates the publisher, and in the line of the ontology."""
    run = rover("robot", "capabilities", "--launch", "rover.launch", "--why", "sense its pose")
    assert run.code == Exit.OK
    assert "base_controller.cpp:" in run.out
    assert "ontology/capability.ttl:" in run.out


def test_why_of_what_it_cannot_do_is_an_error(rover: Program) -> None:
    """A missing capability is reported as such, with a suggestion."""
    run = rover("robot", "capabilities", "--launch", "rover.launch", "--why", "sensingPos")
    assert run.code == Exit.FOUND
    assert "KG818" in run.err
    assert "sensingPose" in run.err


def test_a_package_is_asked_by_itself_and_for_what_it_would_add(rover: Program) -> None:
    """A package has the capabilities of its nodes; with a launch file, only those missing there are listed."""
    alone = rover("robot", "capabilities", "--package", "rover_robot")
    added = rover("robot", "capabilities", "--package", "rover_robot", "--launch", "arm.launch")
    assert "\tdrivingAtVelocity\t" in alone.out
    assert "\tdrivingAtVelocity\t" in added.out
    assert "what rover_robot would add to rover_robot/launch/arm.launch" in added.err


def test_a_package_that_adds_nothing_is_told_from_one_that_can_do_nothing(rover: Program) -> None:
    """A capability already in the launch file is not reported as missing from the package."""
    added = rover("robot", "capabilities", "--package", "rover_robot", "--launch", "rover.launch")
    assert added.out.count("\n") == 1
    assert "rover_robot would add nothing to rover_robot/launch/rover.launch" in added.err
    nothing = rover("robot", "capabilities", "--launch", "arm.launch")
    assert "rover_robot/launch/arm.launch has no capability of the ontology" in nothing.err


@pytest.mark.parametrize(
    ("arguments", "code", "ended"),
    [
        (("--package", "rover_robt"), "KG001", Exit.FOUND),
        (("--launch", "rover.launch", "--live"), "KG003", Exit.USAGE),
        (("--robot", "http://localhost"), "KG801", Exit.USAGE),
        (("--robot", "dds://1000"), "KG801", Exit.USAGE),
        (("--robot", "ros1://a b:1"), "KG002", Exit.USAGE),
    ],
)
def test_what_cannot_be_asked_is_refused(rover: Program, arguments: tuple[str, ...], code: str, ended: Exit) -> None:
    """An invalid name is reported with its code; an invalid address is a usage error."""
    run = rover("robot", "capabilities", *arguments)
    assert run.code == ended
    assert f"[{code}]" in run.err


def test_watching_without_a_robot_leaves_no_store(kg: Program) -> None:
    """The store created for an unreachable robot is removed again."""
    run = kg("robot", "watch", "--robot", "memory://nobody")
    assert run.code == Exit.FOUND
    assert "KG802" in run.err
    assert "kg robot simulate office" in run.err
    assert not (kg.folder / ".kg").exists()
