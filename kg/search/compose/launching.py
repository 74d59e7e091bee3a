"""The launch file of a chain: its comments on each node, and its language."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.render.text import printable
from kg.search.compose.results import Composed, Node, grouped

if TYPE_CHECKING:
    from kg.search.compose.details import Unset

_MOST: Final = 8  # how many inputs of a node are named one by one


def launch_text(chain: Composed) -> str:
    """Return the launch file of a chain: XML of roslaunch for ROS 1, Python for ROS 2."""
    if chain.wiring.ros == 1:
        from kg.search.compose.roslaunch import written  # noqa: PLC0415 - circular import
    else:
        from kg.search.compose.ros2launch import written  # noqa: PLC0415 - the same
    return written(chain)


def heading(chain: Composed) -> list[str]:
    """Return the heading of a launch file, in lines."""
    nodes = (f"{place}. {node.part.full_name}, {node.part.repository}" for place, node in enumerate(chain.nodes, 1))
    return [printable(line) for line in (" -> ".join(chain.types), *nodes, "Written by `kg compose`.")]


def purpose(chain: Composed, place: int) -> str:
    """Return the purpose of the argument for the first or last topic of a chain."""
    link = chain.wiring.links[place]
    return printable(f"{link.type} that the chain {'takes' if place == 0 else 'gives'}")


def remarks(chain: Composed, place: int) -> list[str]:
    """Return remarks on a node of a chain, in lines: the places of its ends, and its other needs."""
    node, links = chain.nodes[place], chain.wiring.links
    start, part = node.start, node.part
    found = [
        f"{part.full_name}: {part.path}:{part.line}",
        f"takes {links[place].type} as {_own(start.taken.name)}: {chain.details.place(start.taken, part)}",
        f"gives {links[place + 1].type} as {_own(start.given.name)}: {chain.details.place(start.given, part)}",
    ]
    if part.iri in chain.details.lifecycle:
        found.append("It has a life cycle: configure and activate it before it does anything.")
    for verb, ports in (("also needs", node.needs), ("is also given", node.fed)):
        known = grouped(ports)
        found += [f"{verb} {kind}{_named(names)}" for kind, names in known[:_MOST]]
        if len(known) > _MOST:
            found.append(f"{verb} {len(known) - _MOST} more types")
    found += [f"note: {one}" for one in node.remarks]
    return [printable(line) for line in found]


def unset(chain: Composed, node: Node) -> tuple[Unset, ...]:
    """Return the parameters without a known default that the launch file does not set either."""
    given = {*(name for name, _ in node.start.topics), *node.start.switches}
    found = chain.details.unset.get(node.part.iri, ())
    return tuple(one for one in found if one.name not in given)


def _own(name: str | None) -> str:
    return f"`{name}`" if name is not None else "a name that a parameter gives"


def _named(names: list[str]) -> str:
    more = f" and {len(names) - _MOST} more" if len(names) > _MOST else ""
    return f" as {', '.join(names[:_MOST])}{more}" if names else ""
