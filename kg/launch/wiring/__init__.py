"""Builds the computation graph from a launch configuration and the declarations of node types; nothing is run."""

from __future__ import annotations

from kg.launch.wiring.systems import wire
from kg.launch.wiring.types import NodeTypes

__all__ = ["NodeTypes", "wire"]
