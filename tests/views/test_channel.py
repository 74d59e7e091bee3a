"""Tests of the views of one topic, service or action, and of one parameter."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import pytest

from kg.errors import UnknownNameError, UsageError
from kg.graph.reading.channels import CLASSES, names
from kg.pipeline.build import build
from kg.settings import load
from kg.store.embedded import EmbeddedStore
from kg.store.opening import reading
from kg.views.channel import channel, resolve_channel
from kg.views.parameter import parameter
from kg.views.system import system

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot


_LIDAR: Final = {
    "package.xml": "<package format='3'><name>lidar</name><version>1.0.0</version><description>A lidar.</description>"
    "<maintainer email='a@b.org'>A</maintainer><license>MIT</license><buildtool_depend>ament_cmake</buildtool_depend>"
    "</package>",
    "CMakeLists.txt": "project(lidar)\nfind_package(ament_cmake)\n"
    "install(PROGRAMS driver.py filter.py DESTINATION lib/lidar)\nament_package()\n",
    "driver.py": "import rclpy\nfrom rclpy.qos import qos_profile_sensor_data\n"
    "from sensor_msgs.msg import LaserScan\nfrom std_msgs.msg import Float64\n\nrclpy.init()\n"
    "node = rclpy.create_node('driver')\nnode.create_publisher(LaserScan, 'scan', qos_profile_sensor_data)\n"
    "node.create_publisher(Float64, 'tilt', 10)\n",
    "filter.py": "import rclpy\nfrom sensor_msgs.msg import LaserScan\n\nrclpy.init()\n"
    "node = rclpy.create_node('filter')\nnode.create_subscription(LaserScan, 'scan', print, 10)\n",
    "launch/both.launch.xml": "<launch>\n  <node pkg='lidar' exec='driver.py' name='driver'/>\n"
    "  <node pkg='lidar' exec='filter.py' name='filter'/>\n</launch>\n",
}
"""A package whose filter requests reliable scans, while its driver offers best effort."""


def test_a_name_that_only_systems_have(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A resolved name has the start of the node, the launch line, the line of code, and the origin of the name."""
    found = channel(snapshot, settings, kind="topic", name="/rover1/mux/cmd_vel")
    assert found["name"] == "/rover1/mux/cmd_vel"
    assert found["systems"] == ["rover_robot/launch/rover.launch"]
    (end,) = found["endpoints"]
    assert (end["role"], end["instance"], end["name"]) == ("subscribes", "/rover1/base_controller", "cmd_vel")
    assert (end["package"], end["node"]) == ("rover_robot", "base_controller")
    assert end["launched"]["path"].endswith("rover.launch")
    assert end["evidence"]["path"].endswith("base_controller.cpp")
    assert end["set_at"]["words"].startswith("remapped from")


