"""The range of discovery, by the variables of ROS 2."""

from __future__ import annotations

import os
from subprocess import PIPE
from typing import TYPE_CHECKING, Final

import pytest

pytest.importorskip("cyclonedds", reason="the extra `dds` is not installed")

from forks import start
from patience import patient
from robot.dds.domain import domain

from kg.errors import RobotError
from kg.robot.dds.domains import discovery_settings

if TYPE_CHECKING:
    from collections.abc import Mapping

_MODULES: Final = ("kg.robot.dds",)
"""What both processes import at their start."""
LOOPBACK = (
    "<CycloneDDS><Domain><General><AllowMulticast>false</AllowMulticast>"
    "<Interfaces><NetworkInterface name='lo' multicast='false'/></Interfaces></General>"
    "<Discovery><Peers AddLocalhost='false'/></Discovery></Domain></CycloneDDS>"
)
"""Without peers: only the variables enable discovery."""
TALKER = """
import asyncio, sys
from kg.robot.connecting import connect

async def main():
    node = await connect(sys.argv[1], name="/talker")
    await node.advertise("/text", "std_msgs/String")
    print("ready", flush=True)
    await asyncio.get_running_loop().run_in_executor(None, sys.stdin.read)
    await node.aclose()

asyncio.run(main())
"""


def found(settings: Mapping[str, str]) -> str:
    """Return the topics that kg lists of a node with the same variables."""
    with domain() as number:
        environment = {key: value for key, value in os.environ.items() if not key.startswith("ROS_")}
        environment |= {"CYCLONEDDS_URI": LOOPBACK, **settings}
        address = f"dds://{number}?settle=1.5"
        with start(
            *("-c", TALKER, address), environment=environment, streams=(PIPE, PIPE, None), modules=_MODULES
        ) as talker:
            assert talker.stdout is not None
            assert talker.stdout.readline() == "ready\n"
            command = ("-m", "kg", "robot", "topics", "--robot", address)
            with start(*command, environment=environment, modules=_MODULES) as lister:
                listed = lister.communicate(timeout=patient(20))
            talker.communicate(timeout=patient(10))
    return "".join(listed)


@pytest.mark.parametrize(
    "settings",
    [
        {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"},
        {"ROS_LOCALHOST_ONLY": "1"},
        {"ROS_STATIC_PEERS": "127.0.0.1;127.0.0.2"},
        {"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET", "ROS_STATIC_PEERS": "127.0.0.1"},
    ],
)
def test_nodes_within_reach_are_found(settings: Mapping[str, str]) -> None:
    """Without multicast, nodes of this machine are discovered if the variables enable it."""
    assert "/text\tstd_msgs/String\t/talker" in found(settings)


@pytest.mark.parametrize("settings", [{}, {"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF", "ROS_STATIC_PEERS": "127.0.0.1"}])
def test_nodes_out_of_reach_are_not_found(settings: Mapping[str, str]) -> None:
    """If the variables are unset, or disable discovery, no node is discovered."""
    assert "KG802" in found(settings)


def test_without_variables_nothing_is_set() -> None:
    """Without variables the settings are those of Cyclone DDS; the range SYSTEM_DEFAULT does the same."""
    assert discovery_settings({}) == ""
    assert discovery_settings({"ROS_LOCALHOST_ONLY": "0", "ROS_STATIC_PEERS": " ; "}) == ""
    assert discovery_settings({"ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT", "ROS_STATIC_PEERS": "a"}) == ""


def test_localhost_only_leaves_static_peers_out() -> None:
    """ROS_LOCALHOST_ONLY takes precedence over its replacement."""
    told = discovery_settings({"ROS_LOCALHOST_ONLY": "1", "ROS_STATIC_PEERS": "robot"})
    assert "localhost" in told
    assert "robot" not in told


def test_a_peer_cannot_break_the_settings() -> None:
    """The content of a variable is a plain value, whatever its characters."""
    assert '<Peer address="a&lt;b&gt;"/>' in discovery_settings({"ROS_STATIC_PEERS": "a<b>"})


def test_a_range_that_there_is_not_is_refused() -> None:
    """An unknown range is KG817, with the valid ones."""
    with pytest.raises(RobotError) as refused:
        discovery_settings({"ROS_AUTOMATIC_DISCOVERY_RANGE": "PLANET"})
    assert refused.value.code == "KG817"
    assert "LOCALHOST" in str(refused.value.hint)
