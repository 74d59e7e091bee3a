"""Why the robot can do something, step by step: proofs down to the node that was seen, or to the line."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any

from kg.errors import RobotError
from kg.robot.capabilities import find
from kg.robot.live.asking import running
from kg.robot.live.inference import knowledge, now
from kg.views.evidence import Places
from kg.views.why_tree import Telling

if TYPE_CHECKING:
    from kg.robot.connection import ComputationGraph
    from kg.robot.live.asking import Subject
    from kg.settings import Settings

__all__ = ["Proofs"]


class Proofs:
    """Proofs about the computation graph that was seen last; what they rest on is inferred when somebody asks."""

    def __init__(self, address: str, settings: Settings) -> None:
        self._address = address
        self._settings = settings
        self._graph: ComputationGraph | None = None
        self._subject: tuple[ComputationGraph, Subject] | None = None
        """What was inferred last, of which graph."""
        self._nodes: dict[str, str] = {}
        self._turn = asyncio.Lock()

    def take(self, graph: ComputationGraph | None) -> None:
        """Note what is seen from now; None when nothing is."""
        known, time = self._nodes, now()
        self._nodes = {node.name: known.get(node.name, time) for node in graph.nodes} if graph else {}
        self._graph = graph

    async def why(self, name: str) -> dict[str, Any]:
        """Return `capability`, its name, and `proofs`, a tree as `kg.views.why.why` has it for each node that has it.

        Raises:
            RobotError: KG818 for what the robot cannot do, KG846 while nothing is seen.
        """
        async with self._turn:
            return await asyncio.to_thread(self._why, name)

    def _why(self, name: str) -> dict[str, Any]:
        graph, nodes = self._graph, self._nodes
        if graph is None:
            raise RobotError("KG846", "no robot is connected, so its capabilities cannot be explained")
        known = self._subject  # asked for once: meanwhile the loop may take another graph
        subject = known[1] if known and known[0] is graph else running(graph, self._settings, self._address, nodes)
        self._subject = graph, subject
        rules = knowledge(self._settings).rules
        telling = Telling(subject.view, rules, Places.of(()), self._settings.base)
        one = find(subject.capabilities, name)
        return {"capability": one.name, "proofs": [telling.proof(proof) for proof in subject.why(one.iri)]}
