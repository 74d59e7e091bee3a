"""References about nodes: truth files and documentation that the graph is compared with.

A file of references has one JSON object per line, in one of two shapes. The first is that of `kg nodes --json`
(`publishes`, `subscribes`, ... hold objects with `name` and `type`), with `closed_world`, the roles that are complete.
The second is that of documentation: pairs of name and type, with the roles `called_services`, `actions`,
`actions_called` and `params`. Both have `repo`, `package` and `node`, and optionally `commit`. Pages of
documentation (wiki pages, READMEs) are read as well. References that cannot be compared are counted by reason.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, Final

import msgspec

from kg.errors import Place, UsageError
from kg.extract.texts.pages import WikiEntry, WikiNode, is_wiki, wiki_nodes
from kg.graph.source_states import sources
from kg.query.rows import rows
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from kg.store.interface import Snapshot


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


PAGES: Final = frozenset({".md", ".txt", ".wiki", ".moin"})
"""Suffixes of documentation pages."""
_PACKAGES: Final = """
SELECT ?repository ?package ?folder WHERE {
  ?repository_ a rnkg:Repository ; rnkg:name ?repository ; rnkg:contains ?package_ .
  ?package_ rnkg:name ?package ; rnkg:folder ?folder .
}"""
_LARGEST: Final = 2_000_000
"""Maximum size in bytes of a page below a folder."""

_MOST_LINES: Final = 20_000
_LONGEST_LINE: Final = 4_000
_HEADING: Final = re.compile(r"^(#{1,6})\s+(.*?)\s*#*\s*$")
_FENCE: Final = re.compile(r"^\s*(```|~~~)")
_RULE: Final = re.compile(r"^[\s|:-]*-[\s|:-]*$")
_CELLS: Final = re.compile(r"(?<!\\)\|")
_LINK: Final = re.compile(r"\[([^\[\]]*)\]\([^()]*\)|\[([^\[\]]*)\](?:\[[^\[\]]*\])?")
_NAME: Final = re.compile(r"[~/]*[A-Za-z_<{*][\w/<>{}*.\-]*")
_TYPE: Final = re.compile(r"[A-Za-z]\w*(?:(?:::|/|\.)\w+){1,3}")
_ITEM: Final = re.compile(r"^\s{0,8}[*+-]\s+(?P<name>[^\s(]{1,200})\s*[:-]?\s*\((?P<type>[^()\s]{1,200})\)?")
_BOTH: Final = "both"
_ROLES: Final = (
    (re.compile(r"(?:call|requir|us)ed services?|services? (?:call|client)|clients?$", re.IGNORECASE), "clients"),
    (re.compile(r"actions? (?:call|client)|called actions?", re.IGNORECASE), "action_clients"),
    (re.compile(r"\bactions?\b", re.IGNORECASE), "action_servers"),
    (re.compile(r"\bservices?\b", re.IGNORECASE), "services"),
    (re.compile(r"\bparam(?:eter)?s?\b", re.IGNORECASE), "parameters"),
    (re.compile(r"\binputs?\b.*\boutputs?\b", re.IGNORECASE), _BOTH),
    (re.compile(r"\bsubscri|\binputs?\b", re.IGNORECASE), "subscribes"),
    (re.compile(r"\bpubli(?:sh|cation)|\boutputs?\b", re.IGNORECASE), "publishes"),
)
_NAME_HEADS: Final = frozenset(
    {"name", "topic", "topic name", "service", "service name", "parameter", "param", "action"}
)
_TYPE_HEADS: Final = frozenset({"type", "message type", "msg type", "message", "service type", "data type"})
_NODE_WORDS: Final = re.compile(r"\b(?:the|nodes?|nodelet|component|package|ros2?)\b|[`*_]{2,}|`", re.IGNORECASE)
_GENERAL: Final = re.compile(
    r"interface|inner|overview|usage|purpose|topics?$|api|detail|ros|core|common|about|assumption", re.IGNORECASE
)


@dataclass(slots=True)
class _Page:
    """A partly read page: its headings by level, and its entries by the name of a node."""

    headings: dict[int, str] = field(default_factory=dict)
    columns: tuple[int, int | None] | None = None
    entries: dict[str | None, list[WikiEntry]] = field(default_factory=dict)
    lines: dict[str | None, int] = field(default_factory=dict)

    def role(self) -> str | None:
        """Return the role of the nearest heading that has one."""
        for level in sorted(self.headings, reverse=True):
            role = _role(self.headings[level])
            if role:
                return role
        return None

    def node(self) -> str | None:
        """Return the node name in a heading above those of roles; None without one."""
        for level in sorted(self.headings, reverse=True):
            text = self.headings[level]
            if not _role(text) and not _GENERAL.search(text):
                name = _NODE_WORDS.sub(" ", text).strip(" :").lower()
                if re.fullmatch(r"[\w./:\-]+", name):
                    return name
        return None

    def add(self, name: str, kind: str | None, line: int) -> None:
        """Add an entry; invalid names and unknown directions are skipped."""
        role, node = self.role(), self.node()
        if role == _BOTH:
            role = "subscribes" if "input" in name else "publishes" if "output" in name else None
        if role is None or not _NAME.fullmatch(name):
            return
        self.lines.setdefault(node, line)
        self.entries.setdefault(node, []).append(WikiEntry(role, name, kind, None, line))


def readme_nodes(text: str) -> tuple[WikiNode, ...]:
    """Return the nodes documented in a Markdown page, by the headings above; the name is None for the page's own.

    Malformed tables are skipped.
    """
    page, fenced = _Page(), False
    lines = text.split("\n", _MOST_LINES)[:_MOST_LINES]
    for number, line in enumerate(lines, 1):
        if _FENCE.match(line):
            fenced = not fenced
        elif not fenced and len(line) <= _LONGEST_LINE:
            following = lines[number] if number < len(lines) else ""
            _take(page, line, following, number)
    return tuple(WikiNode(name, None, page.lines[name], tuple(entries)) for name, entries in page.entries.items())


def _take(page: _Page, line: str, following: str, number: int) -> None:
    heading = _HEADING.match(line)
    if heading:
        level = len(heading[1])
        page.headings = {at: text for at, text in page.headings.items() if at < level} | {level: heading[2]}
        page.columns = None
    elif "|" in line:
        _row(page, line, following, number)
    else:
        page.columns = None
        item = _ITEM.match(_plain(line))
        if item and (kind := _TYPE.fullmatch(_bare(item["type"]))) and page.role() != "parameters":
            page.add(_bare(item["name"]), kind[0], number)


def _row(page: _Page, line: str, following: str, number: int) -> None:
    cells = [_bare(cell) for cell in _CELLS.split(line.strip().strip("|"))]
    if page.columns is None:
        if _RULE.match(following):
            page.columns = _columns([cell.lower() for cell in cells])
        return
    name_at, type_at = page.columns
    if name_at < len(cells) and not _RULE.match(line):
        kind = _TYPE.fullmatch(cells[type_at]) if type_at is not None and type_at < len(cells) else None
        page.add(cells[name_at], kind[0] if kind else None, number)


def _columns(head: list[str]) -> tuple[int, int | None] | None:
    """Return the columns of names and types in a table; None for other tables."""
    name = next((at for at, cell in enumerate(head) if cell in _NAME_HEADS or cell.startswith("topic")), None)
    kind = next((at for at, cell in enumerate(head) if cell in _TYPE_HEADS and at != name), None)
    return None if name is None else (name, kind)


def _role(heading: str) -> str | None:
    return next((role for pattern, role in _ROLES if pattern.search(heading)), None)


def _plain(line: str) -> str:
    return _LINK.sub(lambda link: link[1] or link[2] or "", line)


def _bare(cell: str) -> str:
    return _plain(cell).replace("\\_", "_").replace("\\", "").strip(" \t`*\"'")


@dataclass(frozen=True, slots=True)
class Spot:
    """The package that a page is about; `repository` is its name in the store, `commit` the one that was read."""

    repository: str
    package: str
    commit: str | None


class Packages:
    """The packages of a store, by name and by folder on this machine."""

    def __init__(self, snapshot: Snapshot) -> None:
        states = {one.name: one for one in sources(snapshot)}
        self.commits = {name: state.commit for name, state in states.items()}
        self._folders: dict[Path, Spot] = {}
        self._spots: list[Spot] = []
        for repository, package, folder in rows(snapshot, _PACKAGES, union=True):
            state = states.get(repository)
            if state is None:
                continue
            spot = Spot(state.name, package, state.commit)
            self._spots.append(spot)
            if state.root:
                self._folders[(Path(state.root) / PurePosixPath(folder)).resolve()] = spot

    def around(self, path: Path) -> Spot | None:
        """Return the innermost package whose folder contains a file; None without one."""
        return next((self._folders[one] for one in path.resolve().parents if one in self._folders), None)

    def called(self, name: str) -> Spot:
        """Return the package `name` or `repository:name`; UsageError KG723 if it is unknown or ambiguous."""
        repository, _, package = name.rpartition(":")
        matches = [one for one in self._spots if one.package == package and one.repository.endswith(repository)]
        if len(matches) == 1:
            return matches[0]
        if matches:
            choices = ", ".join(f"{one.repository}:{one.package}" for one in matches)
            raise UsageError("KG723", f"several packages are called `{name}`: {choices}", hint="Name the repository.")
        hint = did_you_mean(name, [one.package for one in self._spots])
        raise UsageError("KG723", f"the store has no package `{name}`", hint=hint or "`kg packages` lists them.")


def pages_below(folder: Path) -> Iterator[Path]:
    """Yield the sorted files below a folder that may be pages, without hidden folders."""
    for path in sorted(folder.rglob("*")):
        hidden = any(part.startswith(".") for part in path.relative_to(folder).parts)
        if not hidden and path.suffix.lower() in PAGES and path.is_file() and path.stat().st_size <= _LARGEST:
            yield path


def read_page(path: Path, spot: Spot, *, closed: bool = False) -> tuple[Reference, ...]:
    """Return the nodes that a page documents; with `closed` it is assumed to be complete.

    Raises UsageError: KG721 the page is unreadable.
    """
    text = text_of(path)
    nodes = wiki_nodes(text) if is_wiki(text) else readme_nodes(text) if path.suffix.lower() == ".md" else ()
    documented = (_page_reference(node, path, spot, closed=closed) for node in nodes)
    return tuple(one for one in documented if one.entries)


def _page_reference(node: WikiNode, path: Path, spot: Spot, *, closed: bool) -> Reference:
    entries = dict.fromkeys(entry(one.kind, one.name, one.type) for one in node.entries if one.kind in ROLES)
    return Reference(
        repository=owner_and_name(spot.repository),
        commit=spot.commit,
        package=spot.package,
        names=frozenset({short_name(node.name)} if node.name else ()),
        entries=tuple(entries),
        place=Place(str(path), node.line),
        closed=frozenset(ROLES if closed else ()),
        sole=True,
    )


ABSENT: Final = "repository not in the store"
OTHER_COMMIT: Final = "another commit than the store's"
_NO_PACKAGE: Final = "page in no package of the store"


@dataclass(frozen=True, slots=True)
class Choice:
    """Options: `closed` references are complete, `package` is the one that pages are about."""

    closed: bool = False
    any_commit: bool = False
    package: str | None = None


@dataclass(frozen=True, slots=True)
class Gathered:
    """The comparable references of a file or folder, and the numbers of others by reason."""

    path: Path
    references: tuple[Reference, ...]
    left_out: Mapping[str, int]


def gather(snapshot: Snapshot, paths: Iterable[Path], choice: Choice) -> tuple[Gathered, ...]:
    """Return the references in files (JSON lines, pages) and in folders of pages.

    Raises UsageError: KG721 an unreadable file, KG723 a page of an unknown package.
    """
    packages = Packages(snapshot)
    commits = {owner_and_name(name): commit for name, commit in packages.commits.items()}
    return tuple(_chosen(path, _read(path, packages, choice), commits, choice) for path in paths)


def _chosen(path: Path, reading: Reading, commits: Mapping[str, str | None], choice: Choice) -> Gathered:
    left_out, chosen = Counter(reading.left_out), []
    for one in reading.references:
        if one.repository not in commits:
            left_out[ABSENT] += 1
        elif not choice.any_commit and not _same(one.commit, commits[one.repository]):
            left_out[OTHER_COMMIT] += 1
        else:
            chosen.append(one)
    return Gathered(path, tuple(chosen), left_out)


def _same(stated: str | None, read: str | None) -> bool:
    """Return whether a reference is about the commit that was read; one without a commit is assumed to be."""
    return not stated or not read or read.startswith(stated) or stated.startswith(read)


def _read(path: Path, packages: Packages, choice: Choice) -> Reading:
    if path.is_dir():
        return _folder(path, packages, choice)
    if path.suffix.lower() not in PAGES:
        return read(path, closed=choice.closed)
    spot = packages.called(choice.package) if choice.package else packages.around(path)
    if spot is None:
        message = "this page is in no package of the store"
        raise UsageError("KG723", message, place=Place(str(path)), hint="Name its package with --package.")
    return Reading(read_page(path, spot, closed=choice.closed))


def _folder(path: Path, packages: Packages, choice: Choice) -> Reading:
    read: list[Reference] = []
    left_out: Counter[str] = Counter()
    for page in pages_below(path):
        spot = packages.around(page)
        if spot is None:
            left_out[_NO_PACKAGE] += 1
            continue
        try:
            read.extend(read_page(page, spot, closed=choice.closed))
        except UsageError:
            left_out["not readable as UTF-8"] += 1
    return Reading(tuple(read), left_out)
