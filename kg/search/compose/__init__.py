"""Chains of nodes that convert messages of one type into another, ranked, each with a launch file that wires it.

`running` builds the network of nodes and types, and uses the others: `asking` resolves types and names, `chains` finds
the cheapest chains, `details` reads the places of their ends in code, `wiring` names their topics, and `launching`
writes the launch file.
"""

from __future__ import annotations

from kg.search.compose.results import Answer
from kg.search.compose.running import Question, compose

__all__ = ["Answer", "Question", "compose"]
