"""Places in source code as terminals can open them: OSC 8 links to the file, or to the commit on its forge."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from socket import gethostname
from typing import TYPE_CHECKING, Final
from urllib.parse import quote

from kg.facts import Location

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kg.graph.source_states import SourceState

__all__ = ["Links"]

_FORGES: Final = {
    "github.com": "https://{name}/blob/{commit}/{path}#L{line}",
    "gitlab.com": "https://{name}/-/blob/{commit}/{path}#L{line}",
    "bitbucket.org": "https://{name}/src/{commit}/{path}#lines-{line}",
}


@dataclass(frozen=True, slots=True)
class Links:
    """Makes links for the sources of a store."""

    sources: Mapping[str, SourceState]

    @classmethod
    def of(cls, sources: Sequence[SourceState]) -> Links:
        """Return the links for some sources."""
        return cls({one.name: one for one in sources})

    def find(self, path: str, line: int) -> str | None:
        """Return the address of a place whose source is not known: the file, where one source has it here."""
        found = [name for name, source in self.sources.items() if source.root and (Path(source.root) / path).is_file()]
        return self.to(found[0], Location(path, line)) if len(found) == 1 else None

    def to(self, repository: str, location: Location) -> str | None:
        """Return the address of a place: the file when it is here, else the page of its commit, else None."""
        source = self.sources.get(location.repository or repository)
        if source is None:
            return None
        if source.root and (file := Path(source.root) / location.path).is_file():
            return f"file://{gethostname()}{quote(str(file))}"
        pattern = _FORGES.get(source.name.partition("/")[0])
        if pattern is None or source.commit is None:
            return None
        return pattern.format(name=source.name, commit=source.commit, path=quote(location.path), line=location.line)
