from __future__ import annotations

import json
from xml.etree import ElementTree as ET

import pytest
from cli.program import Program
from search.compose.chaining import node, store_of

SCAN, GRID, TWIST = "sensor_msgs/LaserScan", "nav_msgs/OccupancyGrid", "geometry_msgs/Twist"


@pytest.fixture(scope="module")
def robots(tmp_path_factory: pytest.TempPathFactory) -> Program:
    """Return the program in a folder with a store of nodes for both versions of ROS."""
    folder = tmp_path_factory.mktemp("robots")
    store_of(
        folder / ".kg",
        node("mapper", {"scan": SCAN}, {"map": GRID}),
        node("planner", {"map": GRID, "goal": "geometry_msgs/PoseStamped"}, {"cmd_vel": TWIST}, kind="nodelet"),
        node("follower", {"scan": SCAN}, {"cmd_vel": TWIST}, ros=2, kind="component"),
    )
    return Program(folder)


def test_chains_are_told_with_their_lines(robots: Program) -> None:
    """Each node is shown with its inputs, outputs, their lines, and its further needs."""
    run = robots("compose", "--from", "LaserScan", "--to", "Twist")
    assert (run.code, run.err) == (0, "")
    assert run.out.startswith(f"1. {SCAN} -> {TWIST}\n   robots/follower  component, local/here\n")
    assert f"\n2. {SCAN} -> {GRID} -> {TWIST}\n" in run.out
    assert f"takes `map` {GRID}  src/x.cpp:10" in run.out
    assert "also needs geometry_msgs/PoseStamped (goal)" in run.out
    assert "2 nodes of ROS 1; all of local/here" in run.out


def test_json_has_everything(robots: Program) -> None:
    """`--json` writes one object a line, including the launch file."""
    run = robots("compose", "--from", "LaserScan", "--to", "Twist", "--ros", "1", "--json")
    (chain,) = map(json.loads, run.out.splitlines())
    assert chain["types"] == [SCAN, GRID, TWIST]
    assert chain["nodes"][0]["start"] == "rosrun robots mapper"
    assert chain["nodes"][1]["takes"] == {
        "name": "map",
        "parameter": None,
        "type": GRID,
        "topic": "/map",
        "file": "src/x.cpp",
        "line": 10,
        "file_repository": None,
    }
    assert chain["nodes"][1]["also_needs"] == [{"type": "geometry_msgs/PoseStamped", "names": ["goal"]}]
    assert chain["launch_file"] == "laserscan_to_twist.launch"
    assert chain["launch"] == robots("compose", "--from", SCAN, "--to", TWIST, "--ros", "1", "--launch", "1").out


def test_the_launch_file_is_all_that_is_written(robots: Program) -> None:
    """`--launch RANK` prints only the launch file, ready to be saved."""
    run = robots("compose", "--from", "LaserScan", "--to", "Twist", "--launch", "2")
    assert (run.code, run.err) == (0, "")
    assert [one.get("name") for one in ET.fromstring(run.out).iter("node")] == ["nodelet_manager", "mapper", "planner"]  # noqa: S314 - written here
    second = robots("compose", "--from", "LaserScan", "--to", "Twist", "--launch", "1")
    compile(second.out, "chain.launch.py", "exec")
    assert "ComposableNode(" in second.out


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (["--from", "LazerScan", "--to", "Twist"], 1, "error[KG705]"),
        (["--from", "Twist", "--to", "LaserScan"], 1, "error[KG706]"),
        (["--from", "LaserScan", "--to", "Twist", "--using", "follwer"], 1, "`follower`"),
        (["--from", "LaserScan", "--to", "Twist", "--launch", "9"], 2, "no chain 9, only 2 chains"),
        (["--from", "LaserScan", "--to", "Twist", "--ros", "3"], 2, "`--ros 3` is not a whole number from 1 to 2"),
        (["--from", "LaserScan", "--to", "Twist", "--length", "99"], 2, "from 1 to 6"),
        (["--from", "LaserScan"], 2, "--to"),
    ],
    ids=lambda one: one if isinstance(one, str) else None,
)
def test_what_cannot_be_answered_says_why(robots: Program, words: list[str], code: int, said: str) -> None:
    """An empty result exits with 1 and a wrong call with 2, with instructions on standard error."""
    run = robots("compose", *words)
    assert (run.code, run.out) == (code, "")
    assert said in run.err


def test_that_there_are_more_is_said_to_programs(robots: Program) -> None:
    """A list cut by `--limit` reports how to get more."""
    run = robots("compose", "--from", "LaserScan", "--to", "Twist", "--limit", "1", "--json")
    assert len(run.out.splitlines()) == 1
    assert "--limit shows more" in run.err
