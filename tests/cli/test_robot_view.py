"""Messages about a running robot apart from its capabilities."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.cli.commands import robot
from kg.robot import connecting
from kg.robot.connection import ComputationGraph, GraphProblem, LiveNode
from kg.settings import Settings

if TYPE_CHECKING:
    import pytest


def test_a_dead_node_is_told(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """Each node that does not respond is a warning on stderr; the rest of the output is complete."""

    async def look(_: str) -> ComputationGraph:
        dead = GraphProblem("KG811", "/gone", "it does not answer at 127.0.0.1:4")
        return ComputationGraph(1, nodes=(LiveNode("/gone", problem=dead.message),), problems=(dead,))

    monkeypatch.setattr(connecting, "look", look)
    subject = robot._running(Settings(robot="ros1://127.0.0.1:9"))
    told = capsys.readouterr()
    assert subject.capabilities.capabilities == ()
    assert "/gone: KG811 it does not answer at 127.0.0.1:4" in told.err
    assert told.out == ""
