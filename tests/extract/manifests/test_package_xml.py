from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from extract.workspaces import codes, reader_of, written

from kg.corpus.reading import Reader
from kg.extract.manifests.package_xml import read_package_xml
from kg.facts import Dependency, Person

if TYPE_CHECKING:
    from pathlib import Path

FULL = """<?xml version="1.0"?>
<package format="3">
  <name>demo</name>
  <version compatibility="1.0.0">1.2.3</version>
  <description>Drives <b>robots</b><!-- and people -->
    around.</description>
  <maintainer email="a@example.org">Ada</maintainer>
  <author>Bob</author>
  <license file="LICENSE">Apache-2.0</license>
  <license>BSD</license>
  <url>https://example.org</url>
  <url type="repository">https://example.org/git</url>
  <buildtool_depend condition="$ROS_VERSION == 1">catkin</buildtool_depend>
  <buildtool_depend condition="$ROS_VERSION == 2">ament_cmake</buildtool_depend>
  <depend>rclcpp</depend>
  <exec_depend condition="$ROS_VERSION == 1">roscpp</exec_depend>
  <!-- <depend>commented</depend> -->
  <export>
    <build_type condition="$ROS_VERSION == 2">ament_cmake</build_type>
    <nodelet plugin="${prefix}/nodelets.xml"/>
    <deprecated>Use other.</deprecated>
  </export>
</package>
"""


def reader(root: Path, text: str, **files: str) -> Reader:
    """Return a reader of the package `demo` with this manifest."""
    return reader_of(root, {"package.xml": text, **files})


def package(*elements: str, form: int = 2) -> str:
    """Return a manifest of demo with these elements."""
    return f"<package format='{form}'><name>demo</name>{''.join(elements)}</package>"


def ros(root: Path, *elements: str, **files: str) -> int:
    """Return the version of ROS that a manifest with these elements is for."""
    read = reader(root, package(*elements, form=3), **files)
    return read_package_xml(read, read.package).package.ros


def test_everything_a_manifest_says(tmp_path: Path) -> None:
    """All elements are read, with lines and normalised whitespace; conditions are evaluated for the ROS version."""
    read = reader(tmp_path, FULL)
    manifest = read_package_xml(read, read.package)
    found = manifest.package
    assert (found.name, found.version, found.format, found.ros) == ("demo", "1.2.3", 3, 2)
    assert found.description == "Drives robots around."
    assert found.licenses == ("Apache-2.0", "BSD")
    assert found.people == (Person("Ada", "a@example.org"), Person("Bob", role="author"))
    assert found.urls == (("website", "https://example.org"), ("repository", "https://example.org/git"))
    assert found.build_type == "ament_cmake"
    assert found.deprecated == "Use other."
    assert found.dependencies == (
        Dependency("ament_cmake", "buildtool_depend", 14),
        Dependency("rclcpp", "depend", 15),
    )
    assert manifest.exports[1] == ("nodelet", {"plugin": "${prefix}/nodelets.xml"}, "", 20)
    assert read.problems == ()


@pytest.mark.parametrize(
    ("element", "expected"),
    [
        ("<buildtool_depend>catkin</buildtool_depend>", 1),
        ("<run_depend>rospy</run_depend>", 1),
        ("<buildtool_depend>ament_cmake_auto</buildtool_depend>", 2),
        ("<export><build_type>ament_python</build_type></export>", 2),
        ("<exec_depend>rclpy</exec_depend>", 2),
        ("<build_depend>rosidl_default_generators</build_depend>", 2),
    ],
)
def test_version_of_ros(tmp_path: Path, element: str, expected: int) -> None:
    """Build tool, build type and client libraries give the version of ROS."""
    assert ros(tmp_path, element) == expected


def test_both_versions(tmp_path: Path) -> None:
    """A package for both versions counts as one of the newer."""
    tools = "<buildtool_depend>catkin</buildtool_depend><buildtool_depend>ament_cmake</buildtool_depend>"
    assert ros(tmp_path, tools) == 2


def test_version_by_build_files(tmp_path: Path) -> None:
    """Without evidence in the manifest, the build files decide."""
    assert ros(tmp_path / "a", **{"CMakeLists.txt": "find_package(ament_cmake)"}) == 2
    assert ros(tmp_path / "b", **{"CMakeLists.txt": "find_package(catkin)"}) == 1
    assert ros(tmp_path / "c", **{"launch/x.launch.py": ""}) == 2


@pytest.mark.parametrize(("code", "expected"), [("import rclpy\n", 2), ("import rospy\n", 1), ("import os\n", 1)])
def test_version_of_loose_code(tmp_path: Path, code: str, expected: int) -> None:
    """Code without a manifest has the version of its client library."""
    workspace = written(tmp_path / "loose", {"a.txt": "x", "b.py": "import os\n", "c.py": code})
    found = workspace.package("loose")
    assert found is not None
    source, folder = workspace.folder(found)
    assert read_package_xml(Reader(workspace, source, folder), folder).package.ros == expected


@pytest.mark.parametrize(
    ("element", "expected"),
    [
        ("<buildtool_depend>catkin</buildtool_depend>", "catkin"),
        ("<buildtool_depend>ament_cmake_ros</buildtool_depend>", "ament_cmake"),
        ("<depend>eigen</depend>", "cmake"),
    ],
)
def test_build_type_without_export(tmp_path: Path, element: str, expected: str) -> None:
    """The build type follows from the build tool."""
    read = reader(tmp_path, package(element))
    assert read_package_xml(read, read.package).package.build_type == expected


def test_malformed_manifest(tmp_path: Path) -> None:
    """A malformed manifest is reported with its line; the content before the fault is used."""
    read = reader(tmp_path, "<package>\n<name>demo</name>\n<version>1.0.0</version>\n<license>x</package>")
    assert read_package_xml(read, read.package).package.version == "1.0.0"
    assert codes(read.problems) == [("KG116", 4)]


def test_manifest_with_entities(tmp_path: Path) -> None:
    """Entities are rejected; the package remains."""
    bomb = '<!DOCTYPE p [<!ENTITY a "x"><!ENTITY b "&a;&a;&a;">]>' + package("<license>&b;</license>")
    read = reader(tmp_path, bomb)
    assert read_package_xml(read, read.package).package.name == "demo"
    assert codes(read.problems) == [("KG116", 1)]


def test_empty_elements(tmp_path: Path) -> None:
    """Empty elements count as missing."""
    read = reader(tmp_path, package("<version/>", "<license> </license>", "<depend></depend>", "<maintainer/>"))
    found = read_package_xml(read, read.package).package
    assert (found.version, found.licenses, found.dependencies) == (None, (), ())


def test_rosbuild_manifest(tmp_path: Path) -> None:
    """manifest.xml of rosbuild names dependencies, authors and licences in its own way."""
    text = """<package><description>Old.</description><author>Ada, Bob</author><license>BSD, GPL</license>
<depend package="roscpp"/><url>http://example.org</url>
<export><nodelet plugin="${prefix}/n.xml"/></export></package>"""
    (tmp_path / "old").mkdir()
    (tmp_path / "old" / "manifest.xml").write_text(text)
    read = reader_of(tmp_path, {}, package="old")
    manifest = read_package_xml(read, read.package)
    found = manifest.package
    assert (found.name, found.ros, found.build_type, found.description) == ("old", 1, "rosbuild", "Old.")
    assert found.licenses == ("BSD", "GPL")
    assert [person.name for person in found.people] == ["Ada", "Bob"]
    assert found.dependencies == (Dependency("roscpp", "depend", 2),)
    assert manifest.exports[0][0] == "nodelet"
