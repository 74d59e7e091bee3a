"""Names for the nodes and topics of a chain: valid, unique, and without unintended connections.

A topic keeps its publisher's name, unless another end of the chain has that name (other than later nodes that subscribe
to the same type). In that case the topic is named below its publisher.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from itertools import count
from typing import TYPE_CHECKING, Final

from kg.facts import HOLDS, Switch
from kg.holes import is_partial
from kg.names import resolve

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from kg.search.compose.network import Part, Port

INPUT: Final = "input"
"""Launch file argument that names the first topic of a chain."""
OUTPUT: Final = "output"
"""Argument that names its last topic."""
_HOSTS: Final = {1: "nodelet_manager", 2: "component_container"}


@dataclass(frozen=True, slots=True)
class Link:
    """A topic: its absolute name, and the `argument` of the launch file that may change it."""

    topic: str
    type: str
    argument: str | None = None


@dataclass(slots=True)
class Start:
    """A node as started by the launch file; `remaps` contains pairs of its own name for a topic and the link.

    `topics` are parameters that name topics, `switches` parameters that enable its ends.
    """

    part: Part
    name: str
    taken: Port
    given: Port
    remaps: list[tuple[str, Link]] = field(default_factory=list)
    topics: list[tuple[str, Link]] = field(default_factory=list)
    switches: dict[str, bool | int | str] = field(default_factory=dict)

    @property
    def loaded(self) -> bool:
        """Whether a manager or container loads it as a class."""
        return self.part.executable is None

    def own(self, port: Port) -> str | None:
        """Return the absolute name of an end without remapping."""
        return resolve(port.name, self.name) if port.name is not None else None


@dataclass(frozen=True, slots=True)
class Wiring:
    """Content of a launch file.

    `links` has one topic more than there are nodes; the first and the last connect to the outside. `host` is the name
    of the manager or container for loaded classes, None if there are none.
    """

    ros: int
    starts: tuple[Start, ...]
    links: tuple[Link, ...]
    host: str | None

    def published(self, place: int) -> set[tuple[str, str]]:
        """Return the topics that the node at an index publishes, by their final names, with types."""
        start, link = self.starts[place], self.links[place + 1]
        moved = start.own(start.given)
        own = {(start.own(port) or "", port.type) for port in start.part.outputs if start.own(port) != moved}
        return {*own, (link.topic, link.type)}


def wire(ways: Sequence[tuple[Part, Port, Port]]) -> Wiring:
    """Return the wiring of a chain: nodes in order, each with its input and output in the chain."""
    ros = ways[0][0].ros
    host = _HOSTS[ros] if any(part.executable is None for part, _, _ in ways) else None
    taken = {host} if host else set()
    starts = []
    for part, entry, way_out in ways:
        name = _unique(_node_name(part), taken)
        taken.add(name)
        starts.append(Start(part, name, entry, way_out))
    links = _links(starts)
    for place, start in enumerate(starts):
        _connect(start, start.taken, links[place])
        _connect(start, start.given, links[place + 1])
    return Wiring(ros, tuple(starts), tuple(links), host)


def _node_name(part: Part) -> str:
    """Return the default name of a node, made valid."""
    own = (part.node_name or "").rpartition("/")[2]
    plain = own if own and not is_partial(own) else part.name.removesuffix(".py")
    last = plain.rpartition("::")[2].rpartition("/")[2]
    name = re.sub(r"\W", "_", last, flags=re.ASCII).strip("_")
    return name if name[:1].isalpha() else f"node_{name}".rstrip("_")


def _unique(name: str, taken: Iterable[str]) -> str:
    used = set(taken)
    return next(one for number in count(1) if (one := name if number == 1 else f"{name}_{number}") not in used)


def _links(starts: Sequence[Start]) -> list[Link]:
    """Return the topics from the input of the first node to the output of the last.

    A new name never equals the default name of an end of the chain, because a remapping may move that end.
    """
    first = starts[0]
    every = {start.own(port) or "" for start in starts for port in (*start.part.inputs, *start.part.outputs)}
    own = first.own(first.taken)
    free = own is not None and own not in _disturbing(starts, first.taken.type, 0)
    links = [Link(own if own is not None and free else _unique(f"/{INPUT}", every), first.taken.type, INPUT)]
    for place, start in enumerate(starts, 1):
        used = {link.topic for link in links}
        others = used | _disturbing(starts, start.given.type, place) | _moved_by_name(starts[place : place + 1])
        own = start.own(start.given)
        if own is None or own in others:
            last = start.given.name.rpartition("/")[2] if start.given.name is not None else OUTPUT
            own = _unique(f"/{start.name}/{last}", every | used)
        links.append(Link(own, start.given.type, OUTPUT if place == len(starts) else None))
    return links


def _disturbing(starts: Sequence[Start], type_name: str, place: int) -> set[str]:
    """Return the names not allowed for a topic of a type that leads to the node at an index of the chain.

    Later nodes may subscribe to it as well. Earlier nodes must not, as that would be a loop. Ends that are links of the
    chain, or share the name of one, are remapped and do not count.
    """
    names = set()
    for number, start in enumerate(starts):
        moved = {start.own(start.taken), start.own(start.given)}
        inputs = [port for port in start.part.inputs if number < place or port.type != type_name]
        names |= {own for port in (*inputs, *start.part.outputs) if (own := start.own(port)) is not None} - moved
    return names


def _moved_by_name(starts: Sequence[Start]) -> set[str]:
    """Return the names affected by remappings of nodes whose input is named by a parameter.

    That input is remapped afterwards.
    """
    return {start.own(start.given) or "" for start in starts if start.taken.name is None}


def _connect(start: Start, port: Port, link: Link) -> None:
    for switch in port.switches:
        parameter, sign, value, wanted = Switch.parse(switch)
        if sign == HOLDS:
            continue
        if value is None:
            start.switches[parameter] = wanted
        elif wanted and sign == "==":
            start.switches[parameter] = int(value) if value.isdecimal() else value
    if port.name is None:
        start.topics.append((port.parameter or "", link))
    elif link.argument is not None or start.own(port) != link.topic:
        start.remaps.append((port.name, link))
