"""The content of a picture of a system: nodes, the channels between them, and dangling ends.

A channel is a topic, service or action by its full name. `system_graph` builds the graph of a `kg.facts.System`; other
modules write it as SVG, DOT, Mermaid, JSON and text. The order is fixed, so one system always gives the same bytes.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Final

from kg.facts import InstanceInterface, NodeInstance, StartKind, System
from kg.holes import is_known
from kg.names import FRAMEWORK
from kg.render.conditions import condition
from kg.render.text import count

_PLAIN: Final = frozenset({StartKind.NODE, StartKind.LIFECYCLE_NODE, StartKind.TEST})


class State:
    """What became of a thing between two systems; empty where only one is drawn, or nothing changed."""

    SAME: Final = ""
    NEW: Final = "new"
    GONE: Final = "gone"
    CHANGED: Final = "changed"


SIGNS: Final = {State.SAME: "", State.NEW: "+ ", State.GONE: "- ", State.CHANGED: "~ "}
"""What is in front of the name of a thing, by what became of it."""


@dataclass(frozen=True, slots=True)
class Member:
    """A box: an instance, or a namespace with `count` of them.

    `about` describes the type, `place` is the launch line. `host` is the key of the member whose process it shares.
    `reason` is why its interface is unknown.
    """

    key: str
    name: str
    kind: str
    about: str = ""
    host: str | None = None
    reason: str | None = None
    condition: str | None = None
    place: str = ""
    count: int = 1
    state: str = State.SAME


@dataclass(frozen=True, slots=True)
class Channel:
    """A topic, service or action; `name` has holes for unknown parts, or is the code if all of it is unknown.

    It is `open` if its name is partly unknown: then its other ends are unknown too.
    """

    key: str
    kind: str
    name: str
    types: tuple[str, ...] = ()
    open: bool = False
    state: str = State.SAME


@dataclass(frozen=True, slots=True)
class Link:
    """A member at a channel: `outward` where it publishes or calls, else it subscribes or offers.

    `condition` is what decides whether it does, if that is unknown: `if use_imu`.
    """

    member: str
    channel: str
    outward: bool
    state: str = State.SAME
    condition: str = ""


@dataclass(frozen=True, slots=True)
class SystemGraph:
    """A system to draw, in a fixed order; `hidden` describes what is left out."""

    title: str
    members: tuple[Member, ...]
    channels: tuple[Channel, ...]
    links: tuple[Link, ...]
    hidden: tuple[str, ...] = ()

    def states(self) -> frozenset[str]:
        """Return what became of anything in it; empty where one system alone is drawn, or nothing changed."""
        states = {member.state for member in self.members} | {channel.state for channel in self.channels}
        return frozenset((states | {link.state for link in self.links}) - {State.SAME})

    def ends(self) -> dict[str, tuple[tuple[str, ...], tuple[str, ...]]]:
        """Return for each channel the members that publish or call, and those that subscribe or offer."""
        ends: dict[str, tuple[list[str], list[str]]] = {channel.key: ([], []) for channel in self.channels}
        for link in self.links:
            ends[link.channel][0 if link.outward else 1].append(link.member)
        return {key: (tuple(sources), tuple(targets)) for key, (sources, targets) in ends.items()}


@dataclass(frozen=True, slots=True)
class Bundle:
    """Channels of one kind between the same members, drawn as one; `dangling` where one of the sides is empty."""

    key: str
    kind: str
    channels: tuple[Channel, ...]
    sources: tuple[str, ...]
    targets: tuple[str, ...]

    @property
    def dangling(self) -> bool:
        """Return whether nothing is exchanged: one side is empty, or both are the same member."""
        return not (self.sources and self.targets) or (len({*self.sources, *self.targets}) == 1)


def system_graph(system: System, *, every: bool = False, title: str | None = None) -> SystemGraph:
    """Return the graph of a system; without `every` what frameworks make by themselves is left out, and counted."""
    keys = instance_keys(system.instances)
    # Of instances with the same name, a host is the first: reversed, so that it is written last.
    named = {instance.name: key for key, instance in reversed(list(keys.items()))}
    channels: dict[str, Channel] = {}
    links: dict[tuple[str, str, bool], Link] = {}
    left_out = 0
    for key, instance in keys.items():
        for end in instance.interfaces:
            if not every and of_framework(end):
                left_out += 1
                continue
            channel = channel_of(key, end)
            if channel.key in channels:
                types = {*channels[channel.key].types, *channel.types}
                channel = replace(channel, types=tuple(sorted(types)))
            channels[channel.key] = channel
            link = Link(key, channel.key, end.declared.role.outward, condition=condition(end.switches))
            place = link.member, link.channel, link.outward
            # With two ends under different conditions, such as those of two types, it has one in any case or perhaps.
            links[place] = link if links.get(place, link) == link else replace(link, condition="")
    hidden = (f"{count(left_out, 'end')} that frameworks make",) if left_out else ()
    foreign = {instance.host for instance in keys.values() if instance.host} - set(named)
    hosts = (Member(host, host, "host", reason="this configuration does not start it") for host in sorted(foreign))
    return SystemGraph(
        title or f"{system.configuration.package}/{system.configuration.path.rpartition('/')[2]}",
        (*(_member(key, instance, named) for key, instance in keys.items()), *hosts),
        tuple(channels[key] for key in sorted(channels)),
        tuple(links[key] for key in sorted(links)),
        hidden,
    )


def bundles(graph: SystemGraph) -> tuple[Bundle, ...]:
    """Return the channels of a graph, those of one kind, state and with the same ends together."""
    ends = graph.ends()
    links = {(link.member, link.channel, link.outward): link.state for link in graph.links}
    groups: defaultdict[tuple[object, ...], list[Channel]] = defaultdict(list)
    for channel in graph.channels:
        sources, targets = ends[channel.key]
        states = tuple(
            links[one, channel.key, outward] for outward in (True, False) for one in ends[channel.key][not outward]
        )
        groups[channel.kind, sources, targets, channel.state, states, channel.open].append(channel)
    return tuple(Bundle(every[0].key, every[0].kind, tuple(every), *ends[every[0].key]) for every in groups.values())


def instance_keys(instances: Iterable[NodeInstance]) -> Mapping[str, NodeInstance]:
    """Return the instances by their names; duplicates have a number as suffix."""
    by_key: dict[str, NodeInstance] = {}
    seen: Counter[str] = Counter()
    for instance in sorted(instances, key=lambda one: (one.name, str(one.started.location))):
        seen[instance.name] += 1
        by_key[instance.name if seen[instance.name] == 1 else f"{instance.name}#{seen[instance.name]}"] = instance
    return by_key


def of_framework(end: InstanceInterface) -> bool:
    """Tell whether frameworks make an end by themselves, or nearly every node has one of its name."""
    name = end.resolved or ""
    return end.declared.implicit or name in FRAMEWORK or name.endswith(("/bond", "/parameter_updates"))


def channel_of(member: str, end: InstanceInterface) -> Channel:
    """Return the channel of an end of the member with this key."""
    kind = end.declared.role.channel
    types = (end.declared.type,) if end.declared.type else ()
    if not is_known(end.resolved):
        name = end.resolved or end.declared.written or "?"
        return Channel(f"{kind} {name} {member}", kind, name, types, open=True)
    return Channel(f"{kind} {end.resolved}", kind, end.resolved, types)


def _member(key: str, instance: NodeInstance, named: Mapping[str, str]) -> Member:
    started = instance.started
    host = None if instance.host is None else named.get(instance.host, instance.host)
    return Member(
        key=key,
        name=key,
        kind="node" if started.kind in _PLAIN else str(started.kind),
        about=_about(instance),
        host=None if host == key else host,
        reason=instance.reason,
        condition=started.condition,
        place=str(started.location),
    )


def _about(instance: NodeInstance) -> str:
    """Return the class of a nodelet or component, else package and executable."""
    started, kind = instance.started, instance.type
    if started.plugin:
        return started.plugin
    package, executable = started.package or (kind and kind.package), started.executable or (kind and kind.node)
    return f"{package or '?'}/{executable or '?'}" if package or executable else ""
