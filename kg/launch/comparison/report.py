"""A difference as lines for people, as Markdown for a pull request, as plain values for JSON, and in drawings.

Drawings mark what changed by the keys that `kg.render.system_graph` gives to nodes and channels.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any, Final, TypeAlias

from kg.facts import Role
from kg.launch.comparison.changes import Change, Difference, Kind, Level, Side
from kg.render.text import count, printable

_ROLES: Final = {
    "publishes": "publishes",
    "subscribes": "subscribes",
    "services": "offers service",
    "clients": "calls service",
    "action_servers": "offers action",
    "action_clients": "calls action",
}
_NOUNS: Final = {
    Level.NODE: "node type",
    Level.INTERFACE: "interface",
    Level.PARAMETER: "parameter",
    Level.SYSTEM: "launch file",
    Level.ARGUMENT: "argument",
    Level.NAMESPACE: "namespace",
    Level.INSTANCE: "node",
    Level.END: "name in launch files",
    Level.SETTING: "parameter set",
    Level.REMAP: "remapping",
    Level.CONNECTION: "connection",
    Level.FINDING: "finding",
}
_TAKING_ALONG: Final = frozenset({Level.NAMESPACE, Level.INSTANCE})
"""Levels of things whose other names lead to more of them."""
_PLURALS: Final = {Level.END: "names in launch files", Level.SETTING: "parameters set"}
_WORDS: Final = {Kind.NEW: "new", Kind.GONE: "gone"}
_ASPECTS: Final = {
    Kind.TYPE: "type",
    Kind.QOS: "quality of service",
    Kind.DEFAULT: "default",
    Kind.VALUE: "value",
    Kind.CONDITION: "condition",
    Kind.HOST: "host",
    Kind.KNOWN: "not known",
}


def sign(change: Change) -> str:
    """Return `+` for added, `-` for removed, `~` for changed."""
    return {Kind.NEW: "+", Kind.GONE: "-"}.get(change.kind, "~")


def change_words(change: Change) -> str:
    """Return the change in words, without its owner: `publishes /scan: type a/A -> b/B`."""
    side = change.after or change.before
    if side is None:
        return ""
    if change.level is Level.CONNECTION:
        return f"{change.owner} to {side.value} by {change.role} {side.name}"
    if change.level is Level.FINDING:
        return f"{change.owner} {side.value}"
    what = f"{_verb(change)} {side.name}"
    if change.before is None or change.after is None:
        return f"{what} ({side.value})" if side.value else what
    if change.kind is Kind.RENAMED:
        along = f" and {side.value} with it" if side.value and change.level in _TAKING_ALONG else ""
        return f"{_verb(change)} {change.before.name} -> {change.after.name}{along}"
    return f"{what}: {_ASPECTS[change.kind]} {change.before.value or 'none'} -> {change.after.value or 'none'}"


def summary(difference: Difference) -> str:
    """Return how much changed, in one line."""
    numbers = Counter((change.level, _WORDS.get(change.kind, "changed")) for change in difference.changes)
    parts = []
    for level in Level:
        counts = [f"{numbers[level, word]:,} {word}" for word in ("new", "gone", "changed") if numbers[level, word]]
        if counts:
            whole = sum(numbers[level, word] for word in ("new", "gone", "changed"))
            noun = count(whole, _NOUNS[level], _PLURALS.get(level)).partition(" ")[2]
            parts.append(f"{noun} {', '.join(counts)}")
    return "; ".join(parts) or "no differences"


def _verb(change: Change) -> str:
    if change.level in {Level.INTERFACE, Level.END}:
        return _ROLES[change.role]
    return {Level.PARAMETER: "parameter", Level.SETTING: "sets", Level.INSTANCE: "starts"}.get(
        change.level, _NOUNS[change.level]
    )


_BELOW_NODES: Final = frozenset({Level.END, Level.SETTING, Level.REMAP})

Link: TypeAlias = "Callable[[Side, bool], str | None]"
"""Gives the address of a side's line; the flag tells whether it is the side after."""
_OF_NODES: Final = frozenset({Level.INSTANCE, Level.END, Level.SETTING, Level.REMAP})
_ADDED_OR_REMOVED: Final = frozenset({Kind.NEW, Kind.GONE})


