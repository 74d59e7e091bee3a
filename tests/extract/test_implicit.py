from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kg.errors import UsageError
from kg.extract.implicit import add, load_table
from kg.extract.marks import Extracted, Mark
from kg.facts import Interface, Location, NodeKind, NodeType, Resolution, Role

if TYPE_CHECKING:
    from pathlib import Path

HERE = Location("src/a.cpp", 7)


def node(ros: int, language: str = "cpp", *interfaces: Interface) -> NodeType:
    """Return a node of that version and language."""
    return NodeType("a", NodeKind.EXECUTABLE, language, ros, Location("src/a.cpp", 1), interfaces=interfaces)


def names(found: NodeType, role: Role) -> set[str | None]:
    """Return the names of a node's interfaces with a role."""
    return {interface.name for interface in found.interfaces if interface.role is role}


def test_every_ros1_node_logs_and_serves_its_loggers() -> None:
    """A ROS 1 node without any mark has the interfaces of every running one."""
    found = add(Extracted(node(1)))
    assert names(found, Role.PUBLISHES) == {"/rosout"}
    assert names(found, Role.SERVICES) == {"~/get_loggers", "~/set_logger_level"}
    assert all(interface.implicit and interface.origin for interface in found.interfaces)


def test_every_ros2_node_has_its_parameter_services() -> None:
    """A ROS 2 node has six parameter services; only C++ ones subscribe to parameter events by default."""
    cpp, python = add(Extracted(node(2))), add(Extracted(node(2, "python")))
    services = {f"~/{verb}" for verb in ("describe_parameters", "get_parameters", "list_parameters", "set_parameters")}
    assert services <= names(cpp, Role.SERVICES)
    assert "/parameter_events" in names(cpp, Role.SUBSCRIBES)
    assert "/parameter_events" not in names(python, Role.SUBSCRIBES)


def test_a_mark_fills_namespace_and_detail() -> None:
    """The interfaces of dynamic_reconfigure are below the handle's namespace, those of a bond at its topic."""
    marks = (Mark("dynamic_reconfigure.server", HERE, "~/costmap"), Mark("bond", HERE, detail="/bond"))
    found = add(Extracted(node(1), marks))
    assert {"~/costmap/parameter_descriptions", "~/costmap/parameter_updates"} <= names(found, Role.PUBLISHES)
    assert "~/costmap/set_parameters" in names(found, Role.SERVICES)
    assert "/bond" in names(found, Role.PUBLISHES) & names(found, Role.SUBSCRIBES)
    assert {i.location for i in found.interfaces if i.name == "/bond"} == {HERE}


def test_what_the_mark_does_not_tell_is_left_out() -> None:
    """An image publisher with an unknown topic has no transports."""
    found = add(Extracted(node(2), (Mark("image_transport.publisher", HERE),)))
    assert names(found, Role.PUBLISHES) == {"/rosout", "/parameter_events"}


def test_the_service_of_a_camera_has_the_name_of_the_release() -> None:
    """Until Humble, a camera of ROS 2 is calibrated beside the node, then below it, by a service of two conditions."""
    found = add(Extracted(node(2), (Mark("camera_info_manager", HERE),)))
    origins = {one.name: one.origin for one in found.interfaces if one.type == "sensor_msgs/SetCameraInfo"}
    assert {name: "Humble or earlier" in str(origin) for name, origin in origins.items()} == {
        "set_camera_info": True,
        "~/set_camera_info": False,
    }


def test_a_condition_stands_in_the_origin() -> None:
    """A conditional interface has its condition."""
    clocks = [i for i in add(Extracted(node(2))).interfaces if i.name == "/clock"]
    assert [clock.origin for clock in clocks] == ["ros2.node, if use_sim_time is true"]


def test_what_the_code_declares_itself_stays_explicit_and_single() -> None:
    """A name declared by the node's own code is not repeated as implicit."""
    own = Interface(Role.PUBLISHES, "/tf", "tf2_msgs/TFMessage", Resolution.LITERAL, HERE)
    found = add(Extracted(node(1, "cpp", own), (Mark("tf.broadcaster", HERE),)))
    assert [i for i in found.interfaces if i.name == "/tf"] == [own]


def test_two_marks_of_a_kind_bring_their_interfaces_once() -> None:
    """Two transform listeners of a node are one subscription to each topic."""
    marks = (Mark("tf.listener", HERE), Mark("tf.listener", Location("src/b.cpp", 9)))
    found = add(Extracted(node(1), marks))
    assert sorted(i.name or "" for i in found.interfaces if i.role is Role.SUBSCRIBES) == [
        "/clock",
        "/tf",
        "/tf_static",
    ]


@pytest.mark.parametrize(
    "text",
    [
        "use = 3",
        "[[use]]\nros = 1",
        '[[use]]\nmark = "m"\ninterfaces = [{ role = "sings", name = "a", type = "b/C" }]',
        '[[use]]\nmark = "m"\ninterfaces = [{ role = "publishes", name = "a", type = "b/C", qos = { loud = true } }]',
        "[[use",
    ],
)
def test_a_table_that_cannot_be_used_is_refused_by_name(tmp_path: Path, text: str) -> None:
    """A mistake in the table is an error that names the file."""
    path = tmp_path / "implicit.toml"
    path.write_text(text)
    with pytest.raises(UsageError) as caught:
        load_table(path)
    assert caught.value.code == "KG002"
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    ("mark", "reason"),
    [
        (Mark("dynamic_reconfigure.server", HERE, "{}/yaw"), "the namespace that the code gives to it is not known"),
        (Mark("bond", HERE, detail="/bond{}"), "a part of it is made by its library when the program runs"),
    ],
    ids=lambda value: value.key if isinstance(value, Mark) else "",
)
def test_a_name_that_is_not_known_in_full_has_a_reason(mark: Mark, reason: str) -> None:
    """The unknown part of a name comes from the code or from the library."""
    found = add(Extracted(node(1), (mark,)))
    open_ones = [one for one in found.interfaces if one.resolution is Resolution.PARTIAL]
    assert open_ones
    assert {one.reason for one in open_ones} == {reason}
