"""Tests of the baseline that extracts with string patterns, and of the score of its sheets."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from typing import TYPE_CHECKING, Any

import pytest
from repository import ROOT

if TYPE_CHECKING:
    from pathlib import Path

FOLDER = ROOT / "benchmarks" / "rnkg_baseline"


@pytest.fixture(scope="module")
def extracting() -> Any:
    """Return the module of the baseline."""
    specification = importlib.util.spec_from_file_location("rnkg_extracting", FOLDER / "extracting.py")
    assert specification
    assert specification.loader
    module = importlib.util.module_from_spec(specification)
    sys.modules[specification.name] = module
    specification.loader.exec_module(module)
    return module


def said(extracting: Any, root: Path, name: str, text: str) -> set[tuple[str, str, str, str, int]]:
    """Return the facts of a package with one file."""
    (root / "p").mkdir()
    (root / "p" / "package.xml").write_text("<package><name>p</name></package>")
    (root / "p" / name).write_text(text)
    return {(one.node, one.relation, one.name, one.type, one.line) for one in extracting.facts(root)}


def test_strings_of_cpp(extracting: Any, tmp_path: Path) -> None:
    """Types are those of the template or the callback; a variable has the default of its parameter."""
    text = """void heard(const std_msgs::String::ConstPtr& message) {}
bool reset(std_srvs::Empty::Request& request, std_srvs::Empty::Response& response) { return true; }
int main(int argc, char** argv) {
  ros::init(argc, argv, "talker");
  nh.param("topic", topic_, std::string("scan"));
  nh.advertise<sensor_msgs::LaserScan>(topic_, 1);
  nh.subscribe("chatter", 1, &heard); // nh.subscribe("comment", 1, &heard);
  nh.advertiseService("reset", reset);
  nh.serviceClient<nav_msgs::GetMap>("map");
}"""
    assert said(extracting, tmp_path, "a.cpp", text) == {
        ("talker", "publishes", "scan", "sensor_msgs/LaserScan", 6),
        ("talker", "subscribes", "chatter", "std_msgs/String", 7),
        ("talker", "services", "reset", "std_srvs/Empty", 8),
        ("talker", "clients", "map", "nav_msgs/GetMap", 9),
    }


def test_strings_of_python(extracting: Any, tmp_path: Path) -> None:
    """Comments give no facts, and line numbers are preserved."""
    text = """import rospy

# rospy.Publisher('comment', String)
from std_msgs.msg import String
rospy.init_node('talker')
rospy.Publisher('chatter', String)
"""
    assert said(extracting, tmp_path, "a.py", text) == {("talker", "publishes", "chatter", "std_msgs/String", 6)}


def test_the_sheet_gives_the_figures_of_the_page() -> None:
    """The judged sheet gives the figures of docs/benchmarks-log.md."""
    command = [sys.executable, str(FOLDER), "score", str(FOLDER / "sheet.csv"), str(FOLDER / "key.csv")]
    told = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT, env={"PYTHONPATH": str(ROOT)})
    page = (ROOT / "docs" / "benchmarks-log.md").read_text("utf-8")
    for line in told.stdout.splitlines():
        right, _, interval = line.partition(": ")[2].partition(", ")
        assert f"{right}: " in page
        assert f"({interval.partition(';')[0]})" in page
