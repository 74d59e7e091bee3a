"""What references say of nodes: the truth files and documentation that the graph is compared with.

A file of references has one JSON object a line, in one of two shapes. The first is that of `kg nodes --json`
(`publishes`, `subscribes`, ... hold objects with `name` and `type`), with `closed_world`, the roles of which it says
that it names all. The second is that of documentation: pairs of name and type, `called_services`, `actions`,
`actions_called` and `params` for the roles. Both name `repo`, `package` and `node`, and may name the `commit`. A page
of the ROS wiki in its markup (`.txt`, `.wiki`) is read too, when the package is named with it.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

from kg.errors import Place, UsageError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

__all__ = ["PARAMETERS", "ROLES", "Entry", "Reference", "plain_name", "plain_type", "read", "short_name"]

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
    """One interface or parameter that a reference names.

    `name` has no leading `~` or `/`, and `*` for parts that are not known; None where the reference has none. `type` is
    `package/Type`.
    """

    role: str
    name: str | None
    type: str | None


@dataclass(frozen=True, slots=True)
class Reference:
    """A node as a reference describes it.

    `repository` is `owner/name` in lower case, `names` are short names in lower case by which the node goes, `closed`
    the roles of which the reference names all; `place` is where it was read.
    """

    repository: str
    commit: str | None
    package: str
    names: frozenset[str]
    entries: tuple[Entry, ...]
    place: Place
    closed: frozenset[str] = field(default_factory=frozenset)


def read(path: Path, *, closed: bool = False) -> tuple[Reference, ...]:
    """Return the references of a file, each node once; with `closed` each is taken to name all that its node has.

    Raises:
        UsageError: KG721 when the file cannot be read, or a line is no reference.
    """
    try:
        text = path.read_text("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise UsageError("KG721", f"the references cannot be read: {error}", place=Place(str(path))) from None
    found = [
        _reference(record, Place(str(path), number), closed=closed)
        for number, record in _records(text, path)
        if record.get("scorable") is not False and record.get("package")
    ]
    return tuple(_merged(found))


def _records(text: str, path: Path) -> Iterator[tuple[int, dict[str, Any]]]:
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip():
            continue
        try:
            record = json.loads(line)
        except ValueError as error:
            place = Place(str(path), number)
            raise UsageError("KG721", f"this line is not JSON: {error}", place=place, hint=_HINT) from None
        if not isinstance(record, dict) or not (record.get("repo") or record.get("repository")):
            place = Place(str(path), number)
            raise UsageError("KG721", "this line names no repository of a node", place=place, hint=_HINT)
        yield number, record


def _reference(record: Mapping[str, Any], place: Place, *, closed: bool) -> Reference:
    names = [record.get(key) for key in ("node", "executable", "plugin", "node_name")]
    names += [*(record.get("node_aliases") or ()), *(record.get("aliases") or ())]
    complete = {_OTHER_KEYS.get(key, key) for key in record.get("closed_world") or ()}
    return Reference(
        repository=_owner_and_name(record.get("repo") or record["repository"]),
        commit=record.get("commit"),
        package=record["package"],
        names=frozenset(short_name(name) for name in names if name),
        entries=tuple(dict.fromkeys(_entries(record))),
        place=place,
        closed=frozenset(ROLES if closed else complete),
    )


def _entries(record: Mapping[str, Any]) -> Iterator[Entry]:
    for key in (*ROLES, *_OTHER_KEYS):
        role = _OTHER_KEYS.get(key, key)
        for one in record.get(key) or ():
            given = {"name": one[0], "type": one[1] if len(one) > 1 else None} if isinstance(one, list) else one
            if not given.get("implicit"):
                name = plain_name(given.get("before_remap") or given.get("name"))
                yield Entry(role, name, None if role == PARAMETERS else plain_type(given.get("type")))


def _merged(references: Iterable[Reference]) -> Iterator[Reference]:
    """Yield each node once: what several lines say of it (one for each launch file) belongs together."""
    known: dict[tuple[str, str, frozenset[str]], Reference] = {}
    for one in references:
        key = (one.repository, one.package, one.names)
        before = known.get(key)
        known[key] = one if before is None else _joined(before, one)
    yield from known.values()


def _joined(one: Reference, other: Reference) -> Reference:
    entries = tuple(dict.fromkeys((*one.entries, *other.entries)))
    return Reference(one.repository, one.commit, one.package, one.names, entries, one.place, one.closed | other.closed)


def plain_name(name: str | None) -> str | None:
    """Return a name without its leading `~`, `~/` or `/`, with `*` for holes; None for one that says nothing."""
    if not name or "?" in name:
        return None
    return _HOLE.sub("*", name).lstrip("~").strip("/") or None


def plain_type(name: str | None) -> str | None:
    """Return `package/Type` of a type in any spelling (`pkg/msg/Type`, `pkg::msg::Type`, `pkg.msg.Type`)."""
    parts = [part for part in _TYPE_SPLIT.split(name or "") if part and part not in {"msg", "srv", "action"}]
    return "/".join(parts[-2:]) if len(parts) > 1 else None


def short_name(name: str) -> str:
    """Return the last part of the name of a node, executable or plugin in lower case, without `.py`."""
    return _NAME_SPLIT.split(name)[-1].removesuffix(".py").lower()


def _owner_and_name(repository: str) -> str:
    return "/".join(repository.rstrip("/").removesuffix(".git").split("/")[-2:]).lower()
