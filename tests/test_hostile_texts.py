"""Untrusted texts and names of nodes are shown and wired as plain text, without effect."""

from __future__ import annotations

import ast
import unicodedata
from typing import Final
from xml.dom import minidom

import pytest
from cli.program import Program

_MANIFEST: Final = """<?xml version="1.0"?>
<package format="3">
  <name>{name}</name><version>1.0.0</version>
  <description>Turns scans into clouds --&gt; &lt;b&gt;\u202e =cmd|' /C calc'!A0</description>
  <maintainer email="a@example.org">A</maintainer><license>Apache-2.0</license><depend>{depend}</depend>
</package>
"""
_README: Final = """# Clouds

Turns laser scans into point clouds. \x1b[31mRed\x1b]0;title\x07 \x9b31m <script>x</script>
"""
_ROS_1: Final = '''#!/usr/bin/env python
"""Turns scans into clouds \x1b[31m."""
import rospy
from sensor_msgs.msg import Imu, LaserScan, PointCloud2
rospy.init_node("one\\"/><node pkg='x'/>")
rospy.Subscriber("scan", LaserScan)
rospy.Subscriber("imu--><node pkg='x'/><!-- $(eval 1)\\n", Imu)
rospy.Publisher("cloud", PointCloud2)
rospy.get_param("~rate--><node pkg='x'/>")
'''
_ROS_2: Final = '''"""Turns scans into clouds."""
import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Imu, LaserScan, PointCloud2
class Two(Node):
    def __init__(self):
        super().__init__("two'\\n+__import__('os')#")
        self.create_subscription(LaserScan, "scan", print, 10)
        self.create_subscription(Imu, "imu\\nimport os #", print, 10)
        self.create_publisher(PointCloud2, "cloud", 10)
        self.declare_parameter("rate\\nimport os #", "v'\\nimport os\\n")
def main():
    rclpy.init()
    rclpy.spin(Two())
'''
_SETUP: Final = """from setuptools import setup
setup(name="two", packages=["two"], entry_points={"console_scripts": ["two = two.two:main"]})
"""


@pytest.fixture(scope="module")
def strangers(tmp_path_factory: pytest.TempPathFactory) -> Program:
    """Return the program with a store of one package for each version of ROS, with hostile texts and names."""
    folder = tmp_path_factory.mktemp("strangers")
    files = {
        "one/package.xml": _MANIFEST.format(name="one", depend="rospy"),
        "one/README.md": _README,
        "one/scripts/one.py": _ROS_1,
        "two/package.xml": _MANIFEST.format(name="two", depend="rclpy"),
        "two/setup.py": _SETUP,
        "two/two/__init__.py": "",
        "two/two/two.py": _ROS_2,
    }
    for name, text in files.items():
        path = folder / "ws" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")
    (folder / "ws/one/scripts/one.py").chmod(0o755)
    kg = Program(folder)
    assert kg("build", "ws").code == 0
    return kg


@pytest.mark.parametrize(
    "arguments",
    [
        ("search", "turn scans into clouds"),
        ("search", "turn scans into clouds", "--json"),
        ("search", "\x1b[31m \u202e red"),
        ("compose", "--from", "LaserScan", "--to", "PointCloud2"),
        ("node", "one/one"),
        ("eval", "sample"),
    ],
)
def test_texts_do_not_steer_the_terminal(strangers: Program, arguments: tuple[str, ...]) -> None:
    """No control or direction character of a text, a name or a query reaches the terminal."""
    run = strangers(*arguments)
    assert run.code == 0
    assert run.out
    shown = run.out + run.err
    assert not {sign for sign in shown if unicodedata.category(sign) in {"Cc", "Cf"}} - {"\n", "\t"}


def test_names_stay_text_in_launch_files_of_ros_1(strangers: Program) -> None:
    """A name closes no comment or attribute: the launch file starts only the node of the chain."""
    run = strangers("compose", "--from", "LaserScan", "--to", "PointCloud2", "--ros", "1", "--launch", "1")
    assert run.code == 0
    nodes = minidom.parseString(run.out).getElementsByTagName("node")  # noqa: S318 - kg wrote it
    assert [node.getAttribute("pkg") for node in nodes] == ["one"]


def test_names_stay_text_in_launch_files_of_ros_2(strangers: Program) -> None:
    """A name closes no comment or string: the launch file imports only the modules of launch files."""
    run = strangers("compose", "--from", "LaserScan", "--to", "PointCloud2", "--ros", "2", "--launch", "1")
    assert run.code == 0
    imports = [node for node in ast.walk(ast.parse(run.out)) if isinstance(node, ast.Import | ast.ImportFrom)]
    assert all(isinstance(one, ast.ImportFrom) and (one.module or "").startswith("launch") for one in imports)
    calls = [node.func for node in ast.walk(ast.parse(run.out)) if isinstance(node, ast.Call)]
    assert all(isinstance(one, ast.Name) for one in calls)


@pytest.mark.parametrize("need", ["laser scan " * 1_000, "a" * 10_000, "'\"\\}{|;$(id)`", "フィルタ", "=+-@"])
def test_any_need_is_answered(strangers: Program, need: str) -> None:
    """Any query, however long or odd, returns hits or no hits."""
    assert strangers("search", need).code in {0, 1}
