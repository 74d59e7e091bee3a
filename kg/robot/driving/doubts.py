"""Why what is read or done may come to nothing: nodes that do not answer, topics that nobody listens to."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.facts import Role
from kg.robot.capability import role_of
from kg.robot.connection import GraphProblem
from kg.robot.lifecycle import idle

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.robot.capability import Way
    from kg.robot.connection import ComputationGraph

__all__ = ["doubts_of"]

_DEAD: Final = "KG811"
_IDLE: Final = "KG819"
_DOES: Final = {
    Role.PUBLISHES: ("publishes", "KG825"),
    Role.SUBSCRIBES: ("listens to", "KG824"),
    Role.SERVICES: ("serves", "KG807"),
    Role.ACTION_SERVERS: ("carries out goals of", "KG807"),
}
"""What the nodes of a way do, and the code of what happens where none does."""


def doubts_of(way: Way, graph: ComputationGraph, *, reads: bool) -> Iterator[GraphProblem]:
    """Yield what a computation graph says against a way: that its nodes are dead or not active, or that it has none.

    Where one node works nothing comes to nothing. The code is KG811 for a node that does not answer, KG819 for one that
    is not active, else that of the error to be expected.
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
