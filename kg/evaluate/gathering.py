"""References from files (JSON lines, wiki pages, READMEs), and reasons why some cannot be compared."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Final

from kg.errors import Place, UsageError
from kg.evaluate import references
from kg.evaluate.references import ROLES, Reference
from kg.extract.texts.pages import WikiEntry, WikiNode, is_wiki, wiki_nodes
from kg.graph.source_states import sources
from kg.query.rows import rows
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kg.store.interface import Snapshot


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
    """Return a cell without Markdown formatting."""
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
    text = references.text_of(path)
    nodes = wiki_nodes(text) if is_wiki(text) else readme_nodes(text) if path.suffix.lower() == ".md" else ()
    documented = (_reference(node, path, spot, closed=closed) for node in nodes)
    return tuple(one for one in documented if one.entries)


def _reference(node: WikiNode, path: Path, spot: Spot, *, closed: bool) -> Reference:
    entries = dict.fromkeys(references.entry(one.kind, one.name, one.type) for one in node.entries if one.kind in ROLES)
    return Reference(
        repository=references.owner_and_name(spot.repository),
        commit=spot.commit,
        package=spot.package,
        names=frozenset({references.short_name(node.name)} if node.name else ()),
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
    commits = {references.owner_and_name(name): commit for name, commit in packages.commits.items()}
    return tuple(_chosen(path, _read(path, packages, choice), commits, choice) for path in paths)


def _chosen(path: Path, reading: references.Reading, commits: Mapping[str, str | None], choice: Choice) -> Gathered:
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


def _read(path: Path, packages: Packages, choice: Choice) -> references.Reading:
    if path.is_dir():
        return _folder(path, packages, choice)
    if path.suffix.lower() not in PAGES:
        return references.read(path, closed=choice.closed)
    spot = packages.called(choice.package) if choice.package else packages.around(path)
    if spot is None:
        message = "this page is in no package of the store"
        raise UsageError("KG723", message, place=Place(str(path)), hint="Name its package with --package.")
    return references.Reading(read_page(path, spot, closed=choice.closed))


def _folder(path: Path, packages: Packages, choice: Choice) -> references.Reading:
    """Read the pages below a folder, each for its package."""
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
    return references.Reading(tuple(read), left_out)
