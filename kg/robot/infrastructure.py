"""Nodes of a running system that are none of the robot's, such as `/rosout` and those of command lines."""

from __future__ import annotations

import re
import tomllib
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

from kg.resources import folder

if TYPE_CHECKING:
    from kg.robot.connection import ComputationGraph

__all__ = ["of_robot"]


def of_robot(graph: ComputationGraph) -> ComputationGraph:
    """Return a computation graph without the nodes that `ontology/implicit.toml` calls infrastructure."""
    pattern = _pattern(graph.ros)
    if not any(pattern.fullmatch(one.name) for one in graph.nodes):
        return graph
    return replace(
        graph,
        nodes=tuple(one for one in graph.nodes if not pattern.fullmatch(one.name)),
        ends=tuple(one for one in graph.ends if not pattern.fullmatch(one.node)),
        problems=tuple(one for one in graph.problems if not pattern.fullmatch(one.subject)),
    )


@cache
def _pattern(ros: int) -> re.Pattern[str]:
    table = tomllib.loads((folder("ontology") / "implicit.toml").read_text(encoding="utf-8"))
    rows = (row for row in table["infrastructure"] if row.get("ros", ros) == ros)
    return re.compile("|".join(f"(?:{row['pattern']})" for row in rows))
