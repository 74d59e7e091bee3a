"""Chains of nodes that turn messages of one type into another, ranked, each with the launch file that wires it.

`reading` has the network of nodes and types, `asking` resolves types and names, `steps` and `costs` compute what a
node in a chain is worth, `chains` finds the best, `details` reads where their ends are in code, `wiring` gives names
to their topics, `roslaunch` and `ros2launch` write that down, and `running` does all of it.
"""

from __future__ import annotations

from kg.search.compose.running import Answer, Question, compose

__all__ = ["Answer", "Question", "compose"]
