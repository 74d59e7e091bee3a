"""Why what is read or done may come to nothing: nodes that do not answer, topics that nobody listens to."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.facts import Role
from kg.robot.connection import GraphProblem

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.robot.capability import Way
    from kg.robot.connection import ComputationGraph

__all__ = ["doubts_of", "role_of"]

_DEAD: Final = "KG811"
_SERVED_BY: Final = {"service": Role.SERVICES, "action": Role.ACTION_SERVERS}
_DOES: Final = {
    Role.PUBLISHES: ("publishes", "KG825"),
    Role.SUBSCRIBES: ("listens to", "KG824"),
    Role.SERVICES: ("serves", "KG807"),
    Role.ACTION_SERVERS: ("carries out goals of", "KG807"),
}
"""What the nodes of a way do, and the code of what happens where none does."""


def role_of(way: Way, *, reads: bool) -> Role:
    """Return the role of the nodes that a way leads to."""
    return _SERVED_BY.get(way.kind, Role.PUBLISHES if reads else Role.SUBSCRIBES)


def doubts_of(way: Way, graph: ComputationGraph, *, reads: bool) -> Iterator[GraphProblem]:
    """Yield what a computation graph says against a way: that its nodes are registered and dead, or that it has none.

    Where one node is alive nothing comes to nothing. The code is KG811 for a node that does not answer, else that of
    the error to be expected.
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
