"""Resolution of capabilities by name, the choice of an interface, and doubts about its nodes."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import Final, Literal

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.capability import Capabilities, Capability, Way, called, role_of
from kg.robot.connection import ComputationGraph, GraphProblem
from kg.robot.lifecycle import ACTIVE, idle
from kg.similar import did_you_mean


def find(capabilities: Capabilities, name: str, modality: Literal["read", "write"] | None = None) -> Capability:
    """Return the capability of a name, label or alternative label, in any case, that can be read or executed.

    Raises:
        RobotError: KG821 unknown, with suggestions; KG822 it can only be used the other way, or is not available.
    """
    matches = called(capabilities, name)
    if not matches:
        raise _unknown(capabilities, name, modality)
    fitting = [one for one in matches if modality in {None, one.modality}]
    if not fitting:
        can, command = ("done", "do") if matches[0].modality == "write" else ("read", "read")
        hint = f"Use `kg robot {command} {matches[0].name}`."
        raise RobotError("KG822", f"`{matches[0].name}` can only be {can}", hint=hint)
    return min(fitting, key=lambda one: not one.ways)


def _unknown(capabilities: Capabilities, name: str, modality: str | None) -> RobotError:
    candidates = [one for one in capabilities.capabilities if modality in {None, one.modality} and one.ways]
    words = {each: one.name for one in reversed(candidates) for each in (one.name, one.label, *one.alternatives)}
    hint = did_you_mean(name, words)
    if hint is None:
        listed = ", ".join(f"`{one.name}`" for one in candidates)
        hint = f"It can: {listed}." if listed else "No capabilities of it are known."
    return RobotError("KG821", f"{capabilities.of} has no capability `{name}`", hint=hint)


def named(capability: Capability, name: str | None) -> list[Way]:
    """Return the candidate interfaces: all, or those of a channel, node or message type.

    Raises:
        RobotError: KG822 none of that name, or the capability is not available at all.
    """
    if not capability.ways:
        because = f"; it is implied by {', '.join(capability.implied_by)}" if capability.implied_by else ""
        raise RobotError("KG822", f"`{capability.name}` cannot be reached: no node of the robot provides it{because}")
    if name is None:
        return list(capability.ways)
    matches = [one for one in capability.ways if name in {one.name, one.name.lstrip("/"), one.node, one.type}]
    if not matches:
        names = {one.name for one in capability.ways}
        hint = did_you_mean(name, names) or f"Its ways are: {', '.join(sorted(names))}."
        raise RobotError("KG822", f"`{capability.name}` has no way `{name}`", hint=hint)
    return matches


def choose(ways: list[Way], arguments: Collection[str], graph: ComputationGraph | None, *, reads: bool) -> Way:
    """Return the interface to use.

    Preferred are, in this order: one with an active node; one with a field for every argument; the most specific, with
    fields for most parameters; for commands, an action, then a service, then a topic (an action reports its end); for
    readings, a topic; the first.
    """
    order = ("topic", "service", "action") if reads else ("action", "service", "topic")

    ends: set[tuple[str, Role]] = set()
    if graph is not None:
        dead = {one.name for one in graph.nodes if one.problem is not None or one.state not in {None, ACTIVE}}
        ends = {(one.name, one.role) for one in graph.ends if one.node not in dead}

    def key(way: Way) -> tuple[bool, int, int, int]:
        lacking = sum(name not in way.fields for name in arguments)
        dead = graph is not None and (way.name, role_of(way, reads=reads)) not in ends
        return dead, lacking, -len(way.fields), order.index(way.kind)

    return min(ways, key=key)


_DEAD: Final = "KG811"
_IDLE: Final = "KG819"
_DOES: Final = {
    Role.PUBLISHES: ("publishes", "KG825"),
    Role.SUBSCRIBES: ("listens to", "KG824"),
    Role.SERVICES: ("offers", "KG807"),
    Role.ACTION_SERVERS: ("carries out goals of", "KG807"),
}
"""What the nodes of an interface do, and the code of the error if none does."""


def doubts_of(way: Way, graph: ComputationGraph, *, reads: bool) -> Iterator[GraphProblem]:
    """Yield objections of a computation graph to an interface: its nodes are dead, inactive or missing.

    One working node is enough. The code is KG811 for a node that does not answer, KG819 for an inactive one, else that
    of the expected error.
    """
    role = role_of(way, reads=reads)
    does, code = _DOES[role]
    nodes = {one.node for one in graph.ends if one.name == way.name and one.role is role}
    if not nodes:
        yield GraphProblem(code, way.name, f"no node {does} `{way.name}`")
    dead = [one for one in graph.problems if one.code == _DEAD and one.subject in nodes]
    if nodes <= {one.subject for one in dead}:
        for one in dead:
            yield GraphProblem(_DEAD, one.subject, f"it {does} `{way.name}`, and does not answer: {one.message}")
    for node in idle(graph, way.name, role):
        yield GraphProblem(_IDLE, node.name, f"it {does} `{way.name}`, and is {node.state}")
