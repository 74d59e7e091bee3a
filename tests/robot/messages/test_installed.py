"""Types of an installed ROS 2, found by `AMENT_PREFIX_PATH`."""

from __future__ import annotations

import asyncio
import os
from pathlib import Path

import pytest
from patience import patient
from robot.dds.domain import domain

from kg.errors import RobotError
from kg.robot.connecting import connect
from kg.robot.messages import Types

SEPARATOR = "=" * 80
HUMBLE = "geometry_msgs/PoseStamped pose\nstring behavior_tree\n---\nstd_msgs/Empty result\n---\nint16 recoveries\n"


@pytest.fixture
def overlay(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """Return the first of two prefixes of an installation, the second of which is `below`."""
    monkeypatch.setenv("AMENT_PREFIX_PATH", os.pathsep.join(map(str, (tmp_path / "own", tmp_path / "below"))))
    return tmp_path / "own"


def put(prefix: Path, name: str, text: str) -> None:
    """Install a definition: `package/msg/Name.msg`."""
    file = prefix / "share" / name
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, "utf-8")


def test_installed_types_are_known(overlay: Path) -> None:
    """Messages, services and actions have their definitions, also where one name stands for several of them."""
    put(overlay, "own_msgs/msg/Level.msg", "uint8 FULL=100\nuint8 level 50  # percent\nLevel2[<=3] others\n")
    put(overlay, "own_msgs/msg/Level2.msg", "builtin_interfaces/Time stamp\n")
    put(overlay, "own_msgs/srv/Level.srv", "bool exact\n---\nLevel level\n")
    put(overlay, "own_msgs/action/Charge.action", "Level wanted\n---\nbool done\n---\nLevel now\n")
    types = Types(2)
    assert (types.sort("own_msgs/Level"), types.sort("own_msgs/Charge")) == ("msg", "action")
    assert types.complete("own_msgs/Level_Response", {}) == {"level": {"level": 0, "others": []}}
    assert [one.name for one in types.fields("own_msgs/Charge_SendGoal_Request")] == ["goal_id", "goal"]
    assert types.decode("own_msgs/Level", types.encode("own_msgs/Level", {"level": 7}))["level"] == 7


def test_the_first_prefix_counts(overlay: Path) -> None:
    """As for ROS 2, a package is that of the first prefix that has it, and hides the others."""
    put(overlay, "own_msgs/msg/Level.msg", "float32 level\n")
    put(overlay.with_name("below"), "own_msgs/msg/Level.msg", "uint8 level\n")
    put(overlay.with_name("below"), "own_msgs/msg/Gone.msg", "uint8 level\n")
    types = Types(2)
    assert [one.type for one in types.fields("own_msgs/Level")] == ["float32"]
    assert not types.has("own_msgs/Gone")


def test_an_installed_version_replaces_that_of_kg(overlay: Path) -> None:
    """With Humble installed, the result of `NavigateToPose` has Humble's fields; a robot may have another version."""
    put(overlay, "nav2_msgs/action/NavigateToPose.action", HUMBLE)
    types = Types(2)
    assert [one.name for one in types.fields("nav2_msgs/NavigateToPose_Result")] == ["result"]
    assert [one.name for one in types.fields("nav2_msgs/NavigateToPose_GetResult_Response")] == ["status", "result"]
    types.define("nav2_msgs/NavigateToPose_Result", "uint16 error_code\n")
    assert [one.name for one in types.fields("nav2_msgs/NavigateToPose_Result")] == ["error_code"]


def test_a_peer_does_not_change_a_standard_type_that_is_installed(overlay: Path) -> None:
    """Types of every distribution cannot be redefined by a robot, installed or not."""
    put(overlay, "std_msgs/msg/String.msg", "string data\n")
    types = Types(2)
    with pytest.raises(RobotError) as caught:
        types.define("a/A", f"std_msgs/String s\n{SEPARATOR}\nMSG: std_msgs/String\nint8 data")
    assert caught.value.code == "KG806"


@pytest.mark.parametrize("text", ["wstring data\n", "Nothing data\n", "int8[99999999] data\n", "\ufffe(\n"])
def test_a_definition_that_cannot_be_used(overlay: Path, text: str) -> None:
    """Then the definition of kg counts; without one it is KG804."""
    put(overlay, "std_msgs/msg/String.msg", text)
    put(overlay, "own_msgs/msg/String.msg", text)
    types = Types(2)
    assert types.decode("std_msgs/String", types.encode("std_msgs/String", {"data": "a"})) == {"data": "a"}
    for _ in range(2):
        with pytest.raises(RobotError) as caught:
            types.fields("own_msgs/String")
        assert caught.value.code == "KG804"


def test_names_of_peers_lead_to_no_other_files(overlay: Path) -> None:
    """A name with a path in it is not looked up."""
    put(overlay, "../secret/msg/Level.msg", "uint8 level\n")
    assert not Types(2).has("../secret/Level")
    assert not Types(1).has("own_msgs/Level")


def test_a_connection_reads_an_installed_type(overlay: Path) -> None:
    """Over DDS, whose peers describe no types, a topic of an installed type is read."""
    pytest.importorskip("cyclonedds", reason="the extra `dds` is not installed")

    async def scene() -> object:
        with domain() as number:
            robot = await connect(f"dds://{number}?settle=1", name="/robot")
            put(overlay, "own_msgs/msg/Level.msg", "uint8 level\n")
            publication = await robot.advertise("/level", "own_msgs/Level", latch=True)
            await publication.publish({"level": 42})
            reader = await connect(f"dds://{number}?settle=1", name="/reader")
            async with asyncio.timeout(patient(20)):
                received = await anext(aiter(await reader.subscribe("/level")))
            await reader.aclose()
            await robot.aclose()
            return received.value

    assert asyncio.run(scene()) == {"level": 42}
