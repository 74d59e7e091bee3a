"""The codes of composing chains of nodes: KG705 to KG707."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

CODES: Final = {
    "KG705": CodeEntry(
        "type not used by startable nodes",
        "No node that a launch file starts publishes or subscribes to messages of this type.",
        "Check the name, `package/Type` or `Type`. `kg topics` lists topics and their types.",
    ),
    "KG706": CodeEntry(
        "no chain of nodes",
        "No sequence of nodes of one ROS version converts messages of the first type to the second.",
        "Try another type or longer chains (`--length`), or build sources that contain the missing node.",
    ),
    "KG707": CodeEntry(
        "unknown waypoint of a chain",
        "A chain must pass through something that is not in the store as a type, node, package or word.",
        "Check the name. `kg nodes` lists the nodes. `kg topics` lists the topics and their types.",
    ),
}
