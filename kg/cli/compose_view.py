"""Chains of nodes as lines for people: inputs and outputs of each node, with their lines, and further inputs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.render.text import printable
from kg.search.compose.network import grouped

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.search.compose.network import Port
    from kg.search.compose.results import Composed, Node

_MOST: Final = 4  # maximum number of copies and required types that are listed


def chain_lines(chain: Composed, rank: int) -> Iterator[str]:
    """Yield the lines of a chain."""
    yield f"{rank}. {' -> '.join(chain.types)}"
    for node in chain.nodes:
        yield from (f"   {printable(line)}" for line in _node_lines(chain, node))
    yield f"   {printable('; '.join(chain.reasons))}"


def _node_lines(chain: Composed, node: Node) -> Iterator[str]:
    part, start = node.part, node.start
    yield f"{part.full_name}  {part.kind}, {part.repository}"
    for verb, port in (("takes", start.taken), ("gives", start.given)):
        yield f"  {verb} {_name(port)} {port.type}  {chain.details.place(port, part)}"
    needed = [f"{kind} ({', '.join(names[:_MOST])})" if names else kind for kind, names in grouped(node.needs)]
    if needed:
        yield f"  also needs {_some(needed)}"
    if node.fed:
        yield f"  also gets {_some([kind for kind, _ in grouped(node.fed)])} from before"
    if node.remarks:
        yield f"  {'; '.join(node.remarks)}"
    if node.others:
        yield f"  also as {_some([f'{one.repository}:{one.full_name}' for one in node.others])}"


def _name(port: Port) -> str:
    return f"`{port.name}`" if port.name is not None else f"what `{port.parameter}` names"


def _some(texts: list[str]) -> str:
    more = f" and {len(texts) - _MOST} more" if len(texts) > _MOST else ""
    return ", ".join(texts[:_MOST]) + more
