"""Where the graph has ends and parameters: by file and line, and where they call the framework."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Final

from kg.evaluate.facts import STATED
from kg.graph import vocabulary as v
from kg.graph.chains import chain_of
from kg.graph.iris import is_source_graph
from kg.query.rows import rows

if TYPE_CHECKING:
    from kg.store.interface import Snapshot

_REPOSITORY: Final = "SELECT ?name { GRAPH %s { ?repository a rnkg:Repository ; rnkg:name ?name } }"
_LINES: Final = "SELECT ?part ?class ?path ?line { GRAPH %s { ?part a ?class ; rnkg:path ?path ; rnkg:line ?line } }"
_CALLS: Final = "SELECT ?class ?via { GRAPH %s { ?part a ?class ; rnkg:via ?via } }"
_ELSEWHERE: Final = "SELECT ?part ?repository { GRAPH %s { ?part rnkg:repository ?repository } }"
_FILES: Final = "SELECT ?path ?digest { GRAPH %s { ?file rnkg:path ?path ; rnkg:digest ?digest } }"
_FOLDERS: Final = "SELECT ?folder { GRAPH %s { ?package a rnkg:Package ; rnkg:folder ?folder } }"


class Places:
    """The lines of all ends and parameters of a store, the digests of its files, and the folders of its packages."""

    def __init__(self, snapshot: Snapshot) -> None:
        self._snapshot = snapshot
        self._lines: defaultdict[tuple[str, str, str], set[int]] = defaultdict(set)
        self._digests: dict[tuple[str, str], str] = {}
        self._folders: defaultdict[str, set[str]] = defaultdict(set)
        kinds = {v.bare(term): relation for relation, term in STATED.items()}
        for graph in snapshot.graphs():
            if is_source_graph(graph.value):
                for (repository,) in rows(self._snapshot, _REPOSITORY % graph):
                    self._read(str(graph), repository, kinds)

    def _read(self, graph: str, repository: str, kinds: dict[str, str]) -> None:
        elsewhere = dict(rows(self._snapshot, _ELSEWHERE % graph))
        for part, kind, path, line in rows(self._snapshot, _LINES % graph):
            if kind in kinds:
                self._lines[kinds[kind], elsewhere.get(part, repository), path].add(int(line))
        for kind, chain in rows(self._snapshot, _CALLS % graph):
            for call in chain_of(chain)[-1:] if kind in kinds else ():
                self._lines[kinds[kind], call.repository or repository, call.path].add(call.line)
        for path, value in rows(self._snapshot, _FILES % graph):
            self._digests[repository, path] = value
        self._folders[repository].update(folder or "." for (folder,) in rows(self._snapshot, _FOLDERS % graph))

    def has(self, relation: str, file: tuple[str, str], first: int, last: int) -> bool:
        """Tell whether an end or parameter of a relation was read on one of some lines of a file of a source."""
        return any(first <= line <= last for line in self._lines.get((relation, *file), ()))

    def digest(self, repository: str, path: str) -> str | None:
        """Return the digest of a file as it was read; None for one that is in no package."""
        return self._digests.get((repository, path))

    def folders(self, repository: str) -> set[str]:
        """Return the folders of the packages of a source, `.` for the whole."""
        return self._folders[repository]
