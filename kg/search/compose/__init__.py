"""Chains of nodes that convert messages of one type into another, ranked, each with a launch file that wires it.

`reading` builds the network of nodes and types, `asking` resolves types and names, `steps` and `costs` compute the cost
of a node in a chain, `chains` finds the cheapest, `details` reads the places of their ends in code, `wiring` names
their topics, `launching` writes the launch file, and `running` does all of it.
"""

from __future__ import annotations

from kg.search.compose.running import Answer, Question, compose

__all__ = ["Answer", "Question", "compose"]
