"""Running systems as graphs: the capabilities of their nodes, with or without a store."""

from __future__ import annotations

from kg.robot.live.inference import infer, infer_system
from kg.robot.live.systems import name_of
from kg.robot.live.watching import Event, Watching

__all__ = ["Event", "Watching", "infer", "infer_system", "name_of"]
