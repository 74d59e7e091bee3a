"""Properties of all launch files in Python."""

from __future__ import annotations

from typing import TYPE_CHECKING

from extract.workspaces import reader_of
from files.ros2.python.described import described, read_text

from kg.corpus.files import FilePath
from kg.launch.files.access import Files
from kg.launch.files.ros2.actions import Opaque
from kg.launch.files.ros2.context import Context
from kg.launch.files.ros2.python.language import parse
from kg.launch.files.ros2.python.reading import read_python

if TYPE_CHECKING:
    from pathlib import Path

    from kg.facts import LaunchProblem

COLLECTING = """
from launch import LaunchDescription
from launch.actions import OpaqueFunction
from launch_ros.actions import Node
found = []
table = {}
def setup(context):
    found.append(Node(package="p", executable="e"))
    table["n"] = len(found)
    context.launch_configurations["made"] = str(len(found))
    return found
def generate_launch_description():
    return LaunchDescription([OpaqueFunction(function=setup)])
"""


def test_body_is_read_again(tmp_path: Path) -> None:
    """The body of an opaque function gives the same each time, despite its side effects."""
    reader = reader_of(tmp_path, {"launch.py": COLLECTING})
    files, file = Files(reader), reader.file("demo/launch.py")
    problems: list[LaunchProblem] = []
    (opaque,) = read_python(files, file, COLLECTING.encode(), problems)[0]
    assert isinstance(opaque, Opaque)
    context = Context(files, file, {}, {})
    assert list(opaque.run(context)) == list(opaque.run(context))
    assert context.configuration("made") == "1"
    assert len(opaque.run(context)) == 1


def test_problems_of_a_body_are_those_of_its_execution(tmp_path: Path) -> None:
    """Unknown parts of an opaque function's body are reported when it is executed, not when it is read."""
    text = COLLECTING.replace("return found", "return unknown_thing()")
    reader = reader_of(tmp_path, {"launch.py": text})
    files, file = Files(reader), reader.file("demo/launch.py")
    problems: list[LaunchProblem] = []
    (opaque,) = read_python(files, file, text.encode(), problems)[0]
    assert isinstance(opaque, Opaque)
    context = Context(files, file, {}, {})
    opaque.run(context)
    assert not problems
    assert len(context.results.problems) == 1


def test_parsed_once() -> None:
    """A text is parsed once per process."""
    file = FilePath("local/demo", "launch.py")
    assert parse(file, b"x = 1") is parse(file, b"x = 1")


def test_descriptions_of_tests(tmp_path: Path) -> None:
    """A test of launch_testing gives its returned description, alone or with a context."""
    text = """
import launch_testing.actions
from launch import LaunchDescription
from launch_ros.actions import Node
def generate_test_description():
    node = Node(package="p", executable="e")
    return LaunchDescription([node, launch_testing.actions.ReadyToTest()]), {"node": node}
"""
    assert described(*read_text(tmp_path, {"launch.py": text})) == "launch.py:6 NodeAction package=p executable=e\n"


def test_files_of_other_folders_are_not_read(tmp_path: Path) -> None:
    """A path that leads outside the build is not read, however it is computed."""
    outside = tmp_path / "secret.yaml"
    outside.write_text("name: secret\n")
    text = f"""
import os, yaml
from launch import LaunchDescription
from launch_ros.actions import Node
def generate_launch_description():
    paths = ["{outside}", os.path.join(os.path.dirname(__file__), "../../secret.yaml"), "../../secret.yaml"]
    names = [yaml.safe_load(open(path))["name"] for path in paths]
    return LaunchDescription([Node(package="p", executable=name) for name in names])
"""
    found = described(*read_text(tmp_path / "build", {"launch.py": text}))
    assert "executable=secret" not in found
    assert found.count("$(unknown") == len(["absolute", "above", "relative"])
