"""Terminal links (OSC 8) for places in source code: to the file, or to its commit on the forge."""

from __future__ import annotations

from dataclasses import dataclass
from socket import gethostname
from typing import TYPE_CHECKING
from urllib.parse import quote

from kg.facts import Location
from kg.views.evidence import Places

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.graph.source_states import SourceState


@dataclass(frozen=True, slots=True)
class Links:
    """Creates links for the sources of a store."""

    places: Places

    @classmethod
    def of(cls, sources: Iterable[SourceState]) -> Links:
        """Return the links for some sources."""
        return cls(Places.of(sources))

    def find(self, path: str, line: int) -> str | None:
        """Return the address of a place of unknown source: the file, if exactly one source has it here."""
        repository = self.places.find(path)
        return self.to(repository, Location(path, line)) if repository else None

    def to(self, repository: str, location: Location) -> str | None:
        """Return the address of a place: the file if it exists here, else the page of its commit, else None."""
        file = self.places.file(repository, location)
        return f"file://{gethostname()}{quote(str(file))}" if file else self.places.web(repository, location)
