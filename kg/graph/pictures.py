"""The picture of a node in the graph."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.graph.records import how_to_start
from kg.render.node_picture import Port, draw
from kg.render.text import NAME_UNKNOWN, TYPE_UNKNOWN, count

if TYPE_CHECKING:
    from kg.graph.reading.nodes import NodeRecord


def node_picture(record: NodeRecord, *, implicit: bool = False) -> str:
    """Return the SVG of a node; `implicit` adds what frameworks make by themselves."""
    node = record.node
    ports = {
        Port(str(one.role), one.name or NAME_UNKNOWN, one.type or TYPE_UNKNOWN, one.implicit)
        for one in node.interfaces
        if implicit or not one.implicit
    }
    left_out = 0 if implicit else sum(one.implicit for one in node.interfaces)
    lines = [f"{record.package} - {node.kind}, ROS {node.ros}", how_to_start(record)]
    more = f"{count(left_out, 'implicit interface')} not shown" if left_out else ""
    return draw(node.name, [line for line in lines if line], ports, more=more)
