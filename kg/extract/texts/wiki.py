"""Markup of the ROS wiki: the blocks `#!clearsilver CS/NodeAPI` that document a node, and pages of MoinMoin.

A block is data of ClearSilver (clearsilver.net/docs/man_hdf.hdf): `key = value`, `key { ... }`, `key << END` to a line
`END`; keys have parts parted by dots. The keys are those of wiki.ros.org/WikiMacros: `node.0 { name, desc, pub {
0.name, 0.type, 0.desc } }`; a block of one node leaves `node.0` out.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

__all__ = ["WikiEntry", "WikiNode", "is_wiki", "moin_markdown", "wiki_nodes"]

_BEGIN: Final = re.compile(r"#!\s*clearsilver\s+CS/(?:Node|Nodelet)?API", re.IGNORECASE)
_END: Final = re.compile(r"^\s*\}\}\}|^\s*```")
_OPEN: Final = re.compile(r"^([\w.\-]+)\s*\{\s*(.*)$")
_ASSIGN: Final = re.compile(r"^([\w.\-]+)\s*:?=\s*(.*)$")
_LONG: Final = re.compile(r"^([\w.\-]+)\s*<<\s*(\w+)\s*$")
_DEEPEST: Final = 12
"""Blocks within blocks; `node.0 { param { group.0 { 1 {` are four."""
_MOST_LINES: Final = 20_000
_NODE: Final = re.compile(r"^(node(?:let)?s?\.\d+)\.(.+)$")
_ENTRY: Final = re.compile(r"^(\w+)((?:\.group\.\d+)?\.\d+)\.(\w+)$")
_KINDS: Final = {
    "pub": "publishes",
    "sub": "subscribes",
    "srv": "services",
    "srv_called": "clients",
    "goal": "action_servers",
    "act": "action_servers",
    "act_called": "action_clients",
    "param": "parameters",
    "req_tf": "required_transforms",
    "prov_tf": "provided_transforms",
}


@dataclass(frozen=True, slots=True)
class WikiEntry:
    """What a wiki page documents of a node: a topic, service, action, parameter or transform.

    `kind` is a role as in `kg nodes --json` (`publishes`, `services`, ...), `parameters`, or `required_transforms`
    and `provided_transforms`, whose `name` is `from -> to`. `type` is as written, None where it is missing.
    """

    kind: str
    name: str
    type: str | None
    description: str | None
    line: int
    default: str | None = None


@dataclass(frozen=True, slots=True)
class WikiNode:
    """A node as a wiki page documents it; `line` is where its name stands, or its block begins."""

    name: str | None
    description: str | None
    line: int
    entries: tuple[WikiEntry, ...] = ()


@dataclass(frozen=True, slots=True)
class _Value:
    """A value and the line that it begins at."""

    text: str
    line: int


def is_wiki(text: str) -> bool:
    """Tell whether a text is a page of the ROS wiki."""
    return _BEGIN.search(text) is not None or "<<PackageHeader(" in text or "<<StackHeader(" in text


def wiki_nodes(text: str) -> tuple[WikiNode, ...]:
    """Return the nodes that the blocks of a page document, in their order; malformed lines are passed over."""
    lines = text.split("\n", _MOST_LINES)[:_MOST_LINES]
    found: list[WikiNode] = []
    for number, line in enumerate(lines):
        if _BEGIN.search(line):
            found.extend(_nodes(_values(lines, number + 1), number + 1))
    return tuple(found)


def _values(lines: list[str], start: int) -> dict[str, _Value]:
    """Return the values of a block by their whole keys."""
    found: dict[str, _Value] = {}
    scope: list[str] = []
    at = start
    while at < len(lines) and not _END.match(lines[at]) and not _BEGIN.search(lines[at]):
        line, number = lines[at].strip(), at + 1
        at += 1
        long = _LONG.match(line)
        if long:
            end = next((n for n in range(at, len(lines)) if lines[n].strip() == long[2]), len(lines))
            found.setdefault(_key(scope, long[1]), _Value(" ".join(lines[at:end]).strip(), number))
            at = end + 1
        else:
            _take(line, number, scope, found)
    return found


def _take(line: str, number: int, scope: list[str], found: dict[str, _Value]) -> None:
    """Take a line: several blocks may open or close on it, and a value runs to its end."""
    while line and not line.startswith("#"):
        opened, assigned = _OPEN.match(line), _ASSIGN.match(line)
        if opened:
            if len(scope) < _DEEPEST:
                scope.append(opened[1])
            line = opened[2]
        elif line.startswith("}"):
            if scope:
                scope.pop()
            line = line[1:].lstrip()
        else:
            if assigned and assigned[2]:
                closes = assigned[2].endswith("}") and "{" not in assigned[2] and bool(scope)
                value = assigned[2].removesuffix("}") if closes else assigned[2]
                found.setdefault(_key(scope, assigned[1]), _Value(value.strip(), number))
                if closes:
                    scope.pop()
            return


def _key(scope: list[str], key: str) -> str:
    return ".".join([*scope, key])


def _nodes(values: dict[str, _Value], line: int) -> Iterator[WikiNode]:
    """Yield the nodes of a block; values outside of `node.0` are of one node."""
    grouped: dict[str, dict[str, _Value]] = {}
    for key, value in values.items():
        inside = _NODE.match(key)
        grouped.setdefault(inside[1] if inside else "", {})[inside[2] if inside else key] = value
    for own in grouped.values():
        name, said = own.get("name"), own.get("desc")
        entries = tuple(_entries(own))
        if name or said or entries:
            first = name or said or _Value("", line)
            yield WikiNode(name.text if name else None, said.text if said else None, first.line, entries)


def _entries(values: dict[str, _Value]) -> Iterator[WikiEntry]:
    grouped: dict[tuple[str, str], dict[str, _Value]] = {}
    for key, value in values.items():
        found = _ENTRY.match(key)
        if found and found[1] in _KINDS:
            grouped.setdefault((found[1], found[2]), {})[found[3]] = value
    for (kind, _), fields in grouped.items():
        name = fields.get("name") or _transform(fields)
        if name:
            kept = {key: fields[key].text for key in ("type", "desc", "default") if key in fields}
            yield WikiEntry(_KINDS[kind], name.text, kept.get("type"), kept.get("desc"), name.line, kept.get("default"))


def _transform(fields: dict[str, _Value]) -> _Value | None:
    source, target = fields.get("from"), fields.get("to")
    return _Value(f"{source.text} -> {target.text}", source.line) if source and target else None


_HEADING: Final = re.compile(r"^\s*(={1,5})\s+(.{1,300}?)\s+\1\s*$")
_INLINE: Final = re.compile(r"\{\{\{([^{}]{1,200})\}\}\}")
_MACRO: Final = re.compile(r"<<(\w+)\(([^()<>]{0,300})\)>>")
_ATTACHED: Final = re.compile(r"\{\{[^{}]{1,300}\}\}")
_LINK: Final = re.compile(r"\[\[([^\[\]|]{1,300})(?:\|([^\[\]|]{1,300}))?[^\[\]]{0,100}\]\]")
_LITERAL_MACROS: Final = frozenset({"MsgLink", "SrvLink", "NodeLink", "ActionLink"})


def moin_markdown(text: str) -> str:
    """Return a page of MoinMoin (moinmo.in/HelpOnMoinWikiSyntax) as Markdown with the same lines."""
    return "\n".join(_moin_lines(text.split("\n")))


def _moin_lines(lines: Iterable[str]) -> Iterator[str]:
    fenced = False
    for line in lines:
        if fenced:
            fenced = "}}}" not in line
            yield "" if fenced else "```"
        elif line.lstrip().startswith("{{{") and "}}}" not in line:
            fenced = True
            yield "```"
        else:
            heading = _HEADING.match(line)
            yield f"{'#' * len(heading[1])} {heading[2]}" if heading else _inline(line)


def _inline(line: str) -> str:
    line = _INLINE.sub(r"`\1`", line)
    line = _LINK.sub(lambda match: match[2] or match[1], line)
    line = _MACRO.sub(lambda match: match[2] if match[1] in _LITERAL_MACROS else "", line)
    return _ATTACHED.sub("", line).replace("'''", "**").replace("''", "*").replace("||", "|")