def difference_lines(difference: Difference) -> list[str]:
    """Return lines for people: the changes of each node type, then those of each launch file, with their lines."""
    lines: list[str] = []
    for heading, changes in _groups(difference):
        lines += [heading, *(f"  {line}" for line in _aligned(changes)), ""]
    return [*lines, summary(difference)]


def difference_markdown(difference: Difference, title: str, link: Link | None = None, *, most: int = 200) -> str:
    """Return Markdown: the line that counts, then a table for code and for each launch file.

    `link` returns addresses of lines; a table has at most `most` rows, and the number of omitted ones.
    """
    parts = [f"### {code(title)}", "", f"**{summary(difference)}**", ""]
    for heading, changes in _groups(difference):
        parts += [f"#### {code(heading)}", "", "|   | what | where |", "|---|---|---|"]
        parts += [f"| {sign(one)} | {code(change_words(one))} | {_places(one, link)} |" for one in changes[:most]]
        parts += ["", *([f"{count(len(changes) - most, 'more row')} left out.", ""] if len(changes) > most else [])]
    return "\n".join(parts)


def difference_objects(difference: Difference) -> Iterator[dict[str, Any]]:
    """Yield each change as plain values, ready for JSON; the fields of docs/formats.md."""
    for change in difference.changes:
        yield {
            "level": str(change.level),
            "change": str(change.kind),
            "system": change.system or None,
            "owner": change.owner,
            "owner_before": change.owner_before or None,
            "role": change.role or None,
            "before": _side_object(change.before),
            "after": _side_object(change.after),
        }


def _side_object(side: Side | None) -> dict[str, Any] | None:
    if side is None:
        return None
    return {
        "name": side.name,
        "value": side.value or None,
        "file": side.location.path if side.location else None,
        "line": side.location.line if side.location else None,
        "repository": side.repository or None,
    }


def _groups(difference: Difference) -> Iterator[tuple[str, list[Change]]]:
    """Yield the changes below their heading: of a node type, or of an instance in its launch file."""
    groups: dict[str, list[Change]] = {}
    for change in difference.changes:
        groups.setdefault(_heading(change), []).append(change)
    yield from groups.items()


def _heading(change: Change) -> str:
    if not change.system:
        return "node types" if change.level is Level.NODE else change.owner
    if change.level not in _BELOW_NODES or change.owner == change.system:
        return change.system
    return f"{change.owner} in {change.system}"


def _aligned(changes: list[Change]) -> Iterator[str]:
    words = [printable(change_words(change)) for change in changes]
    room = max(map(len, words), default=0)
    for change, text in zip(changes, words, strict=True):
        side = change.after or change.before
        place = str(side.location) if side and side.location else ""
        yield f"{sign(change)} {text.ljust(room) if place else text}  {place}".rstrip()


def _places(change: Change, link: Link | None) -> str:
    before, after = change.before, change.after
    if before and after and before.location == after.location:
        before = None
    links = []
    for side, is_after in ((before, False), (after, True)):
        if side is None or side.location is None:
            continue
        address = link(side, is_after) if link else None
        text = code(str(side.location))
        links.append(f"[{text}]({address})" if address else text)
    return " → ".join(links)


def code(text: str) -> str:
    """Return text as code in a cell, escaped from Markdown, HTML and mentions of users."""
    safe = printable(text).replace("`", "'").replace("|", "\\|")
    return f"`{safe}`"


def changed_systems(difference: Difference) -> tuple[str, ...]:
    """Return the names of the launch files whose wiring differs, sorted."""
    return tuple(sorted({one.system for one in difference.changes if one.system and one.level is not Level.FINDING}))


def changed_keys(difference: Difference, system: str) -> frozenset[str]:
    """Return the nodes with another type, host, condition, name or setting, and the channels with other ends."""
    keys = set()
    for change in difference.changes:
        if change.system != system or change.level not in _OF_NODES:
            continue
        if change.level is Level.INSTANCE and change.kind in _ADDED_OR_REMOVED:
            continue
        keys.add(change.owner)
        if change.kind in {Kind.TYPE, Kind.QOS} and change.role:
            keys.add(f"{Role(change.role).channel} {change.name}")
    return frozenset(keys)
