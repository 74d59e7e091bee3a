"""Pages of documentation as references: the ROS wiki's markup, and tables and lists of READMEs.

A page speaks of the package in whose folder it stands, in a source of the store, or of the one that is named with it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Final

from kg.errors import Place, UsageError
from kg.evaluate.readme_tables import readme_nodes
from kg.evaluate.references import (
    PARAMETERS,
    ROLES,
    Entry,
    Reference,
    owner_and_name,
    plain_name,
    plain_type,
    short_name,
    text_of,
)
from kg.extract.texts.pages import is_wiki, wiki_nodes
from kg.graph.source_states import sources
from kg.query.core import run
from kg.query.result import Solutions
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.extract.texts.pages import WikiNode
    from kg.store.interface import Snapshot

PAGES: Final = frozenset({".md", ".txt", ".wiki", ".moin"})
"""Endings of files that are read as pages."""
_PACKAGES: Final = """
SELECT ?repository ?package ?folder WHERE {
  ?repository_ a rnkg:Repository ; rnkg:name ?repository ; rnkg:contains ?package_ .
  ?package_ rnkg:name ?package ; rnkg:folder ?folder .
}"""
_LARGEST: Final = 2_000_000
"""Bytes of a page below a folder; larger files are no pages."""


@dataclass(frozen=True, slots=True)
class Spot:
    """The package that a page speaks of; `repository` is as the store calls it, `commit` the one that was read."""

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
        answer = run(snapshot, _PACKAGES)
        for repository, package, folder in answer.rows if isinstance(answer, Solutions) else ():
            state = states.get(_value(repository))
            if state is None:
                continue
            spot = Spot(state.name, _value(package), state.commit)
            self._spots.append(spot)
            if state.root:
                self._folders[(Path(state.root) / PurePosixPath(_value(folder))).resolve()] = spot

    def around(self, path: Path) -> Spot | None:
        """Return the package in whose folder a file stands, the innermost; None outside of all."""
        return next((self._folders[one] for one in path.resolve().parents if one in self._folders), None)

    def called(self, name: str) -> Spot:
        """Return the package called `name` or `repository:name`; UsageError KG723 when there is none, or several."""
        repository, _, package = name.rpartition(":")
        found = [one for one in self._spots if one.package == package and one.repository.endswith(repository)]
        if len(found) == 1:
            return found[0]
        if found:
            choices = ", ".join(f"{one.repository}:{one.package}" for one in found)
            raise UsageError("KG723", f"several packages are called `{name}`: {choices}", hint="Name the repository.")
        hint = did_you_mean(name, [one.package for one in self._spots])
        raise UsageError("KG723", f"the store has no package `{name}`", hint=hint or "`kg packages` lists them.")


def pages_below(folder: Path) -> Iterator[Path]:
    """Yield the files below a folder that may be pages, sorted; folders with a dot are left out."""
    for path in sorted(folder.rglob("*")):
        hidden = any(part.startswith(".") for part in path.relative_to(folder).parts)
        if not hidden and path.suffix.lower() in PAGES and path.is_file() and path.stat().st_size <= _LARGEST:
            yield path


def read_page(path: Path, spot: Spot, *, closed: bool = False) -> tuple[Reference, ...]:
    """Return the nodes that a page documents; with `closed` it is taken to name all that they have.

    Raises:
        UsageError: KG721 when the page cannot be read.
    """
    text = text_of(path)
    nodes = wiki_nodes(text) if is_wiki(text) else readme_nodes(text) if path.suffix.lower() == ".md" else ()
    found = (_reference(node, path, spot, closed=closed) for node in nodes)
    return tuple(one for one in found if one.entries)


def _reference(node: WikiNode, path: Path, spot: Spot, *, closed: bool) -> Reference:
    entries = dict.fromkeys(
        Entry(one.kind, plain_name(one.name), None if one.kind == PARAMETERS else plain_type(one.type))
        for one in node.entries
        if one.kind in ROLES
    )
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


def _value(term: object) -> str:
    return str(getattr(term, "value", ""))
