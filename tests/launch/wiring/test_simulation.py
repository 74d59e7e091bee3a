"""Ends of simulated robots: plugins named in their descriptions, and the table of plugins."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import pytest
from wiring.systems_of import HERE, configuration, started

from kg.facts import LaunchPlugin, Location, NodeReference, PluginValue, Resolution, Role
from kg.launch.wiring.simulation_table import Device, device_of, filled, load, read_end, simulator_of, spawner_of
from kg.launch.wiring.systems import wire
from kg.launch.wiring.types import NodeTypes

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kg.facts import InstanceInterface, System

SERVER: Final[Mapping[str, Any]] = {"name": "gazebo", "package": "gazebo_ros", "executable": "gzserver"}
SPAWN: Final[Mapping[str, Any]] = {
    "name": "spawn",
    "package": "gazebo_ros",
    "executable": "spawn_model",
    "arguments": ["-urdf", "-param robot_description -model rover"],
}
LINE = Location("demo/urdf/rover.xacro", 5)


def plugin(library: str, *values: tuple[str, str], parameter: str = "/robot_description") -> LaunchPlugin:
    """Return a plugin in line 5, whose elements are in the next lines."""
    made = tuple(PluginValue(name, text, Location(LINE.path, 6 + n)) for n, (name, text) in enumerate(values))
    return LaunchPlugin(f"lib{library}.so", parameter, LINE, (), "device", made)


def system(ros: int, nodes: Sequence[Mapping[str, Any]], *plugins: LaunchPlugin) -> System:
    """Return the system of nodes started with these plugins in their descriptions."""
    made = configuration([started(row) for row in nodes], ros)
    return wire(replace(made, plugins=plugins), NodeTypes([]))


def ends(found: System, name: str) -> list[InstanceInterface]:
    """Return the plugin ends of an instance."""
    (instance,) = [one for one in found.instances if one.name == name]
    return [end for end in instance.interfaces if end.declared.location.path == LINE.path]


def names(found: System, name: str, role: Role = Role.PUBLISHES) -> list[str | None]:
    """Return the names published by plugins of an instance."""
    return [end.resolved for end in ends(found, name) if end.declared.role is role]


def test_the_simulator_has_what_plugins_make() -> None:
    """An end has the line of the element that names it, and the library of the plugin as its owner."""
    found = system(1, [SERVER, SPAWN], plugin("gazebo_ros_laser", ("topicName", "scan"), ("frameName", "laser")))
    (end,) = ends(found, "/gazebo")
    assert (end.resolved, end.declared.type, end.resolution) == ("/scan", "sensor_msgs/LaserScan", Resolution.LITERAL)
    assert end.declared.location == Location(LINE.path, 6)
    assert end.owner == NodeReference(HERE, "gazebo_plugins", "libgazebo_ros_laser.so")
    assert "/clock" in [one.resolved for one in found.instances[0].interfaces]
    assert not found.instances[1].interfaces


def test_a_namespace_is_that_of_the_robot_else_of_what_spawns_it() -> None:
    """`robotNamespace` takes precedence over `-robot_namespace` and the namespace of `spawn_model`."""
    own = plugin("gazebo_ros_p3d", ("robotNamespace", "one"), ("topicName", "odom"))
    other = plugin("gazebo_ros_p3d", ("topicName", "odom"), parameter="/two/robot_description")
    both = [SERVER, SPAWN, {**SPAWN, "namespace": "/two"}]
    assert names(system(1, both, own, other), "/gazebo") == ["/one/odom", "/two/odom"]
    told = {**SPAWN, "arguments": ["-param robot_description -robot_namespace /three"]}
    assert names(system(1, [SERVER, told], replace(other, parameter="/robot_description")), "/gazebo") == [
        "/three/odom"
    ]


def test_an_empty_namespace_is_the_name_of_the_model_where_the_plugin_says_so() -> None:
    """Camera plugins do that, and position plugins do not."""
    camera = plugin("gazebo_ros_camera", ("robotNamespace", ""), ("cameraName", "eye"))
    position = plugin("gazebo_ros_p3d", ("robotNamespace", ""), ("topicName", "odom"))
    found = names(system(1, [SERVER, SPAWN], camera, position), "/gazebo")
    assert found == ["/rover/eye/image_raw", "/rover/eye/camera_info", "/odom"]


def test_remappings_of_the_simulator_change_namespaces_of_cameras() -> None:
    """A node handle's namespace is remapped as by `ros::NodeHandle`."""
    stereo = plugin(
        "gazebo_ros_multicamera", ("cameraName", "camera"), ("../camera@name", "left"), ("../camera@name", "the_right")
    )
    server = {**SERVER, "remaps": [["camera/left", "left_camera"]]}
    found = system(1, [server, SPAWN], stereo)
    assert names(found, "/gazebo")[::2] == ["/left_camera/image_raw", "/camera/right/image_raw"]
    assert found.instances[0].remaps[0].used


