"""Differences between two states of sources: interfaces of node types, and how launch files wire them."""

from __future__ import annotations

from kg.launch.comparison.changes import Change, Difference, Finding, Kind, Level, Side, Sources
from kg.launch.comparison.states import compare

__all__ = ["Change", "Difference", "Finding", "Kind", "Level", "Side", "Sources", "compare"]
