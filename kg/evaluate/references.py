"""References about nodes: truth files and documentation that the graph is compared with.

A file of references has one JSON object per line, in one of two shapes. The first is that of `kg nodes --json`
(`publishes`, `subscribes`, ... hold objects with `name` and `type`), with `closed_world`, the roles that are complete.
The second is that of documentation: pairs of name and type, with the roles `called_services`, `actions`,
`actions_called` and `params`. Both have `repo`, `package` and `node`, and optionally `commit`. `kg.evaluate.gathering`
reads pages of documentation.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final

import msgspec

from kg.errors import Place, UsageError

PARAMETERS: Final = "parameters"
ROLES: Final = ("publishes", "subscribes", "services", "clients", "action_servers", "action_clients", PARAMETERS)
_OTHER_KEYS: Final = {
    "called_services": "clients",
    "actions": "action_servers",
    "actions_called": "action_clients",
    "params": PARAMETERS,
    "params_read": PARAMETERS,
    "params_written": PARAMETERS,
}
_HOLE: Final = re.compile(r"<[^>]*>|\{[^}]*\}")
_TYPE_SPLIT: Final = re.compile(r"::|/|\.")
_NAME_SPLIT: Final = re.compile(r"::|/")
_HINT: Final = "docs/evaluation.md shows what a file of references looks like."


@dataclass(frozen=True, slots=True)
class Entry:
    """An interface or parameter in a reference.

    `name` has no leading `~` or `/`, and `*` for unknown parts; None if it is missing. `type` is `package/Type`.
    """

    role: str
    name: str | None
    type: str | None


@dataclass(frozen=True, slots=True)
class Reference:
    """A node as a reference describes it.

    `repository` is `owner/name` in lower case, `names` are the node's short names in lower case, `closed` the complete
    roles; `place` is the origin. A `sole` one describes the only node of its package, if none has its names.
    """

    repository: str
    commit: str | None
    package: str
    names: frozenset[str]
    entries: tuple[Entry, ...]
    place: Place
    closed: frozenset[str] = field(default_factory=frozenset)
    sole: bool = False


@dataclass(frozen=True, slots=True)
class Reading:
    """The result of reading: each node once, and the numbers of skipped records by reason."""

    references: tuple[Reference, ...]
    left_out: Mapping[str, int] = field(default_factory=dict)


class _Named(msgspec.Struct):
    name: str | None = None
    type: str | None = None
    before_remap: str | None = None
    implicit: bool = False


_Said = list[_Named | list[str | float | bool | None]] | None


class _Record(msgspec.Struct, frozen=True):
    """A line of either shape; other keys are ignored."""

    repo: str | None = None
    repository: str | None = None
    commit: str | None = None
    package: str | None = None
    node: str | None = None
    executable: str | None = None
    plugin: str | None = None
    node_name: str | None = None
    node_aliases: list[str] | None = None
    aliases: list[str] | None = None
    scorable: bool | None = None
    closed_world: list[str] | None = None
    publishes: _Said = None
    subscribes: _Said = None
    services: _Said = None
    clients: _Said = None
    action_servers: _Said = None
    action_clients: _Said = None
    parameters: _Said = None
    called_services: _Said = None
    actions: _Said = None
    actions_called: _Said = None
    params: _Said = None
    params_read: _Said = None
    params_written: _Said = None


def text_of(path: Path) -> str:
    """Return the text of a file of references; UsageError KG721 if it is unreadable."""
    try:
        return path.read_text("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or error
        raise UsageError("KG721", f"the references cannot be read: {reason}", place=Place(str(path))) from None


def read(path: Path, *, closed: bool = False) -> Reading:
    """Return the references in a file of JSON lines; with `closed`, each is assumed to be complete.

    Raises UsageError: KG721 the file is unreadable, or a line is invalid.
    """
    left_out: Counter[str] = Counter()
    merged: dict[tuple[str | None, ...], Reference] = {}
    for number, record in _records(text_of(path), path):
        if record.scorable is False:
            left_out["excluded by the file"] += 1
        elif not record.package:
            left_out["no package is named"] += 1
        else:
            reference = _reference(record, Place(str(path), number), closed=closed)
            key = (reference.repository, reference.package, record.executable or record.node, record.plugin)
            merged[key] = _joined(merged[key], reference) if key in merged else reference
    return Reading(tuple(merged.values()), left_out)


def _records(text: str, path: Path) -> Iterator[tuple[int, _Record]]:
    decoder = msgspec.json.Decoder(_Record)
    for number, line in enumerate(text.split("\n"), 1):
        if not line.strip():
            continue
        place = Place(str(path), number)
        try:
            record = decoder.decode(line.encode("utf-8", "replace"))
        except (msgspec.MsgspecError, RecursionError) as error:
            raise UsageError("KG721", f"invalid reference: {error}", place=place, hint=_HINT) from None
        if not (record.repo or record.repository):
            raise UsageError("KG721", "this line names no repository of a node", place=place, hint=_HINT)
        yield number, record


def _reference(record: _Record, place: Place, *, closed: bool) -> Reference:
    names = [record.node, record.executable, record.plugin, record.node_name]
    names += [*(record.node_aliases or ()), *(record.aliases or ())]
    complete = {_OTHER_KEYS.get(key, key) for key in record.closed_world or ()}
    return Reference(
        repository=owner_and_name(record.repo or record.repository or ""),
        commit=record.commit,
        package=record.package or "",
        names=frozenset(short_name(name) for name in names if name),
        entries=tuple(dict.fromkeys(_entries(record))),
        place=place,
        closed=frozenset(ROLES if closed else complete),
    )


def _entries(record: _Record) -> Iterator[Entry]:
    for key in (*ROLES, *_OTHER_KEYS):
        role = _OTHER_KEYS.get(key, key)
        for one in getattr(record, key) or ():
            given = _pair(one) if isinstance(one, list) else one
            if not given.implicit:
                yield entry(role, given.before_remap or given.name, given.type)


def entry(role: str, name: str | None, kind: str | None) -> Entry:
    """Return what a reference names, its name and type in any spelling; parameters have no type."""
    return Entry(role, plain_name(name), None if role == PARAMETERS else plain_type(kind))


def _pair(written: list[Any]) -> _Named:
    name, kind = (*written, None, None)[:2]
    return _Named(name if isinstance(name, str) else None, kind if isinstance(kind, str) else None)


def _joined(one: Reference, other: Reference) -> Reference:
    """Return the union of two records of a node (one for each launch file, or page)."""
    entries: Iterable[Entry] = (*one.entries, *other.entries)
    return replace(
        one, names=one.names | other.names, entries=tuple(dict.fromkeys(entries)), closed=one.closed | other.closed
    )


def plain_name(name: str | None) -> str | None:
    """Return a name without its leading `~`, `~/` or `/`, with `*` for holes; None if nothing is left."""
    if not name or "?" in name:
        return None
    return _HOLE.sub("*", name).lstrip("~").strip("/") or None


def plain_type(name: str | None) -> str | None:
    """Return `package/Type` for any spelling of a type (`pkg/msg/Type`, `pkg::msg::Type`, `pkg.msg.Type`)."""
    parts = [part for part in _TYPE_SPLIT.split(name or "") if part and part not in {"msg", "srv", "action"}]
    return "/".join(parts[-2:]) if len(parts) > 1 else None


def short_name(name: str) -> str:
    """Return the last part of the name of a node, executable or plugin in lower case, without `.py`."""
    return _NAME_SPLIT.split(name)[-1].removesuffix(".py").lower()


def owner_and_name(repository: str) -> str:
    """Return `owner/name` in lower case of a repository under any host or address."""
    return "/".join(repository.rstrip("/").removesuffix(".git").split("/")[-2:]).lower()
