"""ROS 1 over IPv6."""

from __future__ import annotations

import asyncio
import socket
from contextlib import closing

import pytest
from hypothesis import given
from hypothesis import strategies as st
from patience import patient

from kg.errors import RobotError
from kg.robot.connecting import connect
from kg.robot.ros1 import Master
from kg.robot.ros1.names import listening, netloc, own_host, peer


def _loopback() -> bool:
    try:
        with closing(socket.create_server(("::1", 0), family=socket.AF_INET6)):
            return True
    except OSError:
        return False


needs_ipv6 = pytest.mark.skipif(not _loopback(), reason="this machine has no IPv6")


@needs_ipv6
@pytest.mark.parametrize("setting", [None, "on"])
def test_nodes_meet_over_ipv6(monkeypatch: pytest.MonkeyPatch, setting: str | None) -> None:
    """A master and two nodes with only IPv6 addresses exchange messages, services and the graph."""
    for name in ("ROS_HOSTNAME", "ROS_IP", "ROS_IPV6"):
        monkeypatch.delenv(name, raising=False)
    if setting:
        monkeypatch.setenv("ROS_IPV6", setting)

    async def scene() -> str:
        async with Master("::1") as master, asyncio.timeout(patient(20)):
            assert master.address.startswith("ros1://[::1]:")
            base = await connect(master.address, name="/base")
            face = await connect(master.address, name="/face")
            heard = await base.subscribe("/said", "std_msgs/String")
            told = await face.advertise("/said", "std_msgs/String", latch=True)
            await told.publish({"data": "hello"})
            words = (await anext(aiter(heard))).value["data"]
            await base.serve("/ask", "std_srvs/Trigger", _answered)
            assert (await face.call("/ask", None, {}, seconds=patient(5)))["message"] == "yes"
            (node,) = (await face.graph()).nodes
            assert (node.name, node.problem) == ("/base", None)
            assert str(node.address).startswith("http://[::1]:")
            await face.aclose()
            await base.aclose()
            return str(words)

    assert asyncio.run(scene()) == "hello"


async def _answered(_: dict[str, object]) -> dict[str, object]:
    return {"success": True, "message": "yes"}


@given(st.ip_addresses(), st.integers(1, 65535))
def test_an_address_is_read_as_it_was_written(address: object, port: int) -> None:
    """Host and port are parsed from an address, including that of rospy, which omits the brackets."""
    host = str(address)
    assert peer(f"http://{netloc(host, port)}/") == (host, port)
    assert peer(f"http://{host}:{port}/") == (host, port)


def test_brackets_that_do_not_fit() -> None:
    """Text that resembles IPv6 without being valid is not an address of a node."""
    for text in ("http://[::1:11311/", "http://::1]:11311/", "http://[::1]/", "http://::/", "http://[zz]:1/"):
        with pytest.raises(RobotError) as wrong:
            peer(text)
        assert wrong.value.code == "KG812"


def test_where_a_node_listens(monkeypatch: pytest.MonkeyPatch) -> None:
    """For a host on loopback, only that interface; for IPv6, both protocols."""
    monkeypatch.delenv("ROS_IPV6", raising=False)
    every = "0.0.0.0"  # noqa: S104 - nothing is bound to it here
    expected = {"localhost": "127.0.0.1", "127.0.1.1": "127.0.0.1", "::1": "::1", "10.0.0.7": every, "fe80::7": "::"}
    assert {host: listening(host) for host in expected} == expected
    monkeypatch.setenv("ROS_IPV6", "on")
    assert [listening(host) for host in ("10.0.0.7", "robot", "localhost", "::1")] == ["::", "::", "::", "::1"]


def test_our_own_address_is_of_the_protocol_of_the_master(monkeypatch: pytest.MonkeyPatch) -> None:
    """The address towards the master has the master's protocol, unless the environment overrides it."""
    for name in ("ROS_HOSTNAME", "ROS_IP", "ROS_IPV6"):
        monkeypatch.delenv(name, raising=False)
    assert own_host("::1", 11311) == "::1"
    assert "." in own_host("192.0.2.1", 11311) or own_host("192.0.2.1", 11311) == socket.gethostname()
    monkeypatch.setenv("ROS_IP", "2001:db8::7")
    assert own_host("::1", 11311) == "2001:db8::7"
