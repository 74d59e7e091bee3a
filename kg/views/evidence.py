"""Where facts are in the sources, as interfaces can open it: the file, an editor at the line, the page of the commit.

The lines themselves come from the file where it is on this machine and the line is as it was read, else from the
snippets of the store.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any, Final, TypeAlias
from urllib.parse import quote
from weakref import ref

from kg.facts import Location
from kg.graph.snippets import quoted_lines
from kg.graph.source_states import SourceState, sources
from kg.lint.finding import Evidence
from kg.lint.lines import Lines
from kg.resources import folder
from kg.views.remembered import once

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from kg.store.snapshot import EmbeddedSnapshot

Quoted: TypeAlias = "Callable[[str, str], Mapping[int, str]]"

_STATEMENT: Final = 4  # A statement is shown with so many lines at most


@dataclass(frozen=True, slots=True)
class Places:
    """The sources of a store by name; each was read from a folder, often at a commit."""

    sources: Mapping[str, SourceState]
    _lines: Lines = field(repr=False, compare=False)
    _quoted: Quoted = field(repr=False, compare=False)

    @classmethod
    def of(cls, states: Iterable[SourceState], quoted: Quoted | None = None) -> Places:
        """Return the places of some sources; `quoted` gives the stored lines of a file of a source, by number."""
        by_name = {one.name: one for one in states}
        return cls(
            by_name, Lines({name: one.root for name, one in by_name.items() if one.root}), quoted or (lambda *_: {})
        )

    def evidence(self, repository: str, location: Location) -> dict[str, Any]:
        """Return a place for interfaces; `location` may name another repository than that of the fact.

        The keys are `repository`, `commit`, `path`, `line` (from one, None where only the file is known), `file` (its
        absolute path where it is on this machine), `vscode` and `web` (addresses that open it); each of the last
        three is None where there is none.
        """
        name, line = location.repository or repository, location.line or None
        source, file = self.sources.get(name), self.file(repository, location)
        return {
            "repository": name,
            "commit": source.commit if source else None,
            "path": location.path,
            "line": line,
            "file": str(file) if file else None,
            "vscode": _editor(file, line) if file else None,
            "web": self.web(repository, location),
        }

    def file(self, repository: str, location: Location) -> Path | None:
        """Return the file of a place, where its source is on this machine and has it: no path leads out of it."""
        source = self.sources.get(location.repository or repository)
        path = PurePath(location.path)
        inside = not path.is_absolute() and ".." not in path.parts
        file = Path(source.root) / path if source and source.root and inside else None
        try:
            return file if file and file.is_file() else None
        except (OSError, ValueError):
            return None

    def web(self, repository: str, location: Location) -> str | None:
        """Return the page of the line at the commit that was read, on the forges whose addresses are known."""
        source = self.sources.get(location.repository or repository)
        return source.page(location.path, location.line or None) if source else None

    def find(self, path: str) -> str | None:
        """Return the only source that has a file of this path on this machine."""
        matches = [name for name in self.sources if self.file(name, Location(path, 0))]
        return matches[0] if len(matches) == 1 else None

    def code(self, repository: str, location: Location, *, whole: bool = False) -> dict[str, Any]:
        """Return the line of a place: `line_text`, None if it is not available, and `line_stored`.

        `line_stored` is true if the line is from the store, because its file is not here or has another line there now.
        `whole` adds the lines after it on which its parentheses end, joined by spaces: few at most.
        """
        texts: list[str] = []
        stored = False
        for number in range(location.line, location.line + (_STATEMENT if whole else 1)):
            text, from_store = self._line(repository, replace(location, line=number))
            if text is None or (texts and from_store is not stored):
                break
            stored = from_store
            texts.append(text.strip() if whole else text)
            joined = "".join(texts)
            if joined.count("(") <= joined.count(")"):
                break
        return {"line_text": " ".join(texts) or None, "line_stored": stored}

    def _line(self, repository: str, location: Location) -> tuple[str | None, bool]:
        """Return a line, and whether it is from the store."""
        name, number = location.repository or repository, location.line or None
        now = self._lines.at(Evidence(location.path, location.line, name), number)
        if number is None:
            return None, False
        read = self._quoted(name, location.path).get(number)
        if read is None or (now is not None and _is_same(now, read)):
            return now, False
        return read, True

    @staticmethod
    def own(path: Path | str, line: int | None) -> dict[str, Any]:
        """Return a place in a file of `kg` itself or of the user (a rule, an ontology), with the keys of `evidence`.

        The `path` of a file that `kg` ships is relative to the folder of these files.
        """
        file = Path(path).absolute()
        shipped, there = folder("rules").absolute().parent, file.is_file()
        return {
            "repository": None,
            "commit": None,
            "path": str(file.relative_to(shipped) if file.is_relative_to(shipped) else path),
            "line": line,
            "file": str(file) if there else None,
            "vscode": _editor(file, line) if there else None,
            "web": None,
        }


@once
def places(snapshot: EmbeddedSnapshot) -> Places:
    """Return the places of the sources of a snapshot."""
    reference = ref(snapshot)  # what is remembered for a snapshot must not keep it

    @lru_cache(maxsize=256)
    def quoted(repository: str, path: str) -> Mapping[int, str]:
        graph = reference()
        return quoted_lines(graph, repository, path) if graph is not None else {}

    return Places.of(sources(snapshot), quoted)


def _is_same(now: str, read: str) -> bool:
    """Tell whether a line of a file is what a snippet has of it; parts of the snippet may be left out."""
    start, cut, end = read.partition("…")
    return now.startswith(start) and now.rstrip().endswith(end) if cut else now.rstrip() == read


def _editor(file: Path, line: int | None) -> str:
    return f"vscode://file{_quoted(file.absolute().as_posix())}" + (f":{line}" if line else "")


@lru_cache(maxsize=1 << 14)
def _quoted(text: str) -> str:
    return quote(text, errors="surrogatepass")
