"""Parts of a system's graph: around a member, namespaces as one box each; and two systems laid over each other."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import replace
from operator import attrgetter
from typing import Any, TypeVar

from kg.render.system_graph import Member, State, SystemGraph
from kg.render.text import count

_Thing = TypeVar("_Thing")


def around(graph: SystemGraph, focus: Collection[str], depth: int = 1) -> SystemGraph:
    """Return the members within `depth` channels of the members `focus`, with all channels of those in focus."""
    ends = graph.ends()
    at: defaultdict[str, set[str]] = defaultdict(set)
    for link in graph.links:
        at[link.member].add(link.channel)
    near, edge = set(focus), set(focus)
    channels = {channel for member in focus for channel in at[member]}
    for _ in range(depth):
        passed = {channel for member in edge for channel in at[member]}
        channels |= passed
        edge = {member for channel in passed for side in ends[channel] for member in side} - near
        near |= edge
    hosts = {member.host for member in graph.members if member.key in near and member.host}
    members = tuple(member for member in graph.members if member.key in near | hosts)
    links = tuple(link for link in graph.links if link.member in near and link.channel in channels)
    joined = {link.channel for link in links}
    left_out = len(graph.members) - len(members)
    return SystemGraph(
        graph.title,
        members,
        tuple(channel for channel in graph.channels if channel.key in joined),
        links,
        (*graph.hidden, f"{count(left_out, 'node')} farther away") if left_out else graph.hidden,
    )


def collapsed(graph: SystemGraph, expand: Collection[str] = (), most: int = 60) -> SystemGraph:
    """Return the graph with namespaces as one box each if it has more than `most` boxes.

    As few levels of namespaces as necessary are collapsed; those in `expand`, and their content, never.
    """
    deepest = max((member.name.count("/") - 1 for member in graph.members), default=0)
    shown = graph
    for level in range(deepest, 0, -1):
        if len(shown.members) <= most:
            break
        shown = _at_level(shown, level, [name.rstrip("/") + "/" for name in expand])
    inside = len(graph.channels) - len(shown.channels)
    return (
        replace(shown, hidden=(*shown.hidden, f"{count(inside, 'channel')} inside of namespaces")) if inside else shown
    )


def _at_level(graph: SystemGraph, level: int, expand: Collection[str]) -> SystemGraph:
    """Return the graph with one box for the members of each namespace of `level` names."""
    groups = {member.key: _group(member, level) for member in graph.members}
    sizes = Counter(group for group in groups.values() if group)
    into: dict[str, str] = {}
    for key, group in groups.items():
        inside = f"{group}/"
        is_expanded = any(inside.startswith(one) or one.startswith(inside) for one in expand)
        into[key] = f"{group}/*" if group and sizes[group] > 1 and not is_expanded else key
    members: dict[str, Member] = {}
    for member in graph.members:
        key = into[member.key]
        if key == member.key:
            host = into.get(member.host or "", member.host)
            members[key] = replace(member, host=None if host == key else host)
            continue
        grown = members.get(key)
        size = (grown.count if grown else 0) + member.count
        state = member.state if grown is None or grown.state == member.state else State.CHANGED
        members[key] = Member(key, key, "namespace", count(size, "node"), count=size, state=state)
    ends: defaultdict[str, set[str]] = defaultdict(set)
    for link in graph.links:
        ends[link.channel].add(into[link.member])
    # The channels whose ends are all in one group.
    inner = {channel for channel, groups in ends.items() if len(groups) == 1 and next(iter(groups)).endswith("/*")}
    links = {
        (into[link.member], link.channel, link.outward): replace(link, member=into[link.member])
        for link in graph.links
        if link.channel not in inner
    }
    return SystemGraph(
        graph.title,
        tuple(members[key] for key in sorted(members)),
        tuple(channel for channel in graph.channels if channel.key not in inner),
        tuple(links[key] for key in sorted(links)),
        graph.hidden,
    )


def _group(member: Member, level: int) -> str | None:
    """Return the namespace of at most `level` names that a member is in, None for the root."""
    parts = member.name.split("/")[1:-1]
    return "/" + "/".join(parts[:level]) if len(parts) >= level else None


def near_changes(graph: SystemGraph) -> SystemGraph:
    """Return what changed with what it is joined to; the whole graph where nothing did."""
    changed = {channel.key for channel in graph.channels if channel.state}
    focus = {member.key for member in graph.members if member.state}
    focus |= {link.member for link in graph.links if link.state or link.channel in changed}
    return around(graph, focus) if focus else graph


def overlaid(before: SystemGraph, after: SystemGraph, changed: Collection[str] = ()) -> SystemGraph:
    """Return both graphs as one, each thing with what became of it; members and channels `changed` are named by key."""
    members = _states(before.members, after.members, attrgetter("key"), changed)
    channels = _states(before.channels, after.channels, attrgetter("key"), changed)
    links = _states(before.links, after.links, attrgetter("member", "channel", "outward"))
    return SystemGraph(
        after.title,
        tuple(replace(one, state=state) for one, state in members),
        tuple(replace(one, state=state) for one, state in channels),
        tuple(replace(one, state=state) for one, state in links),
        after.hidden,
    )


def _states(
    before: Iterable[_Thing], after: Iterable[_Thing], key: Callable[[_Thing], Any], changed: Collection[str] = ()
) -> Iterator[tuple[_Thing, str]]:
    """Yield the things of both graphs in the order of their keys, each with what became of it."""
    old, new = {key(one): one for one in before}, {key(one): one for one in after}
    for name in sorted({*old, *new}, key=str):
        if name not in new:
            yield old[name], State.GONE
        else:
            yield new[name], State.NEW if name not in old else State.CHANGED if name in changed else State.SAME
