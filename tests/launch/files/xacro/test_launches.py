"""Robot descriptions named by launch files: the configuration has their plugins, with their parameter."""

from __future__ import annotations

from typing import TYPE_CHECKING

from extract.workspaces import manifest, written

from kg.corpus.reading import Reader
from kg.launch.files.reading import read_configuration

if TYPE_CHECKING:
    from pathlib import Path

    from kg.facts import LaunchConfiguration

ROBOT = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:arg name="topic" default="scan"/>
<plugin name="p" filename="libp.so"><t>$(arg topic)</t></plugin>
</robot>"""
PYTHON = """
import os, xacro
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.substitutions import Command, FindExecutable, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

def generate_launch_description():
    path = PathJoinSubstitution([FindPackageShare('demo'), 'urdf', 'r.xacro'])
    command = Command([FindExecutable(name='xacro'), ' ', path, ' topic:=front'])
    document = xacro.process_file(
        os.path.join(get_package_share_directory('demo'), 'urdf', 'r.xacro'), mappings={'topic': 'rear'})
    return LaunchDescription([
        Node(package='rsp', executable='rsp', parameters=[{'robot_description': command}]),
        Node(package='rsp', executable='rsp', name='other', namespace='two',
             parameters=[{'robot_description': document.toxml(), 'rate': 5}]),
    ])
"""


def configuration(root: Path, ros: int, launch: str, text: str) -> LaunchConfiguration:
    """Return the configuration of a launch file of the package `demo`."""
    files = {"demo/package.xml": manifest("demo"), "demo/urdf/r.xacro": ROBOT, f"demo/launch/{launch}": text}
    workspace = written(root, {**files, "demo/urdf/plain.urdf": ROBOT.replace("$(arg topic)", "plain")})
    (source,) = workspace.sources
    found = read_configuration(Reader(workspace, source, source.packages[0]), f"demo/launch/{launch}", ros)
    assert found is not None
    return found


def texts(found: LaunchConfiguration) -> list[tuple[str, str]]:
    """Return the parameter of each plugin with the text of its element."""
    return [(one.parameter, one.values[0].text) for one in found.plugins]


def test_commands_and_files_of_roslaunch_are_descriptions(tmp_path: Path) -> None:
    """The last of two settings wins; the chain has the line of the parameter."""
    found = configuration(
        tmp_path,
        1,
        "a.launch",
        """<launch>
  <param name="one" command="$(find xacro)/xacro --inorder '$(find demo)/urdf/r.xacro' topic:=a"/>
  <param name="one" command="rosrun xacro xacro.py '$(find demo)/urdf/r.xacro' topic:=b"/>
  <group ns="ns"><param name="two" textfile="$(find demo)/urdf/plain.urdf"/></group>
  <param name="three" command="cat $(find demo)/urdf/plain.urdf"/>
  <param name="three" value="none"/>
</launch>""",
    )
    assert texts(found) == [("/one", "b"), ("/ns/two", "plain")]
    assert [str(line) for line in found.plugins[0].chain] == ["demo/launch/a.launch:3"]
    assert ("demo/urdf/r.xacro") in [path for _, path in found.files]


def test_arguments_that_are_not_known_stay_so(tmp_path: Path) -> None:
    """Text that depends on an argument without default is `{}` in the plugin."""
    text = """<launch><arg name="t"/>
  <param name="d" command="$(find xacro)/xacro $(find demo)/urdf/r.xacro topic:=x_$(arg t)"/></launch>"""
    assert texts(configuration(tmp_path, 1, "a.launch", text)) == [("/d", "x_{}")]


def test_commands_and_functions_of_ros_2_are_descriptions(tmp_path: Path) -> None:
    """A parameter of a node has the plugins, by the absolute name of the node."""
    found = configuration(tmp_path, 2, "a.launch.py", PYTHON)
    assert texts(found) == [("/rsp/robot_description", "front"), ("/two/other/robot_description", "rear")]


def test_commands_of_ros_2_xml_are_descriptions(tmp_path: Path) -> None:
    """The substitution `command` of XML behaves the same."""
    text = """<launch><node pkg="rsp" exec="rsp" name="n">
  <param name="robot_description" value="$(command 'xacro $(find-pkg-share demo)/urdf/r.xacro topic:=x')"/>
</node></launch>"""
    assert texts(configuration(tmp_path, 2, "a.launch.xml", text)) == [("/n/robot_description", "x")]


def test_files_that_commands_of_ros_2_print_are_descriptions(tmp_path: Path) -> None:
    """A description printed by `cat` has plugins, too."""
    text = """<launch><node pkg="rsp" exec="rsp" name="n">
  <param name="robot_description" value="$(command 'cat $(find-pkg-share demo)/urdf/plain.urdf')"/>
</node></launch>"""
    assert texts(configuration(tmp_path, 2, "a.launch.xml", text)) == [("/n/robot_description", "plain")]
