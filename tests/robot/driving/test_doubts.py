"""Warnings about commands without effect."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest
from robot.driving.rover import CAPABILITIES, COUNTING, DRIVING, WHERE, rover

from kg.facts import Role
from kg.robot.connection import ComputationGraph, GraphProblem, LiveEnd, LiveNode
from kg.robot.driving import Driver
from kg.robot.driving.ways import doubts_of

if TYPE_CHECKING:
    from kg.robot.capability import Capability

DEAD = GraphProblem("KG811", "/rover", "nothing listens at http://127.0.0.1:1/")
ROLES = {"topic": (Role.SUBSCRIBES, "KG824"), "action": (Role.ACTION_SERVERS, "KG807")}


def _graph(capability: Capability, role: Role, *problems: GraphProblem) -> ComputationGraph:
    way = capability.ways[0]
    return ComputationGraph(1, (LiveNode(way.node),), (LiveEnd(way.node, role, way.name, way.type),), problems)


@pytest.mark.parametrize("capability", [DRIVING, COUNTING])
def test_a_node_that_is_dead_or_missing(capability: Capability) -> None:
    """A dead node is named with its command, unless another is alive; without any node, the way is named."""
    way = capability.ways[0]
    role, code = ROLES[way.kind]
    assert not list(doubts_of(way, _graph(capability, role), reads=False))
    elsewhere = GraphProblem("KG811", "/laser", "nothing listens")
    assert not list(doubts_of(way, _graph(capability, role, elsewhere), reads=False))
    (dead,) = doubts_of(way, _graph(capability, role, DEAD), reads=False)
    assert (dead.code, dead.subject) == ("KG811", "/rover")
    assert f"`{way.name}`, and does not answer: nothing listens" in dead.message
    recorder = LiveEnd("/recorder", role, way.name, way.type)
    one_lives = _graph(capability, role, DEAD)
    assert not list(doubts_of(way, replace(one_lives, ends=(*one_lives.ends, recorder)), reads=False))
    (missing,) = doubts_of(way, ComputationGraph(1), reads=False)
    assert (missing.code, missing.subject) == (code, way.name)


def test_who_reads_is_told_of_publishers() -> None:
    """A reading depends on publishers; a dead subscriber does not matter."""
    way = WHERE.ways[0]
    assert not list(doubts_of(way, _graph(WHERE, Role.PUBLISHES), reads=True))
    (missing,) = doubts_of(way, _graph(WHERE, Role.SUBSCRIBES, DEAD), reads=True)
    assert missing == GraphProblem("KG825", "/odom", "no node publishes `/odom`")


def test_the_driver_asks_the_graph() -> None:
    """An available rover gives no warning; a topic used by no node, or only by an observer, does.

    A driver that is given the graph does not request it again at once.
    """

    async def scene() -> None:
        async with rover() as robot:
            assert await robot.driver.doubts("driving", "write", way="/cmd_vel") == ()
            (missing,) = await robot.driver.doubts("sensingPose", "read")
            assert missing.code == "KG825"
            await robot.bus.join("/rostopic_4_1700000000000").subscribe("/say", "std_msgs/String")
            (missing,) = await robot.driver.doubts("saying", "write")
            assert missing.code == "KG824"
            async with Driver(robot.face, CAPABILITIES, graph=ComputationGraph(1)) as told:
                (missing,) = await told.doubts("driving", "write", way="/cmd_vel")
                assert missing.code == "KG824"

    asyncio.run(scene())
