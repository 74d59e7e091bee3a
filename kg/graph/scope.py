"""What the writers of one package share: where triples go, how IRIs are made, and where facts were read."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kg.graph import vocabulary as v
from kg.graph.chains import chain_text
from kg.graph.iris import Iris, fragment
from kg.graph.ntriples import Writer, integer, literal

if TYPE_CHECKING:
    from kg.facts import Location


@dataclass(slots=True)
class Scope:
    """One package of one source on its way into the graph."""

    iris: Iris
    repository: str
    package: str
    writer: Writer = field(default_factory=Writer)
    counts: dict[str, int] = field(default_factory=dict)

    def part(self, owner: str, kind: str, name: str | None) -> str:
        """Return the spelled IRI of a part of `owner` (an IRI): the first, second, ... of its kind and name."""
        key = fragment(owner, kind, name)
        count = self.counts[key] = self.counts.get(key, 0) + 1
        return f"<{key}>" if count == 1 else f"<{fragment(owner, kind, name, count)}>"

    def unique(self, iri: str) -> str:
        """Return `iri`, or a part of it when another thing of this package has that IRI already."""
        return iri if self.writer.first(f"owner {iri}") else self.part(iri, "again", "")[1:-1]

    def file(self, path: str, repository: str | None = None) -> str:
        """Return the spelled IRI of a file, described once."""
        iri = f"<{self.iris.file(repository or self.repository, path)}>"
        if self.writer.described(iri, path, v.SOURCE_FILE):
            self.writer.text(iri, v.PATH, path)
        return iri

    def evidence(self, subject: str, location: Location, via: tuple[Location, ...] = ()) -> None:
        """Add the line where the facts about `subject` were read, and the calls from there to the framework."""
        lines = self.writer.lines
        lines.append(f"{subject} {v.PATH} {literal(location.path)} .\n")
        lines.append(f"{subject} {v.LINE} {integer(location.line)} .\n")
        lines.append(f"{subject} {v.DECLARED_IN} {self.file(location.path, location.repository)} .\n")
        if location.repository is not None and location.repository != self.repository:
            self.writer.text(subject, v.IN_REPOSITORY, location.repository)
        self.writer.text(subject, v.VIA, chain_text(via))
