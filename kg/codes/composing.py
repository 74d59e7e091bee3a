"""The codes of composing chains of nodes: KG705 to KG707."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

__all__ = ["CODES"]

CODES: Final = {
    "KG705": CodeEntry(
        "type unknown to nodes that can be started",
        "No node of the store that a launch file can start publishes or subscribes messages of this type.",
        "Check the name, `package/Type` or `Type`; `kg topics` lists topics with their types.",
    ),
    "KG706": CodeEntry(
        "no chain of nodes",
        "No nodes of one version of ROS, put one behind the other, turn the one type of messages into the other.",
        "Ask for a type that is reached, for longer chains (--length), or build sources that have the missing node.",
    ),
    "KG707": CodeEntry(
        "nothing to go through",
        "A chain was to go through something that is neither a type, a node, a package nor a word of one in the store.",
        "Check the name; `kg nodes` lists the nodes, `kg topics` the topics with their types.",
    ),
}
