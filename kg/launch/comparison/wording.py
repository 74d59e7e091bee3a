"""Words for changes: one sentence each, a line that counts them, and the sign before them."""

from __future__ import annotations

from collections import Counter
from typing import Final

from kg.launch.comparison.changes import Change, Difference, Kind, Level
from kg.render.text import count

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
