"""From what a launch configuration starts and what node types declare to the computation graph; nothing is run."""

from __future__ import annotations

from kg.launch.wiring.systems import wire
from kg.launch.wiring.types import NodeTypes

__all__ = ["NodeTypes", "wire"]
