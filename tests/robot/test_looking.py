"""Snapshot of a running system."""

from __future__ import annotations

import asyncio
import re
import time

import pytest
from robot.dds.domain import domain

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.connecting import connect, look, of_robot
from kg.robot.connection import ComputationGraph, GraphProblem, LiveEnd, LiveNode
from kg.robot.ros1 import Master


def test_an_empty_domain_is_no_robot() -> None:
    """An empty domain is an error, with the duration of listening."""
    begun = time.monotonic()
    with domain() as number, pytest.raises(RobotError) as nobody:
        asyncio.run(look(f"dds://{number}?settle=1"))
    assert nobody.value.code == "KG802"
    told = re.fullmatch(rf"no node was found at dds://{number}\?settle=1 within (\d+) s", nobody.value.message)
    assert told is not None
    assert 1 <= int(told[1]) <= time.monotonic() - begun + 1


def test_a_master_alone_is_no_robot() -> None:
    """A master with only our node, or also `/rosout`, is not a robot; a robot's graph omits them."""

    async def scene() -> str:
        async with Master() as master:
            with pytest.raises(RobotError) as nobody:
                await look(master.address)
            assert nobody.value.code == "KG802"
            rosout = await connect(master.address, name="/rosout")
            await rosout.subscribe("/rosout", "rosgraph_msgs/Log")
            with pytest.raises(RobotError) as nobody:
                await look(master.address)
            other = await connect(master.address, name="/rover")
            graph = await look(master.address)
            await other.aclose()
            await rosout.aclose()
            assert [node.name for node in graph.nodes] == ["/rover"]
            return nobody.value.message

    assert asyncio.run(scene()).startswith("no node was found at ros1://")


@pytest.mark.parametrize(
    ("ros", "name", "counts"),
    [
        (1, "/rosout", False),
        (1, "/rosout_filter", True),
        (1, "/rostopic_1234_1700000000000", False),
        (2, "/_ros2cli_daemon_0_1a2b", False),
        (2, "/_ros2cli_77", False),
        (2, "/rosout", True),
        (1, "/kg_4711", False),
        (1, "/kg_4711_0123abcd", False),
        (1, "/kg_base", True),
        (2, "/rosapi", False),
    ],
)
def test_nodes_that_are_none_of_the_robots(ros: int, name: str, *, counts: bool) -> None:
    """Nodes of ROS itself and observers are omitted with their ends and problems; similarly named nodes are not."""
    graph = ComputationGraph(
        ros,
        (LiveNode("/base"), LiveNode(name)),
        (LiveEnd(name, Role.SUBSCRIBES, "/odom"), LiveEnd("/base", Role.PUBLISHES, "/odom")),
        (GraphProblem("KG811", name, "it is dead"),),
    )
    left = of_robot(graph)
    assert (left == graph) == counts
    assert left.nodes[0].name == "/base"
    assert (len(left.nodes), len(left.ends), len(left.problems)) == ((2, 2, 1) if counts else (1, 1, 0))
