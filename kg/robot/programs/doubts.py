"""Why parts of a program may come to nothing on a robot, although it has the capabilities: asked of its graph."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Final, Literal

from kg.errors import RobotError
from kg.robot.driving.ways import choose, doubts_of
from kg.robot.programs.names import Known
from kg.robot.programs.problems import Problem
from kg.robot.programs.tree import Do
from kg.robot.programs.walk import expressions_of, reads_of, statements

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.robot.capability import Capabilities, Capability
    from kg.robot.connection import ComputationGraph, GraphProblem
    from kg.robot.programs.tree import Program, Statement

__all__ = ["doubts"]

_MISFITS: Final = frozenset({"KG806", "KG815"})
"""The codes of ends of a topic that are not connected, since their types or qualities of service do not fit."""
_Used = tuple[str, str, Literal["read", "write"]]
"""The part of the path that leads to something, the name of its capability, and whether that is read or done."""


def doubts(program: Program, capabilities: Capabilities, graph: ComputationGraph) -> list[Problem]:
    """Return warnings at what moves or reads something that no live node listens to, or tells.

    Each is told once, at the first block that needs it. What the robot cannot do at all is told by `check`.
    """
    known = Known(capabilities)
    told: set[GraphProblem] = set()
    found = []
    for path, statement in statements(program.body):
        for part, name, modality in _used(statement):
            with suppress(RobotError):
                capability = known.read(name) if modality == "read" else known.write(name)
                for doubt in _of(capability, graph):
                    if doubt not in told:
                        told.add(doubt)
                        found.append(_warning(doubt, capability, f"{path}{part}", statement))
    return found


def _used(statement: Statement) -> Iterator[_Used]:
    if isinstance(statement, Do):
        yield "", statement.capability, "write"
    for part, expression in expressions_of(statement):
        for read in reads_of(expression):
            yield f"/{part}", read.capability, "read"


def _of(capability: Capability, graph: ComputationGraph) -> Iterator[GraphProblem]:
    reads = capability.modality == "read"
    ways = [one for one in capability.ways if not (reads and one.kind == "action")]
    if not ways:
        return
    way = choose(ways, (), graph, reads=reads)
    yield from doubts_of(way, graph, reads=reads)
    if way.kind == "topic":
        yield from (one for one in graph.problems if one.code in _MISFITS and one.subject == way.name)


def _warning(doubt: GraphProblem, capability: Capability, path: str, statement: Statement) -> Problem:
    message = f"`{capability.label}` may have no effect: {doubt.subject}: {doubt.message}"
    return Problem(id=statement.id, path=path, message=message, code=doubt.code, severity="warning")
