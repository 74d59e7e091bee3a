"""Warnings at the blocks of a program that may have no effect on a robot."""

from __future__ import annotations

import msgspec
from robot.programs.trolley import CAPABILITIES

from kg.facts import Role
from kg.robot.connection import ComputationGraph, GraphProblem, LiveEnd
from kg.robot.programs.check import doubts
from kg.robot.programs.parse import parse

PROGRAM = """repeat 2 times
  move at a velocity  forward: 0.1 m/s for 1 s
  if x of sensingPose > 1 m and x of sensingPose < 2 m then
    move at a velocity  forward: 0.2 m/s for 1 s
  end
end
fly to the moon
"""
(DRIVING,) = (one for one in CAPABILITIES.capabilities if one.name == "drivingAtVelocity")
(POSE,) = (one for one in CAPABILITIES.capabilities if one.name == "sensingPose")
ENDS = (
    LiveEnd("/trolley", Role.SUBSCRIBES, DRIVING.ways[0].name, DRIVING.ways[0].type),
    LiveEnd("/trolley", Role.PUBLISHES, POSE.ways[0].name, POSE.ways[0].type),
)


def told(*ends: LiveEnd, problems: tuple[GraphProblem, ...] = ()) -> list[str]:
    """Return the warnings about the program in a graph."""
    found = doubts(parse(PROGRAM), CAPABILITIES, ComputationGraph(1, ends=ends, problems=problems))
    assert all(msgspec.to_builtins(one)["severity"] == "warning" for one in found)
    return [f"{one.path} {one.code} {one.message}" for one in found]


def test_who_is_there_and_fits_is_not_doubted() -> None:
    """Available nodes give no warning, and neither do mismatches of unrelated ones."""
    elsewhere = GraphProblem("KG815", "/image", "/eye receives nothing from /camera")
    assert told(*ENDS, problems=(elsewhere,)) == []


def test_a_topic_without_anybody_is_told_at_the_first_block() -> None:
    """A topic without subscriber or publisher is reported once, at the block and the condition that need it."""
    topics = DRIVING.ways[0].name, POSE.ways[0].name
    pose = f"`{POSE.label}` may have no effect: {topics[1]}: no node publishes `{topics[1]}`"
    assert told() == [
        f"/body/0/body/0 KG824 `{DRIVING.label}` may have no effect: {topics[0]}: no node listens to `{topics[0]}`",
        f"/body/0/body/1/condition KG825 {pose}",
    ]


def test_one_of_several_nodes_that_is_dead_is_not_doubted() -> None:
    """While a live node subscribes to a block's topic, others may be dead."""
    dead = GraphProblem("KG811", "/recorder", "nothing listens")
    recorder = LiveEnd("/recorder", Role.SUBSCRIBES, DRIVING.ways[0].name, DRIVING.ways[0].type)
    assert told(*ENDS, recorder, problems=(dead,)) == []


def test_dead_nodes_and_ends_that_do_not_fit_are_told() -> None:
    """A dead node is named with the reason; so are two ends with incompatible quality of service."""
    dead = GraphProblem("KG811", "/trolley", "nothing listens")
    clash = GraphProblem("KG815", POSE.ways[0].name, "/nav receives nothing from /trolley: it offers best effort")
    first, second, third = told(*ENDS, problems=(dead, clash))
    assert "KG811" in first
    assert "does not answer: nothing listens" in first
    assert "KG811" in second
    assert third.endswith(f"KG815 `{POSE.label}` may have no effect: {clash.subject}: {clash.message}")