def test_without_a_simulator_the_spawner_has_them() -> None:
    """A description that is not spawned has no ends; otherwise they belong to its spawner."""
    laser = plugin("gazebo_ros_laser", ("topicName", "{}/scan"))
    (end,) = ends(system(1, [SPAWN], laser), "/spawn")
    assert (end.resolved, end.resolution) == ("/{}/scan", Resolution.PARTIAL)
    assert not ends(system(1, [SERVER], laser), "/gazebo")


def test_what_has_a_condition_says_so() -> None:
    """The text in the description is the reason of the end."""
    laser = replace(plugin("gazebo_ros_laser", ("topicName", "scan")), condition="$(arg laser)")
    (end,) = ends(system(1, [SERVER, SPAWN], laser), "/gazebo")
    assert end.reason == "the plugin is there only if $(arg laser)"


def test_plugins_of_ros_2_are_nodes_with_rules_of_their_own() -> None:
    """Private names are below the plugin's name, and remappings are those of its element."""
    lidar = plugin(
        "gazebo_ros_ray_sensor",
        ("ros/namespace", "/robot"),
        ("ros/remapping", "~/out:=scan"),
        ("output_type", "sensor_msgs/LaserScan"),
        parameter="/robot_state_publisher/robot_description",
    )
    imu = replace(lidar, library="libgazebo_ros_imu_sensor.so", values=(), name="imu")
    spawn = {"package": "gazebo_ros", "executable": "spawn_entity.py", "arguments": ["-topic", "robot_description"]}
    found = system(2, [spawn], lidar, imu)
    assert names(found, "/spawn_entity") == ["/robot/scan", "/imu/out"]
    assert [end.declared.type for end in ends(found, "/spawn_entity")] == ["sensor_msgs/LaserScan", "sensor_msgs/Imu"]


def test_a_topic_of_a_description_is_that_of_the_publisher_in_its_namespace() -> None:
    """Two robots have one description each."""
    one = plugin("gazebo_ros_p3d", parameter="/a/robot_state_publisher/robot_description")
    two = plugin("gazebo_ros_p3d", ("ros/namespace", "/b"), parameter="/b/robot_state_publisher/robot_description")
    spawn = {"package": "gazebo_ros", "executable": "spawn_entity.py", "namespace": "/b", "name": "s"}
    found = system(2, [{**spawn, "arguments": ["-topic robot_description"]}], one, two)
    assert names(found, "/b/s") == ["/b/odom"]


def test_a_name_that_no_element_gives_is_that_of_the_plugin() -> None:
    """It has the line of the plugin, and counts as a default."""
    spawn = {
        "package": "gazebo_ros",
        "executable": "spawn_entity.py",
        "name": "s",
        "arguments": ["-topic robot_description"],
    }
    (end,) = ends(system(2, [spawn], plugin("gazebo_ros_p3d")), "/s")
    assert (end.resolved, end.resolution) == ("/odom", Resolution.PARAMETER_DEFAULT)
    assert end.declared.location == LINE


def test_a_topic_of_a_description_elsewhere_is_the_only_one_there_is() -> None:
    """A spawner in another namespace gets the description if there is one, and none of several."""
    one = plugin("gazebo_ros_p3d", parameter="/a/robot_state_publisher/robot_description")
    two = plugin("gazebo_ros_p3d", parameter="/b/robot_state_publisher/robot_description")
    spawn = {"package": "gazebo_ros", "executable": "spawn_entity.py", "namespace": "/c", "name": "s"}
    node = {**spawn, "arguments": ["-topic robot_description"]}
    assert len(names(system(2, [node], one), "/c/s")) == 1
    assert names(system(2, [node], one, two), "/c/s") == []


def test_the_table_can_be_used_and_says_where_it_is_from() -> None:
    """Every row has a source and ends that can be parsed."""
    devices, simulators, spawners, managers = load()
    assert all(row.source and row.ros in {1, 2} for row in devices)
    assert all(row.source and row.ros in {1, 2} for row in simulators)
    assert all(row.source and row.ros in {1, 2} for row in spawners)
    assert all(row.source and row.ros in {1, 2} for row in managers)
    assert all(read_end(text) for row in devices for text in row.ends)
    assert all(read_end(text) for row in simulators for text in row.ends)
    assert isinstance(device_of("/opt/ros/lib/libgazebo_ros_imu.so", 1), Device)
    assert device_of("libunknown.so", 1) is None
    assert simulator_of("gazebo_ros", "gzserver", 1) is not None
    assert spawner_of("ros_gz_sim", "create", 2) is not None


@pytest.mark.parametrize("text", ["publishes", "hears std_msgs/Bool x", "publishes std_msgs/Bool x when y"])
def test_a_text_that_says_no_end_is_refused(text: str) -> None:
    """An error in the table is detected."""
    with pytest.raises(ValueError):  # noqa: PT011 - of a role that does not exist it is the enumeration's
        read_end(text)


@pytest.mark.parametrize(
    ("pattern", "name"),
    [("{a}/x", "1/x"), ("{b=2}", "2"), ("{b={a}}", "1"), ("{b}", None), ("x", "x"), ("{e}{a}", "1")],
)
def test_names_are_filled_with_elements(pattern: str, name: str | None) -> None:
    """A missing element has its default; without one there is no name."""
    assert filled(pattern, {"a": "1", "e": ""}) == name
