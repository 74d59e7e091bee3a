"""What differs between two states of sources: interfaces of node types, and how launch files wire them."""

from __future__ import annotations

from kg.compare.changes import Change, Difference, Finding, Kind, Level, Side, Sources
from kg.compare.comparing import compare

__all__ = ["Change", "Difference", "Finding", "Kind", "Level", "Side", "Sources", "compare"]