def test_each_thing_has_one_row(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A start included by several launch files, and code of several types, are one row each."""
    for kind in CLASSES:
        for name in names(snapshot, kind):
            rows = channel(snapshot, settings, kind=kind, name=name)["endpoints"]
            keys = [
                (
                    one["role"],
                    one["instance"],
                    one["package"],
                    one["node"],
                    *_lines(one),
                    one["quality"],
                    one["condition"],
                )
                for one in rows
            ]
            assert rows
            assert len(set(keys)) == len(keys)
    (end,) = channel(snapshot, settings, kind="topic", name="/drone1/gimbal/angles")["endpoints"]
    assert end["systems"] == ["drone_control/launch/drone.launch.py", "drone_mission/launch/mission.launch.xml"]


def _lines(row: dict[str, object]) -> list[str]:
    return [str(row[name]) for name in ("launched", "evidence")]


def test_code_that_no_launch_file_starts_under_the_name(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Nodes started alone have no launch file, and are omitted if a launch file gives them the same name."""
    (end,) = channel(snapshot, settings, kind="topic", name="cmd_vel")["endpoints"]
    assert (end["instance"], end["launched"], end["systems"]) == (None, None, [])
    ends = channel(snapshot, settings, kind="topic", name="/emergency_stop")["endpoints"]
    assert {one["instance"] is None for one in ends} == {False}


def test_names_are_meant_as_they_are_written(snapshot: EmbeddedSnapshot) -> None:
    """A name may be absolute, that in the code, private, or part of one or several names."""
    assert resolve_channel(snapshot, "topic", "/odom") == ("/odom", [])
    assert resolve_channel(snapshot, "topic", "cmd_vel") == ("/cmd_vel", ["/rover1/mux/cmd_vel"])
    private = resolve_channel(snapshot, "topic", "~/angles")
    assert private == (None, ["/drone1/gimbal/angles", "/gimbal/angles"])
    assert resolve_channel(snapshot, "topic", "Front_Left") == (
        None,
        ["/drone1/motors/front_left/load", "/motors/front_left/load"],
    )
    assert resolve_channel(snapshot, "topic", "mux/cmd")[0] == "/rover1/mux/cmd_vel"


def test_last_segments_of_a_name_come_before_other_parts(snapshot: EmbeddedSnapshot) -> None:
    """A part that is the end of names means these alone, even if others contain it."""
    assert resolve_channel(snapshot, "topic", "state") == ("/state", ["/drone1/flight/state", "/drone1/state"])
    chosen, others = resolve_channel(snapshot, "topic", "report")
    assert chosen is None
    assert {one.rpartition("/")[2] for one in others} == {"report"}


def test_code_whose_name_is_partly_unknown_may_have_a_name(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A name that nothing has for certain shows the code that may have it; a known end of a side hides such code."""
    (end,) = channel(snapshot, settings, kind="topic", name="/ground/winch/report")["endpoints"]
    assert (end["name"], end["node"], end["possible"]) == ("/ground/{subsystem}/report", "GroundLink", True)
    certain = channel(snapshot, settings, kind="topic", name="/ground/telemetry/report")["endpoints"]
    assert not any(one.get("possible") for one in certain)
    with pytest.raises(UnknownNameError):
        channel(snapshot, settings, kind="topic", name="/ground/winch/load")


def test_code_of_the_type_with_an_unknown_name_may_be_an_end(tmp_path: Path) -> None:
    """A side without ends shows the code of its type whose names are unknown."""
    subscriber = (
        _LIDAR["filter.py"].replace("'scan'", "os.environ['SCAN']").replace("import rclpy", "import os, rclpy", 1)
    )
    settings = _built(tmp_path, {**_LIDAR, "filter.py": subscriber})
    with reading(settings) as snapshot:
        scan, tilt = (channel(snapshot, settings, kind="topic", name=name)["endpoints"] for name in ("/scan", "/tilt"))
    assert [(one["role"], one["node"]) for one in scan if one.get("possible")] == [("subscribes", "filter")]
    assert not any(one.get("possible") for one in tilt)


def test_types_of_the_store_have_the_place_of_their_definition(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A type defined in a package of the store has its file and line, another has none."""
    (place,) = channel(snapshot, settings, kind="topic", name="/drone1/state")["definitions"]
    assert place["path"].endswith("drone_interfaces/msg/FlightState.msg")
    assert channel(snapshot, settings, kind="topic", name="/odom")["definitions"] == []


def test_what_several_names_are(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Each of several matching names has its types, its nodes, and its number of launch files."""
    found = channel(snapshot, settings, kind="topic", name="angles")
    assert found["name"] is None
    (launched, alone) = found["meant"]
    assert (launched["name"], launched["systems"], launched["givers"]) == (
        "/drone1/gimbal/angles",
        2,
        ("drone_control/gimbal_node",),
    )
    assert (alone["name"], alone["systems"]) == ("/gimbal/angles", 0)


def test_launch_files_narrow(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """With a launch file, only its nodes are listed, without unstarted code; an unknown file is KG422."""
    found = channel(snapshot, settings, kind="topic", name="/drone1/gimbal/angles", system="drone.launch.py")
    assert found["systems"] == ["drone_control/launch/drone.launch.py"]
    assert found["endpoints"][0]["systems"] == found["systems"]
    assert channel(snapshot, settings, kind="topic", name="angles", system="drone.launch.py") == found
    for name, launch, code in (("/odom", "drone.launch.py", "KG001"), ("/odom", "dron.launch", "KG422")):
        with pytest.raises(UnknownNameError) as caught:
            channel(snapshot, settings, kind="topic", name=name, system=launch)
        assert caught.value.code == code


def _built(tmp_path: Path, files: Mapping[str, str]) -> Settings:
    """Build a package of these files and return the settings of its store."""
    for path, text in files.items():
        (tmp_path / "lidar" / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "lidar" / path).write_text(text)
    settings = load({"store": str(tmp_path / ".kg")}, environment={})
    build([str(tmp_path / "lidar")], EmbeddedStore.create(tmp_path / ".kg"), settings)
    return settings


def test_ends_that_do_not_fit_are_marked(tmp_path: Path) -> None:
    """Findings about types and QoS are shown at the name, and at the affected ends."""
    settings = _built(tmp_path, _LIDAR)
    with reading(settings) as snapshot:
        scan, tilt = (channel(snapshot, settings, kind="topic", name=name) for name in ("/scan", "/tilt"))
        edges = system(snapshot, settings, name="both.launch.xml")["picture"]["edges"]
    (finding,) = scan["findings"]
    assert (finding["code"], finding["systems"]) == ("KG410", ["lidar/launch/both.launch.xml"])
    marked = {one["instance"]: one["mismatches"] for one in scan["endpoints"]}
    assert marked == {"/driver": [finding["message"]], "/filter": [finding["message"]]}
    assert (tilt["findings"], [one["mismatches"] for one in tilt["endpoints"]]) == ([], [[]])
    drawn = {(one["source"], one["target"]) for one in edges if one["marked"]}
    assert {one for pair in drawn for one in pair} == {"/driver", "/filter", "topic /scan (1)"}


def test_names_that_nothing_has(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """An unknown name is KG001 with suggestions from systems; another kind is KG003."""
    with pytest.raises(UnknownNameError) as caught:
        channel(snapshot, settings, kind="topic", name="/rover1/mux/cmd_vell")
    assert caught.value.code == "KG001"
    assert "`/rover1/mux/cmd_vel`" in (caught.value.hint or "")
    for empty in ("", "/", "~"):
        with pytest.raises(UnknownNameError):
            channel(snapshot, settings, kind="topic", name=empty)
    with pytest.raises(UsageError):
        channel(snapshot, settings, kind="message", name="/odom")


def test_a_parameter_with_its_values(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A parameter has its declaring nodes, and for each start the source of its value, or its default."""
    found = parameter(snapshot, settings, name="rate")
    assert [(one["node"], one["default"]) for one in found["declared"]] == [
        ("flight_controller", "50.0"),
        ("topic_logger", "1"),
    ]
    values = {one["parameter"]: one for one in found["values"]}
    assert values["/trace_logger/rate"]["value"] == "5"
    assert values["/trace_logger/rate"]["set_at"]["path"].endswith("arm.launch")
    flight = values["/drone1/flight_controller/rate"]
    assert (flight["value"], flight["set_at"], len(flight["systems"])) == ("50.0", None, 2)
    narrowed = parameter(snapshot, settings, name="rate", system="arm.launch")["values"]
    assert [one["parameter"] for one in narrowed] == ["/trace_logger/rate"]


def test_an_unknown_parameter_file_may_set_a_parameter(tmp_path: Path) -> None:
    """A start that loads an unknown file has no default in force: the value is unknown, set at the line of the file."""
    launch = "<launch>\n  <node pkg='lidar' exec='driver.py' name='driver'>\n    <param from='$(env SETTINGS)'/>\n"
    driver = _LIDAR["driver.py"] + "node.declare_parameter('rate', 10)\n"
    files = {**_LIDAR, "driver.py": driver, "launch/one.launch.xml": f"{launch}  </node>\n</launch>\n"}
    settings = _built(tmp_path, files)
    with reading(settings) as snapshot:
        values = parameter(snapshot, settings, name="rate")["values"]
    by_system = {one["systems"][0].rpartition("/")[2]: one for one in values}
    assert (by_system["both.launch.xml"]["value"], by_system["both.launch.xml"]["set_at"]) == ("10", None)
    unknown = by_system["one.launch.xml"]
    assert (unknown["value"], unknown["set_at"]["line"]) == (None, 3)
    assert "file" in unknown["reason"]


def test_an_unknown_parameter_file_may_give_another_name(tmp_path: Path) -> None:
    """An end whose name is a default that an unknown file may replace has this as a condition."""
    driver = _LIDAR["driver.py"].replace("'tilt'", "node.declare_parameter('tilt_topic', 'tilt').value")
    launch = "<launch>\n  <node pkg='lidar' exec='driver.py' name='driver'>\n    <param from='$(env SETTINGS)'/>\n"
    files = {**_LIDAR, "driver.py": driver, "launch/one.launch.xml": f"{launch}  </node>\n</launch>\n"}
    settings = _built(tmp_path, files)
    with reading(settings) as snapshot:
        ends = channel(snapshot, settings, name="/tilt")["endpoints"]
    (doubted,) = [one["quality"] for one in ends if "one.launch.xml" in one["systems"][0]]
    assert doubted.startswith("unless an unknown parameter file sets tilt_topic, ")


def test_parameters_by_other_names(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """The name may have the node's name as prefix, or be part of one; an unknown one is KG001."""
    logged = parameter(snapshot, settings, name="/trace_logger/rate")
    assert [one["instance"] for one in logged["values"]] == ["/trace_logger"]
    assert [one["node"] for one in logged["declared"]] == ["topic_logger"]
    default = parameter(snapshot, settings, name="/drone1/flight_controller/rate")
    assert [(one["instance"], one["set_at"]) for one in default["values"]] == [("/drone1/flight_controller", None)]
    several = parameter(snapshot, settings, name="_topic")
    assert several["name"] is None
    assert {"goal_topic", "scan_topic"} <= set(several["meant"])
    for unknown in ("no_such_parameter", "", "~/"):
        with pytest.raises(UnknownNameError) as caught:
            parameter(snapshot, settings, name=unknown)
        assert caught.value.code == "KG001"
